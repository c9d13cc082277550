#include "core/io/prepared/prepared_parts.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/io/file/mapped_file.h"
#include "core/io/load/source_division.h"
#include "core/io/prepared/join_parts.h"
#include "core/io/prepared/open_layer.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Squares of 0.1 degrees, one at every degree.
std::string write_squares(const TemporaryFolder& folder, const std::string& name, int count) {
  TestLayer layer;
  for (int i = 0; i < count; ++i) {
    const auto corner = [i](const char* x, const char* y) {
      return std::to_string(i) + x + " " + std::to_string(i % 7) + y;
    };
    layer.features.push_back({"POLYGON((" + corner(".1", ".1") + "," + corner(".2", ".1") + "," +
                                  corner(".2", ".2") + "," + corner(".1", ".2") + "," +
                                  corner(".1", ".1") + "))",
                              i, "square"});
  }
  const std::string path = folder.file(name);
  write_source(path, "GPKG", {layer});
  return path;
}

std::vector<std::string> prepare(const TemporaryFolder& folder, const std::string& source,
                                 const std::string& name, std::uint32_t count,
                                 LayerOptions generalization = {}) {
  LoadOptions options;
  options.generalization = generalization;
  options.division = SourceDivision::of(source, {}, generalization, count, {});
  std::vector<std::string> files;
  for (options.part = 1; options.part <= count; ++options.part) {
    const LoadedLayer loaded = load_layer(source, options);
    files.push_back(folder.file(name + std::to_string(options.part) + ".trapeze"));
    save_prepared_layer(files.back(), loaded, loaded.report.vertices + options.part,
                        stamp_source(source));
  }
  return files;
}

std::string write_overview(const TemporaryFolder& folder, const std::vector<std::string>& files) {
  const auto parts = find_prepared_parts(files, {});
  const std::string path = folder.file("overview.trapeze");
  save_prepared_layer(path, overview_of(parts), 1, parts.front()->summary().source);
  return path;
}

std::string failure_of_parts(const std::vector<std::string>& files,
                             const PreparedDemands& demands = {}) {
  try {
    open_prepared_parts(files, demands);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "was opened";
}

TEST(PreparedPartsTest, AreOneLayerWithTheSumsOfAll) {
  const TemporaryFolder folder;
  const std::string source = write_squares(folder, "squares.gpkg", 20);
  const auto files = prepare(folder, source, "part", 3);
  const LoadedLayer whole = load_layer(source);
  const LoadedLayer loaded = open_layer(folder.file("part?.trapeze"));
  ASSERT_NE(loaded.parts, nullptr);
  EXPECT_EQ(loaded.parts->parts().size(), 3u);
  EXPECT_EQ(loaded.parts->overview(), nullptr);
  EXPECT_EQ(loaded.report.loaded, 20u);
  EXPECT_EQ(loaded.report.vertices, whole.report.vertices);
  EXPECT_EQ(loaded.layer->bounds(), whole.layer->bounds());
  EXPECT_EQ(loaded.layer->features().size(), 0u);
  EXPECT_EQ(loaded.layer->features().field_index("number"),
            whole.layer->features().field_index("number"));
}

TEST(PreparedPartsTest, AreOpenedWhenSomebodyAsks) {
  const TemporaryFolder folder;
  const auto files = prepare(folder, write_squares(folder, "squares.gpkg", 20), "part", 3);
  const LoadedLayer loaded = open_prepared_parts(files, {});
  const auto& parts = loaded.parts->parts();
  EXPECT_EQ(parts[1]->layer_if_open(), nullptr);
  ASSERT_NE(parts[1]->layer(), nullptr);
  EXPECT_EQ(parts[1]->layer_if_open(), parts[1]->layer());
  EXPECT_EQ(parts[0]->layer_if_open(), nullptr);
  EXPECT_EQ(count_by_level(*parts[1]->layer()).trapezoids, parts[1]->summary().counts.trapezoids);
}

TEST(PreparedPartsTest, OneThatIsCutOffOrReplacedIsDamagedWhenItIsLookedAt) {
  const TemporaryFolder folder;
  const auto files = prepare(folder, write_squares(folder, "squares.gpkg", 20), "part", 3);
  const LoadedLayer loaded = open_prepared_parts(files, {});
  std::filesystem::resize_file(files[0], std::filesystem::file_size(files[0]) - 64);
  std::filesystem::copy_file(files[2], files[1], std::filesystem::copy_options::overwrite_existing);
  const auto& parts = loaded.parts->parts();
  EXPECT_EQ(parts[0]->layer(), nullptr);
  EXPECT_THAT(parts[0]->problem(), AllOf(HasSubstr(files[0]), HasSubstr("damaged")));
  EXPECT_EQ(parts[1]->layer(), nullptr);
  EXPECT_THAT(parts[1]->problem(), HasSubstr("has been replaced"));
  EXPECT_NE(parts[2]->layer(), nullptr);
  EXPECT_TRUE(parts[0]->is_damaged());
  EXPECT_FALSE(parts[2]->is_damaged());
}

TEST(PreparedPartsTest, OneIsNotDamagedIfThereWasNoDescriptorForIt) {
  const TemporaryFolder folder;
  const auto files = prepare(folder, write_squares(folder, "squares.gpkg", 20), "part", 3);
  const LoadedLayer loaded = open_prepared_parts(files, {});
  const PreparedPart& part = *loaded.parts->parts()[0];
  rlimit files_before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &files_before), 0);
  rlimit none = files_before;
  none.rlim_cur = 0;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  EXPECT_THROW(part.layer(), MappingShortage);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &files_before), 0);
  EXPECT_FALSE(part.is_damaged());
  EXPECT_NE(part.layer(), nullptr);
}

