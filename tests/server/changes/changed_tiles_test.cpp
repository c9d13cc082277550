#include "server/changes/changed_tiles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "render/software/software_renderer.h"
#include "server/changes/tile_list.h"
#include "server/config/load_config.h"
#include "server/tiles/tile_painter.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/edited_land.h"

namespace trapeze {
namespace {

using testing::EditedLand;
using Tiles = std::set<std::tuple<int, std::uint32_t, std::uint32_t>>;

constexpr ZoomRange kServedZooms{0, 8};

Tiles set_of(const std::vector<TileId>& tiles) {
  Tiles set;
  for (const TileId& tile : tiles) set.emplace(tile.z, tile.x, tile.y);
  EXPECT_EQ(set.size(), tiles.size()) << "each is listed once";
  return set;
}

ChangeRequest request_of(const std::string& style, Certainty certainty) {
  ChangeRequest request;
  request.tile.layers = {"land"};
  request.tile.style = testing::style_of(style);
  request.zooms = kServedZooms;
  request.certainty = certainty;
  request.labels = testing::label_book();
  return request;
}

Tiles changed(const std::string& style, Certainty certainty,
              const std::shared_ptr<const Dataset>& before,
              const std::shared_ptr<const Dataset>& after) {
  const auto found = changed_tiles(request_of(style, certainty), before, after);
  EXPECT_TRUE(found->is_complete);
  return set_of(found->tiles);
}

class Drawn {
 public:
  explicit Drawn(std::string style) : style_(std::move(style)) {}

  /// All tiles near the land whose bytes differ.
  Tiles different(const std::shared_ptr<const Dataset>& before,
                  const std::shared_ptr<const Dataset>& after) {
    Tiles tiles;
    for (int z = kServedZooms.first; z <= kServedZooms.last; ++z) {
      const double count = 1 << z;
      const auto tile_at = [count](double share) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(share * count), 0.0, count - 1));
      };
      for (std::uint32_t y = tile_at(0.44); y <= tile_at(0.53); ++y) {
        for (std::uint32_t x = tile_at(0.47); x <= tile_at(0.59); ++x) {
          if (bytes_of(before, {z, x, y}) != bytes_of(after, {z, x, y})) tiles.emplace(z, x, y);
        }
      }
    }
    return tiles;
  }

 private:
  std::string bytes_of(const std::shared_ptr<const Dataset>& dataset, TileId tile) {
    TileRequest request = request_of(style_, Certainty::bytes).tile;
    request.tile = tile;
    const auto plan = plan_tile(request, dataset);
    const PaintJob job{&*plan};
    return *painter_.paint({&job, 1}).front().value().bytes;
  }

  std::string style_;
  TilePainter painter_{std::make_unique<SoftwareRenderer>(), TilePainter::new_class_cache(),
                       testing::label_book()->usual_fonts(), testing::label_book()};
};

bool holds_all(const Tiles& all, const Tiles& some) {
  return std::ranges::includes(all, some);
}

class ChangedTilesTest : public ::testing::TestWithParam<const char*> {};

TEST_P(ChangedTilesTest, AreAllAndOnlyThoseThatHaveOtherBytes) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  EditedLand land(seed);
  Drawn drawn(GetParam());
  auto before = land.load();
  std::size_t listed = 0;
  std::size_t truly = 0;
  for (int round = 0; round < 6; ++round) {
    const std::string edit = land.edit();
    const auto after = land.load();
    const Tiles different = drawn.different(before, after);
    EXPECT_EQ(changed(GetParam(), Certainty::bytes, before, after), different) << edit;
    const Tiles by_fingerprint = changed(GetParam(), Certainty::fingerprints, before, after);
    EXPECT_TRUE(holds_all(by_fingerprint, different)) << edit;
    EXPECT_TRUE(
        holds_all(changed(GetParam(), Certainty::candidates, before, after), by_fingerprint))
        << edit;
    EXPECT_EQ(changed(GetParam(), Certainty::bytes, after, before), different) << "and back";
    listed += by_fingerprint.size();
    truly += different.size();
    before = after;
  }
  // The remaining tiles show a change that is too small for any pixel, or rounded corners outside
  // the tile.
  const bool is_smooth = std::string_view(GetParam()).find("smooth") != std::string_view::npos;
  EXPECT_LE(listed, truly * 3 / 2 + (is_smooth ? 90 : 60));
}

