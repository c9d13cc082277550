// docs/prepared-format.md agrees with the code.
#include <gmock/gmock.h>

#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>

#include "core/io/file/prepared_file.h"
#include "core/io/load/load_report.h"
#include "core/layer/layer_arrays.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

std::string document() {
  std::ifstream file(TRAPEZE_DOCS "/prepared-format.md");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct Item {
  SectionKind kind;
  std::size_t size;
};

TEST(PreparedFormatTest, SectionsHaveTheNamesAndSizesOfTheDocument) {
  const std::string text = document();
  using Kind = SectionKind;
  for (const auto& [kind, size] : {Item{Kind::description, 1},
                                   Item{Kind::vertices, sizeof(Point)},
                                   Item{Kind::edges, sizeof(MeshEdge)},
                                   Item{Kind::trapezoids, sizeof(MeshTrapezoid)},
                                   Item{Kind::lifespans, sizeof(Lifespan)},
                                   Item{Kind::feature_of, sizeof(std::uint32_t)},
                                   Item{Kind::polygon_index, sizeof(MeshIndex::Entry)},
                                   Item{Kind::level_edge_index, sizeof(MeshIndex::Entry)},
                                   Item{Kind::mote_index, sizeof(MeshIndex::Entry)},
                                   Item{Kind::merged_mote_index, sizeof(MeshIndex::Entry)},
                                   Item{Kind::grains, sizeof(FeatureGrain)},
                                   Item{Kind::overlaps, sizeof(FeatureOverlap)},
                                   Item{Kind::outline_points, sizeof(Point)},
                                   Item{Kind::ring_ends, 4},
                                   Item{Kind::outline_ends, 4},
                                   Item{Kind::loop_sizes, sizeof(LoopSize)},
                                   Item{Kind::milestone_ends, 4},
                                   Item{Kind::milestones, sizeof(Milestone)},
                                   Item{Kind::milestone_levels, sizeof(Level)},
                                   Item{Kind::feature_units, sizeof(FeatureUnit)},
                                   Item{Kind::group_units, sizeof(GroupUnit)},
                                   Item{Kind::group_members, sizeof(GroupMember)},
                                   Item{Kind::group_overlaps, sizeof(GroupOverlap)},
                                   Item{Kind::ids, 8},
                                   Item{Kind::string_bytes, 1},
                                   Item{Kind::string_ends, 8},
                                   Item{Kind::numbers, 8},
                                   Item{Kind::nulls, 8},
                                   Item{Kind::texts, 4}}) {
    const std::string begin =
        "\n| " + std::to_string(static_cast<int>(kind)) + " | " + name_of(kind) + " | ";
    ASSERT_THAT(text, HasSubstr(begin));
    const std::size_t at = text.find(begin) + 1;
    EXPECT_THAT(text.substr(at, text.find('\n', at) - at),
                ::testing::EndsWith(" | " + std::to_string(size) + " |"));
  }
}

#define EXPECT_FIELD(type, name, field)                                                            \
  EXPECT_THAT(text,                                                                                \
              HasSubstr("\n| `" name "` | " #field " | " + std::to_string(offsetof(type, field)) + \
                        " | " + std::to_string(sizeof(type::field)) + " | "))

TEST(PreparedFormatTest, ItemsLieAsInTheDocument) {
  const std::string text = document();
  EXPECT_FIELD(Point, "Point", x);
  EXPECT_FIELD(Point, "Point", y);
  EXPECT_FIELD(MeshEdge, "MeshEdge", upper);
  EXPECT_FIELD(MeshEdge, "MeshEdge", lower);
  EXPECT_FIELD(MeshTrapezoid, "MeshTrapezoid", top);
  EXPECT_FIELD(MeshTrapezoid, "MeshTrapezoid", bottom);
  EXPECT_FIELD(MeshTrapezoid, "MeshTrapezoid", left);
  EXPECT_FIELD(MeshTrapezoid, "MeshTrapezoid", right);
  EXPECT_FIELD(Lifespan, "Lifespan", born);
  EXPECT_FIELD(Lifespan, "Lifespan", dies);
  EXPECT_FIELD(MeshIndex::Entry, "Entry", box);
  EXPECT_FIELD(MeshIndex::Entry, "Entry", min_born);
  EXPECT_FIELD(MeshIndex::Entry, "Entry", max_dies);
  EXPECT_FIELD(MeshIndex::Entry, "Entry", unused);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", from);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", to);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", doubled_area);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", row);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", born);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", is_covered);
  EXPECT_FIELD(FeatureGrain, "FeatureGrain", unused);
  EXPECT_FIELD(FeatureOverlap, "FeatureOverlap", row);
  EXPECT_FIELD(FeatureOverlap, "FeatureOverlap", other);
  EXPECT_FIELD(FeatureOverlap, "FeatureOverlap", width);
  EXPECT_FIELD(FeatureOverlap, "FeatureOverlap", along);
  EXPECT_FIELD(FeatureUnit, "FeatureUnit", digest);
  EXPECT_FIELD(FeatureUnit, "FeatureUnit", most_tolerance);
  EXPECT_FIELD(FeatureUnit, "FeatureUnit", row);
  EXPECT_FIELD(FeatureUnit, "FeatureUnit", vertices);
  EXPECT_FIELD(FeatureUnit, "FeatureUnit", collapsed_rings);
  EXPECT_FIELD(FeatureUnit, "FeatureUnit", is_noded);
  EXPECT_FIELD(GroupUnit, "GroupUnit", digest);
  EXPECT_FIELD(GroupUnit, "GroupUnit", most_tolerance);
  EXPECT_FIELD(GroupUnit, "GroupUnit", members_end);
  EXPECT_FIELD(GroupUnit, "GroupUnit", overlaps_end);
  EXPECT_FIELD(GroupUnit, "GroupUnit", vertices);
  EXPECT_FIELD(GroupUnit, "GroupUnit", shared_edges);
  EXPECT_FIELD(GroupUnit, "GroupUnit", junctions);
  EXPECT_FIELD(GroupUnit, "GroupUnit", gaps);
  EXPECT_FIELD(GroupUnit, "GroupUnit", filled);
  EXPECT_FIELD(GroupUnit, "GroupUnit", is_noded);
  EXPECT_FIELD(GroupUnit, "GroupUnit", is_crowded);
  EXPECT_FIELD(GroupMember, "GroupMember", digest);
  EXPECT_FIELD(GroupMember, "GroupMember", row);
  EXPECT_FIELD(GroupMember, "GroupMember", is_apart);
  EXPECT_FIELD(GroupOverlap, "GroupOverlap", lower);
  EXPECT_FIELD(GroupOverlap, "GroupOverlap", upper);
  EXPECT_FIELD(GroupOverlap, "GroupOverlap", area);
  EXPECT_FIELD(GroupOverlap, "GroupOverlap", lower_area);
}

TEST(PreparedFormatTest, TheDocumentIsOfThisVersion) {
  const std::string text = document();
  EXPECT_THAT(text, HasSubstr("This is version " + std::to_string(kPreparedVersion)));
  EXPECT_THAT(text, HasSubstr(std::to_string(11 + kCoverageCounts.size()) + " x 8 |"));
  EXPECT_EQ(sizeof(DirectoryEntry), 24u);
  EXPECT_EQ(offsetof(DirectoryEntry, checksum), 16u);
  EXPECT_EQ(offsetof(PreparedHeader, directory_checksum), 40u);
  EXPECT_EQ(offsetof(PreparedHeader, header_checksum), 56u);
}

}  // namespace
}  // namespace trapeze
