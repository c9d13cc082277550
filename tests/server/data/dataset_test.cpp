#include "server/data/dataset.h"

#include <gmock/gmock.h>

#include <spdlog/fmt/fmt.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"
#include "server/config/load_config.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::int32_t kFar =
    1 << 28;  // an order of place then does not depend on the order of rows

Rings square_at(std::int32_t x) {
  Rings rings;
  rings.add(std::vector<Point>{{x, 0}, {x + 1000, 0}, {x + 1000, 1000}, {x, 1000}});
  return rings;
}

/// The revision of two named features with a square each, at these places.
std::uint64_t revision_of_squares_at(std::array<std::int32_t, 2> places) {
  FeatureTable features({{"name", FieldType::text}});
  std::vector<LayerBuilder> builders(1);
  constexpr std::array<std::string_view, 2> kNames = {"one", "other"};
  for (std::size_t i = 0; i < places.size(); ++i) {
    Rings rings = square_at(places[i]);
    const std::array<Value, 1> name = {kNames[i]};
    builders[0].add(features.append(static_cast<std::int64_t>(i), name), rings);
  }
  return revision_of(*LayerBuilder::join(builders, std::move(features)));
}

TEST(RevisionOf, IsTheSameForTheSameLayer) {
  EXPECT_EQ(revision_of_squares_at({0, kFar}), revision_of_squares_at({0, kFar}));
}

TEST(RevisionOf, ChangesWithAPlace) {
  EXPECT_NE(revision_of_squares_at({0, kFar}), revision_of_squares_at({0, kFar + 1}));
}

TEST(RevisionOf, ChangesWhenTwoFeaturesSwapTheirPolygons) {
  EXPECT_NE(revision_of_squares_at({0, kFar}), revision_of_squares_at({kFar, 0}));
}

/// Two layers of files of their own, loaded, and loaded once more after a change.
class LoadedAgain : public ::testing::Test {
 protected:
  LoadedAgain() {
    write("one.geojson", 0);
    write("other.geojson", 20);
    layers_ = layers_of_files({folder_.file("one.geojson"), folder_.file("other.geojson")});
    before_ = Dataset::load(layers_);
  }

  /// A square; each call makes another file of it.
  void write(const std::string& name, int lon) {
    folder_.write(name, fmt::format(R"({{"type": "Polygon", "coordinates": )"
                                    R"([[[{0},0],[{1},0],[{1},5],[{0},5],[{0},0]]]}})",
                                    lon, lon + 5));
    std::filesystem::last_write_time(
        folder_.file(name), std::filesystem::file_time_type{} + std::chrono::seconds(++writes_));
  }

  void load_again() { after_ = Dataset::load(layers_, before_.get()); }
  /// The names of the layers that are the ones from before.
  std::vector<std::string> kept() const {
    std::vector<std::string> names;
    for (const ServedLayer& layer : after_->layers()) {
      for (const ServedLayer& old : before_->layers()) {
        if (layer.layer == old.layer && layer.untested == old.untested)
          names.push_back(layer.config.name);
      }
    }
    return names;
  }

  const TemporaryFolder folder_;
  int writes_ = 0;
  std::vector<LayerConfig> layers_;
  std::shared_ptr<const Dataset> before_;
  std::shared_ptr<const Dataset> after_;
};

TEST_F(LoadedAgain, ReadsOnlyTheLayerWhoseFileChanged) {
  write("other.geojson", 40);
  load_again();
  EXPECT_THAT(kept(), ElementsAre("one"));
  EXPECT_NE(after_->layers()[1].revision, before_->layers()[1].revision);
  EXPECT_NE(after_->generation(), before_->generation());
}

TEST_F(LoadedAgain, WithoutAnyChangeIsTheSame) {
  load_again();
  EXPECT_THAT(kept(), ElementsAre("one", "other"));
  EXPECT_EQ(after_->generation(), before_->generation());
}

TEST_F(LoadedAgain, ShowsALayerOtherwiseWithoutReadingIt) {
  layers_[0].title = "Another title";
  layers_[1].name = "renamed";
  load_again();
  EXPECT_THAT(kept(), ElementsAre("one", "renamed"));
  EXPECT_EQ(after_->layers()[0].config.title, "Another title");
}

TEST_F(LoadedAgain, ReadsWhatIsToBeReadOtherwise) {
  layers_[0].coverage = CoverageMode::off;
  layers_[1].selection.attributes = std::vector<std::string>();
  load_again();
  EXPECT_THAT(kept(), IsEmpty());
}

TEST_F(LoadedAgain, ReadsWhatMayHaveChangedInAnotherFile) {
  folder_.write("one.geojson-wal", "");
  load_again();
  EXPECT_THAT(kept(), ElementsAre("other"));
}

TEST_F(LoadedAgain, AKeptLayerOutlivesTheDatasetItCameFrom) {
  load_again();
  before_.reset();
  EXPECT_FALSE(after_->layers()[0].layer->mesh().trapezoids.empty());
}

TEST_F(LoadedAgain, BuildsWhatIsToBeServedWithoutTheTopologyTestOnce) {
  layers_[0].fast_topology = true;
  load_again();
  EXPECT_THAT(kept(), ElementsAre("other"));
  const auto built = after_->layers()[0].untested;
  ASSERT_NE(built, nullptr);
  before_ = after_;
  load_again();
  EXPECT_EQ(after_->layers()[0].untested, built);
}

}  // namespace
}  // namespace trapeze