INSTANTIATE_TEST_SUITE_P(Styles, ChangedTilesTest,
                         ::testing::Values("", "color-by=value&breaks=1,3&ramp=Blues",
                                           "stroke=black&stroke-width=2&stroke-dasharray=5,3",
                                           "fill-opacity=0.5&small=keep&simplify=2",
                                           "filter=kind='wood'&simplify=0",
                                           "highlight=3,50,60&pattern=dots",
                                           "label={kind} {value}&label-size=8&label-overhang=9",
                                           "smooth=40&stroke=black&simplify=2",
                                           "grow=2&stroke=black"));

TEST(ChangedTiles, OfTheSameDataAreNone) {
  EditedLand land(3);
  const auto before = land.load();
  const auto after = land.load();
  for (const Certainty certainty : kCertaintyNames.values()) {
    EXPECT_THAT(changed("", certainty, before, after), ::testing::IsEmpty());
  }
}

/// A layer of these features of a GeoJSON.
std::shared_ptr<const Dataset> load_land(const std::string& features,
                                         bool has_fast_topology = false) {
  const TemporaryFolder folder;
  auto layers = layers_of_files({folder.write(
      "land.geojson", R"({"type":"FeatureCollection","features":[)" + features + "]}")});
  layers[0].fast_topology = has_fast_topology;
  return Dataset::load(layers);
}

TEST(ChangedTiles, WithOtherLabelsAreListed) {
  const auto land_with = [](const std::string& name) {
    return load_land(R"({"type":"Feature","properties":{"name":")" + name +
                     R"("},"geometry":{"type":"Polygon","coordinates":)" +
                     R"([[[0.1,0.1],[80,0.1],[80,60],[0.1,60],[0.1,0.1]]]}})");
  };
  const auto before = land_with("Aland");
  const auto after = land_with("Bland");
  const std::string style = "fill=ddd&label=name";
  ChangeRequest request = request_of(style, Certainty::bytes);
  request.zooms = {1, 2};
  const auto tiles = changed_tiles(request, before, after)->tiles;
  EXPECT_THAT(set_of(tiles), ::testing::Contains(std::tuple(1, 1u, 0u)));
  EXPECT_THAT(set_of(tiles), ::testing::Contains(std::tuple(2, 2u, 1u)));
}

TEST(ChangedTiles, OfLargerScalesAreCandidatesToo) {
  const auto land_with = [](const std::string& vertex) {
    return load_land(
        R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":)"
        R"([[[0.2,0.2],[1,0.25],[0.95,0.8],[0.25,0.75],[)" +
        vertex + R"(],[0.2,0.2]]]}})");
  };
  const auto before = land_with("0.2249,0.47501");
  const auto after = land_with("0.2241,0.47508");
  ChangeRequest drawn = request_of("", Certainty::bytes);
  drawn.zooms = {8, 8};
  EXPECT_THAT(changed_tiles(drawn, before, after)->tiles, ::testing::IsEmpty());
  drawn.tile.scale = 2;  // shows the vertex
  const Tiles different = set_of(changed_tiles(drawn, before, after)->tiles);
  EXPECT_THAT(different, ::testing::Contains(std::tuple(8, 128u, 127u)));
  ChangeRequest request = request_of("", Certainty::candidates);
  request.zooms = {8, 8};
  request.most_scale = 4;
  EXPECT_TRUE(holds_all(set_of(changed_tiles(request, before, after)->tiles), different));
}