TEST(PreparedPartsTest, ThoseThatAreTheSameAreTakenOver) {
  const TemporaryFolder folder;
  const auto files = prepare(folder, write_squares(folder, "squares.gpkg", 20), "part", 3);
  const LoadedLayer before = open_prepared_parts(files, {});
  const auto layer = before.parts->parts()[1]->layer();
  const LoadedLayer after = open_prepared_parts(files, {}, before.parts.get());
  EXPECT_EQ(after.parts->parts()[0]->layer_if_open(), nullptr);
  EXPECT_EQ(after.parts->parts()[1]->layer_if_open(), layer);
  EXPECT_EQ(after.revision, before.revision);
}

TEST(PreparedPartsTest, ThoseThatAreTheSameAreOfTheStateOfTheSourceThatTheirFilesDeclare) {
  const TemporaryFolder folder;
  const std::string source = write_squares(folder, "squares.gpkg", 20);
  const auto files = prepare(folder, source, "part", 3);
  const LoadedLayer before = open_prepared_parts(files, {});
  const auto unchanged = before.parts->parts()[0]->layer();
  const auto changed = before.parts->parts()[1]->layer();
  LoadOptions options;
  options.division = SourceDivision::of(source, {}, {}, 3, {});
  SourceStamp stamp = stamp_source(source);
  ++stamp.files.front().checksum;  // an attribute in the second part, say
  for (options.part = 1; options.part <= 3; ++options.part) {
    const std::uint64_t revision = before.parts->parts()[options.part - 1]->summary().revision;
    save_prepared_layer(files[options.part - 1], load_layer(source, options),
                        options.part == 2 ? 77 : revision, stamp);
  }
  const LoadedLayer after = open_prepared_parts(files, {}, before.parts.get());
  for (const auto& part : after.parts->parts()) {
    EXPECT_EQ(part->summary().source.files.front().checksum, stamp.files.front().checksum);
  }
  EXPECT_EQ(after.parts->parts()[0]->layer(), unchanged);
  EXPECT_NE(after.parts->parts()[1]->layer(), changed);
  EXPECT_NE(after.parts->parts()[2]->layer(), nullptr);
}

TEST(PreparedPartsTest, TellsWhichAreMissingOrThereTwice) {
  const TemporaryFolder folder;
  const auto files = prepare(folder, write_squares(folder, "squares.gpkg", 20), "part", 6);
  EXPECT_THAT(failure_of_parts({files[0], files[2], files[3]}),
              HasSubstr("parts 2, 5 and 6 of 6 are missing"));
  EXPECT_THAT(failure_of_parts({files[0], files[1], files[2], files[3], files[4]}),
              HasSubstr("part 6 of 6 is missing"));
  std::vector<std::string> twice = files;
  twice.push_back(folder.file("copy.trapeze"));
  std::filesystem::copy_file(files[4], twice.back());
  EXPECT_THAT(failure_of_parts(twice),
              AllOf(HasSubstr("part 5 of 6"), HasSubstr(files[4]), HasSubstr(twice.back())));
}

