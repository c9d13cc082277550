#include "server/data/dataset.h"

#include <gmock/gmock.h>

#include <spdlog/fmt/fmt.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"
#include "server/config/load_config.h"
#include "server/data/named_tables.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int32_t kFar =
    1 << 28;  // so the order by place does not depend on the order of rows

Rings square_at(std::int32_t x) {
  Rings rings;
  rings.add(std::vector<Point>{{x, 0}, {x + 1000, 0}, {x + 1000, 1000}, {x, 1000}});
  return rings;
}

/// The revision of a layer with two named features, each a square at one of these places.
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

/// Two layers, each with its own file, loaded twice with a change in between.
class LoadedAgain : public ::testing::Test {
 protected:
  LoadedAgain() {
    write("one.geojson", 0);
    write("other.geojson", 20);
    layers_ = layers_of_files({folder_.file("one.geojson"), folder_.file("other.geojson")});
    before_ = Dataset::load(layers_);
  }

  /// A square; each call writes a different file.
  void write(const std::string& name, int lon) {
    folder_.write(name, fmt::format(R"({{"type": "Polygon", "coordinates": )"
                                    R"([[[{0},0],[{1},0],[{1},5],[{0},5],[{0},0]]]}})",
                                    lon, lon + 5));
    std::filesystem::last_write_time(
        folder_.file(name), std::filesystem::file_time_type{} + std::chrono::seconds(++writes_));
  }