TEST(ChangedTiles, WithoutTheTopologyTestAreListed) {
  const auto land_to = [](const std::string& east) {
    return load_land(
        R"({"type":"Feature","properties":{},"geometry":)"
        R"({"type":"Polygon","coordinates":[[[1,1],[9,1],[9,9],[1,9],[1,1]]]}},{"type":"Feature",)"
        R"("properties":{},"geometry":{"type":"Polygon","coordinates":[[[5,5],[)" +
            east + ",5],[" + east + ",15],[5,15],[5,5]]]}}",
        true);
  };
  const auto before = land_to("15");  // the features overlap
  const auto after = land_to("17");
  const std::string style = "topology=fast";
  for (const Certainty certainty : kCertaintyNames.values()) {
    EXPECT_THAT(changed(style, certainty, before, after), ::testing::Not(::testing::IsEmpty()));
    EXPECT_THAT(changed(style, certainty, before, before), ::testing::IsEmpty());
  }
}

/// A feature of that kind; `ring` is a JSON array of positions.
std::string feature_of(const std::string& kind, const std::string& ring) {
  return R"({"type":"Feature","properties":{"kind":")" + kind +
         R"("},"geometry":{"type":"Polygon","coordinates":[)" + ring + "]}}";
}

TEST(ChangedTiles, IncludeThoseOfJoinedLinesOfAFeatureThatOverlapsAnotherElsewhere) {
  // Two fields share borders with a long one. At its other end, a pond comes to overlap it.
  const auto land_with = [](const std::string& pond) {
    return load_land(feature_of("long", "[[0,0],[20,0],[20,5],[10,5],[5,5],[0,5],[0,0]]") + "," +
                     feature_of("field", "[[0,5],[5,5],[5,10],[0,10],[0,5]]") + "," +
                     feature_of("field", "[[5,5],[10,5],[12.5,12.5],[5,10],[5,5]]") + "," +
                     feature_of("pond", pond));
  };
  const auto before = land_with("[[25,1],[28,1],[28,2.5],[25,2.5],[25,1]]");
  const auto after = land_with("[[19,1],[22,1],[22,2.5],[19,2.5],[19,1]]");
  const std::string style = "fill=cde&stroke=black&stroke-width=6&stroke-linejoin=bevel";
  const Tiles different = Drawn(style).different(before, after);
  EXPECT_EQ(changed(style, Certainty::bytes, before, after), different);
  EXPECT_TRUE(holds_all(changed(style, Certainty::fingerprints, before, after), different));
  // In candidates of a style with other joins.
  const std::string round = "fill=cde&stroke=black&stroke-width=6";
  EXPECT_TRUE(holds_all(changed(round, Certainty::candidates, before, after), different));
}

TEST(ChangedTiles, AreNotThoseWhereATranslucentFeatureOverlapsNothing) {
  // Two woods that cross, a long field, and a pond that comes to overlap the far end of the field.
  const auto land_with = [](const std::string& pond) {
    return load_land(
        feature_of("field", "[[5e-5,7e-4],[4e-3,7e-4],[4e-3,9e-4],[5e-5,9e-4],[5e-5,7e-4]]") + "," +
        feature_of("wood", "[[1e-4,1e-4],[6e-4,2.3e-4],[6e-4,3.3e-4],[1e-4,2e-4],[1e-4,1e-4]]") +
        "," +
        feature_of("wood", "[[2e-4,5e-5],[3e-4,5e-5],[4.7e-4,6e-4],[3.7e-4,6e-4],[2e-4,5e-5]]") +
        "," + feature_of("pond", pond));
  };
  const auto before =
      land_with("[[5e-3,7.5e-4],[5.4e-3,7.5e-4],[5.4e-3,8e-4],[5e-3,8e-4],[5e-3,7.5e-4]]");
  const auto after =
      land_with("[[3.8e-3,7.5e-4],[4.2e-3,7.5e-4],[4.2e-3,8e-4],[3.8e-3,8e-4],[3.8e-3,7.5e-4]]");
  TilePainter painter(std::make_unique<SoftwareRenderer>());
  const auto fingerprint_in = [&painter](const std::shared_ptr<const Dataset>& dataset) {
    TileRequest request =
        request_of("color-by=kind&classes=wood:green,field:ff000080", Certainty::bytes).tile;
    request.tile = {18, 131072, 131071};  // the woods and an end of the field
    const auto plan = plan_tile(request, dataset);
    return painter.identify({&*plan});
  };
  EXPECT_EQ(fingerprint_in(before), fingerprint_in(after));
}