TEST(PreparedPartsTest, RefusesWhatDoesNotBelongTogether) {
  const TemporaryFolder folder;
  const std::string source = write_squares(folder, "squares.gpkg", 20);
  const auto files = prepare(folder, source, "part", 3);
  const auto others = prepare(folder, write_squares(folder, "more.gpkg", 21), "other", 3);
  const auto fewer = prepare(folder, source, "fewer", 2);
  LayerOptions apart;
  apart.coverage = CoverageMode::off;
  const auto without = prepare(folder, source, "apart", 3, apart);
  EXPECT_THAT(failure_of_parts({files[0], others[1], files[2]}),
              AllOf(HasSubstr(others[1]), HasSubstr("another source")));
  EXPECT_THAT(failure_of_parts({files[0], fewer[1], files[2]}),
              AllOf(HasSubstr("part 2 of 2"), HasSubstr("part 1 of 3")));
  EXPECT_THAT(failure_of_parts({files[0], without[1], files[2]}), HasSubstr("other options"));
  EXPECT_THAT(failure_of_parts(files, {std::nullopt, "", CoverageMode::off}),
              HasSubstr("coverage"));
  const std::string whole = folder.file("whole.trapeze");
  save_prepared_layer(whole, load_layer(source), 1, stamp_source(source));
  EXPECT_THAT(failure_of_parts({files[0], files[1], files[2], whole}),
              HasSubstr("is a whole layer"));
  EXPECT_THAT(failure_of_parts({source}), HasSubstr("is not a prepared file"));
}

TEST(PreparedPartsTest, RefusesAPartOfAnotherStateWithTheSameBoxes) {
  const TemporaryFolder folder;
  const std::string source = write_squares(folder, "squares.gpkg", 20);
  const auto files = prepare(folder, source, "part", 3);
  LoadOptions options;
  options.division = SourceDivision::of(source, {}, {}, 3, {});
  options.part = 2;
  SourceStamp before = stamp_source(source);
  ++before.files.front().checksum;  // another attribute, say
  save_prepared_layer(files[1], load_layer(source, options), 77, before);
  EXPECT_THAT(failure_of_parts(files), AllOf(HasSubstr(files[1]), HasSubstr("another state")));
}

TEST(PreparedPartsTest, RefusesAnOverviewOfOtherParts) {
  const TemporaryFolder folder;
  const std::string source = write_squares(folder, "squares.gpkg", 20);
  auto files = prepare(folder, source, "part", 3);
  const std::string overview = write_overview(folder, files);
  files.push_back(overview);
  EXPECT_EQ(failure_of_parts(files), "was opened");
  EXPECT_THAT(failure_of_parts({overview}), HasSubstr("no part"));
  LoadOptions options;
  options.division = SourceDivision::of(source, {}, {}, 3, {});
  options.part = 2;
  save_prepared_layer(files[1], load_layer(source, options), 77, stamp_source(source));
  EXPECT_THAT(failure_of_parts(files), AllOf(HasSubstr(overview), HasSubstr("--join")));
}

TEST(PreparedPartsTest, PatternsStandForTheFilesOfAFolder) {
  const TemporaryFolder folder;
  for (const char* name :
       {"a-1.trapeze", "a-10.trapeze", "a-2.trapeze", "b.trapeze", ".a-.trapeze"})
    folder.write(name, "x");
  EXPECT_TRUE(is_pattern_of_files(folder.file("a-*.trapeze")));
  EXPECT_FALSE(is_pattern_of_files(folder.file("b.trapeze")));
  EXPECT_FALSE(is_pattern_of_files("PG:host=* dbname=x"));
  EXPECT_THAT(files_of_pattern(folder.file("a-*.trapeze")),
              ::testing::ElementsAre(folder.file("a-1.trapeze"), folder.file("a-10.trapeze"),
                                     folder.file("a-2.trapeze")));
  EXPECT_THAT(files_of_pattern(folder.file("a-?.*eze")),
              ::testing::ElementsAre(folder.file("a-1.trapeze"), folder.file("a-2.trapeze")));
  EXPECT_THAT([&] { files_of_pattern(folder.file("c*")); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("no file of such a name")));
  EXPECT_THAT([&] { files_of_pattern(folder.file("none/*")); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("cannot be read")));
}

TEST(OverviewTest, IsForZoomsAtWhichTilesMeetManyParts) {
  // 64 squares side by side, as wide as a tile of zoom 8 each.
  std::vector<Box> boxes;
  const std::int32_t side = 1 << 23;
  for (std::int32_t i = 0; i < 64; ++i) {
    const std::int32_t x = i % 8 * side;
    const std::int32_t y = i / 8 * side;
    boxes.push_back({x + 1, y + 1, x + side - 1, y + side - 1});
  }
  EXPECT_EQ(last_zoom_of_overview(boxes), 6);  // 16 are in a tile, 4 in one of zoom 7
  EXPECT_EQ(last_zoom_of_overview({}), 0);
}

}  // namespace
}  // namespace trapeze