  void load_again() { after_ = Dataset::load(layers_, before_.get()); }
  /// The names of the layers that were kept from before the change.
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

TEST_F(LoadedAgain, WithATableTranslatedOtherwiseIsAnotherGeneration) {
  const auto generation_with = [this](const std::string& translation) {
    ValueTableConfig table;
    table.file = folder_.write("names.csv", "key,name,name:de\na,Alpha," + translation + "\n");
    table.languages = {"de"};
    return Dataset::load(layers_, before_.get(), nullptr, read_named_tables({{"names", table}}))
        ->generation();
  };
  EXPECT_EQ(generation_with("Alfa"), generation_with("Alfa"));
  EXPECT_NE(generation_with("Alfa"), generation_with("Anfang"));
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

/// Squares in a row; the first has the height `height`.
std::string row_of_squares(int count, int height) {
  std::string text = R"({"type": "FeatureCollection", "features": [)";
  for (int i = 0; i < count; ++i) {
    text += fmt::format(R"({0}{{"type": "Feature", "properties": {{}}, "geometry": {{)"
                        R"("type": "Polygon", "coordinates": )"
                        R"([[[{1},0],[{2},0],[{2},{3}],[{1},{3}],[{1},0]]]}}}})",
                        i == 0 ? "" : ",", 3 * i, 3 * i + 2, i == 0 ? height : 2);
  }
  return text + "]}";
}

TEST_F(LoadedAgain, TakesOverWhatHasNotChangedOfALayer) {
  folder_.write("one.geojson", row_of_squares(20, 2));
  load_again();
  EXPECT_EQ(after_->layers()[0].report.taken_over, 0u);
  before_ = after_;
  folder_.write("one.geojson", row_of_squares(21, 30));
  load_again();
  EXPECT_THAT(kept(), ElementsAre("other"));
  EXPECT_EQ(after_->layers()[0].report.taken_over, 19u) << "one is new, and one has changed";
  EXPECT_EQ(after_->layers()[0].revision, Dataset::load(layers_)->layers()[0].revision);
  layers_[0].coverage = CoverageMode::off;
  before_ = after_;
  load_again();
  EXPECT_EQ(after_->layers()[0].report.taken_over, 0u) << "what was built otherwise";
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

/// Squares side by side, the last `broken` of them without finite coordinates.
std::string squares(int count, int broken) {
  std::string text = R"({"type": "FeatureCollection", "features": [)";
  for (int i = 0; i < count; ++i) {
    text += fmt::format(R"({0}{{"type": "Feature", "properties": {{}}, "geometry": {{)"
                        R"("type": "Polygon", "coordinates": )"
                        R"([[[{1},0],[{1}.5,0],[{1}.5,{2}],[{1},0]]]}}}})",
                        i == 0 ? "" : ",", i, i < count - broken ? "1" : "1e999");
  }
  return text + "]}";
}

/// The reason why the layers are not served; empty if there is none.
std::string refusal_of(const std::vector<LayerConfig>& layers, const Dataset* previous = nullptr) {
  try {
    Dataset::load(layers, previous);
    return {};
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

class LayerLimits : public ::testing::Test {
 protected:
  std::vector<LayerConfig> layers_of_squares(int count, int broken) {
    folder_.write("squares.geojson", squares(count, broken));
    std::filesystem::last_write_time(
        folder_.file("squares.geojson"),
        std::filesystem::file_time_type{} + std::chrono::seconds(++writes_));
    return layers_of_files({folder_.file("squares.geojson")});
  }
  std::shared_ptr<const Dataset> served(int count) {
    return Dataset::load(layers_of_squares(count, 0));
  }

  const TemporaryFolder folder_;
  int writes_ = 0;
};

TEST_F(LayerLimits, AnyNumberOfFeaturesMayBeSkippedUnlessALayerSaysHowMany) {
  auto layers = layers_of_squares(10, 2);
  EXPECT_THAT(refusal_of(layers), IsEmpty());
  layers[0].max_skipped = SkipLimit::parse("20%").value();
  EXPECT_THAT(refusal_of(layers), IsEmpty());
  layers[0].max_skipped = SkipLimit::parse("19%").value();
  EXPECT_THAT(refusal_of(layers),
              AllOf(HasSubstr("layer \"squares\": " + layers[0].file),
                    HasSubstr("2 of 10 features were skipped (20 %), and at most 19% may be")));
  layers[0].max_skipped = SkipLimit::parse("1").value();
  EXPECT_THAT(refusal_of(layers), HasSubstr("at most 1 may be"));
}

TEST_F(LayerLimits, ALimitHoldsForALayerThatIsNotReadAgain) {
  auto layers = layers_of_squares(10, 2);
  const auto before = Dataset::load(layers);
  layers[0].max_skipped = SkipLimit::parse("0").value();
  EXPECT_THAT(refusal_of(layers, before.get()), HasSubstr("at most 0 may be"));
}

TEST_F(LayerLimits, FewerThanHalfOfTheServedFeaturesAreRefused) {
  const auto before = served(10);
  EXPECT_THAT(refusal_of(layers_of_squares(5, 0), before.get()), IsEmpty());
  EXPECT_THAT(
      refusal_of(layers_of_squares(4, 0), before.get()),
      AllOf(HasSubstr("squares.geojson: 4 features can be drawn, fewer than half of the 10"),
            HasSubstr("set may_shrink = true")));
  EXPECT_THAT(refusal_of(layers_of_squares(10, 6), before.get()), HasSubstr("may_shrink"))
      << "skipped ones are not there either";
}

TEST_F(LayerLimits, ALayerShrinksIfItMayOrIsSelectedOtherwiseOrIsNew) {
  const auto before = served(10);
  auto layers = layers_of_squares(1, 0);
  EXPECT_THAT(refusal_of(layers, before.get()), HasSubstr("may_shrink"));
  auto may_shrink = layers;
  may_shrink[0].may_shrink = true;
  EXPECT_THAT(refusal_of(may_shrink, before.get()), IsEmpty());
  auto selected = layers;
  selected[0].selection.where = "FID = 0";
  EXPECT_THAT(refusal_of(selected, before.get()), IsEmpty());
  auto renamed = layers;
  renamed[0].name = "other";
  EXPECT_THAT(refusal_of(renamed, before.get()), IsEmpty());
}

TEST_F(LayerLimits, EveryLayerThatIsRefusedIsTold) {
  auto layers = layers_of_squares(2, 1);
  folder_.write("more.geojson", squares(4, 1));
  layers.push_back(layers_of_files({folder_.file("more.geojson")})[0]);
  for (LayerConfig& layer : layers) layer.max_skipped = SkipLimit::parse("0").value();
  EXPECT_THAT(refusal_of(layers), AllOf(HasSubstr("layer \"squares\": "), HasSubstr("1 of 2"),
                                        HasSubstr("; layer \"more\": "), HasSubstr("1 of 4")));
}

}  // namespace
}  // namespace trapeze