TEST(ChangedTiles, OfFacesAreThoseOfAllFeaturesBehindOneThatWasDeleted) {
  const std::string first = feature_of("pond", "[[-20,5],[-19,5],[-19,6],[-20,6],[-20,5]]");
  const std::string others = feature_of("field", "[[0,5],[5,5],[5,10],[0,10],[0,5]]") + "," +
                             feature_of("field", "[[10,5],[15,5],[15,10],[10,10],[10,5]]");
  const auto before = load_land(first + "," + others);
  const auto after = load_land(others);
  for (const Certainty certainty : kCertaintyNames.values()) {
    ChangeRequest request = request_of("debug=faces", certainty);
    request.zooms = {4, 4};
    const Tiles found = set_of(changed_tiles(request, before, after)->tiles);
    EXPECT_TRUE(found.contains({4, 8, 7})) << "the fields";
    EXPECT_TRUE(found.contains({4, 7, 7})) << "the pond";
    EXPECT_TRUE(changed_tiles(request, before, before)->tiles.empty());
  }
}

TEST(ChangedTiles, EndAtTheZoomWithTooMany) {
  EditedLand one(3);
  EditedLand other(4);
  ChangeRequest request = request_of("", Certainty::candidates);
  request.zooms = {0, 24};
  request.most_tiles = 5000;
  const auto found = changed_tiles(request, one.load(), other.load());
  EXPECT_FALSE(found->is_complete);
  EXPECT_GT(found->zooms.last, 8);
  EXPECT_LT(found->zooms.last, 14);
  EXPECT_EQ(found->tiles.back().z, found->zooms.last);
}

TEST(ChangedTiles, ZoomsAreParsed) {
  EXPECT_EQ(parse_zooms("7")->first, 7);
  EXPECT_EQ(parse_zooms("0-24")->last, 24);
  for (const char* text :
       {"", "-", "3-", "-3", "4-3", "0-25", "a", "1-2-3", "1 -2", "99999999999"}) {
    EXPECT_EQ(parse_zooms(text), std::nullopt) << text;
  }
}

TEST(TileList, IsWrittenInEveryFormat) {
  const std::vector<TileId> tiles = {{0, 0, 0}, {3, 4, 2}};
  EXPECT_EQ(tile_list(tiles, TileListFormat::text), "0/0/0\n3/4/2\n");
  EXPECT_EQ(tile_list({}, TileListFormat::text), "");
  EXPECT_EQ(tile_list(tiles, TileListFormat::json), "[\"0/0/0\",\"3/4/2\"]\n");
  EXPECT_EQ(tile_list({}, TileListFormat::json), "[]\n");
  const std::string geojson = tile_list(tiles, TileListFormat::geojson);
  EXPECT_THAT(geojson, ::testing::HasSubstr(R"("properties":{"z":3,"x":4,"y":2})"));
  EXPECT_THAT(geojson, ::testing::HasSubstr("[[[0.0000000,40.9798981],[45.0000000,40.9798981],"
                                            "[45.0000000,66.5132604],[0.0000000,66.5132604],"
                                            "[0.0000000,40.9798981]]]"));
}

}  // namespace
}  // namespace trapeze
