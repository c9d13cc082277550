#include "server/tiles/read_tile_matrix_set.h"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace trapeze {
namespace {

using ::testing::HasSubstr;

const std::string kMatrix =
    R"({"id":"0","scaleDenominator":1000000,"cellSize":280,"pointOfOrigin":[2420000,1350000],)"
    R"("tileWidth":256,"tileHeight":256,"matrixWidth":7,"matrixHeight":5})";

std::string set_of(const std::string& matrices,
                   const std::string& crs = "http://www.opengis.net/def/crs/EPSG/0/2056") {
  return R"({"id":"Own","title":"An own one","crs":")" + crs + R"(","tileMatrices":[)" + matrices +
         "]}";
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string failure_of(const std::string& json) {
  try {
    parse_tile_matrix_set(json);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing is wrong";
}

TEST(ReadTileMatrixSetTest, ReadsBothVersionsOfTheStandard) {
  const auto set = parse_tile_matrix_set(set_of(kMatrix));
  EXPECT_EQ(set->id, "Own");
  EXPECT_EQ(set->system->name, "EPSG:2056");
  ASSERT_EQ(set->matrices.size(), 1u);
  EXPECT_EQ(set->matrices[0].west, 2'420'000);
  EXPECT_EQ(set->matrices[0].origin_y, 1'350'000);
  EXPECT_EQ(set->matrices[0].width, 7u);
  std::string old = set_of(kMatrix, "urn:ogc:def:crs:EPSG::2056");
  for (const auto& [from, to] :
       {std::pair("\"id\":\"Own\"", "\"identifier\":\"Own\""),
        std::pair("\"id\":\"0\"", "\"identifier\":\"0\""), std::pair("\"crs\"", "\"supportedCRS\""),
        std::pair("tileMatrices", "tileMatrix"), std::pair("\"cellSize\":280,", ""),
        std::pair("pointOfOrigin", "topLeftCorner")}) {
    old = changed(old, from, to);
  }
  const auto of_old = parse_tile_matrix_set(old);
  EXPECT_EQ(of_old->system->name, "EPSG:2056");
  EXPECT_NEAR(of_old->matrices[0].cell_size, 280, 1e-9);
  EXPECT_EQ(of_old->matrices[0].west, 2'420'000);
}

TEST(ReadTileMatrixSetTest, HasTheAxesOfTheAuthority) {
  const auto set =
      parse_tile_matrix_set(set_of(kMatrix, "http://www.opengis.net/def/crs/EPSG/0/3035"));
  EXPECT_EQ(set->matrices[0].origin_y, 2'420'000) << "northing is first";
  EXPECT_EQ(set->matrices[0].west, 1'350'000);
}

TEST(ReadTileMatrixSetTest, RowsMayBeCountedFromTheSouth) {
  const std::string from_south =
      changed(kMatrix, "\"pointOfOrigin\":[2420000,1350000]",
              "\"cornerOfOrigin\":\"bottomLeft\",\"pointOfOrigin\":[2420000,991600]");
  const auto north = parse_tile_matrix_set(set_of(kMatrix));
  const auto south = parse_tile_matrix_set(set_of(from_south));
  EXPECT_FALSE(south->is_from_north());
  for (const std::uint32_t row : {0u, 1u, 4u}) {
    const View a = north->view_of({0, 3, row}, 1);
    const View b = south->view_of({0, 3, 4 - row}, 1);
    EXPECT_EQ(a.origin_x, b.origin_x);
    EXPECT_EQ(a.origin_y, b.origin_y);
  }
}

TEST(ReadTileMatrixSetTest, TellsWhatIsWrong) {
  const auto with = [](const std::string& from, const std::string& to) {
    return failure_of(set_of(changed(kMatrix, from, to)));
  };
  EXPECT_THAT(failure_of("{"), HasSubstr("is no JSON object"));
  EXPECT_THAT(failure_of("[1]"), HasSubstr("is no JSON object"));
  EXPECT_THAT(failure_of(set_of("")), HasSubstr("tileMatrices is no list of 1 to 100"));
  EXPECT_THAT(failure_of(set_of(kMatrix + "," + kMatrix)),
              HasSubstr("two tile matrices are \"0\""));
  EXPECT_THAT(failure_of(set_of("3")), HasSubstr("tile matrix 0 is no object"));
  EXPECT_THAT(failure_of(set_of(kMatrix, "EPSG:99999")), HasSubstr("PROJ does not know"));
  EXPECT_THAT(failure_of(set_of(kMatrix, "http://example.org/")), HasSubstr("is not understood"));
  EXPECT_THAT(failure_of(changed(set_of(kMatrix), "Own", "../own")), HasSubstr("letters, digits"));
  EXPECT_THAT(with("\"cellSize\":280", "\"cellSize\":300"), HasSubstr("does not fit"));
  EXPECT_THAT(with("1000000", "-5"), HasSubstr("scaleDenominator is no number"));
  EXPECT_THAT(with("1000000", "1e400"), HasSubstr("is no"));
  EXPECT_THAT(with("[2420000,1350000]", "[2420000]"), HasSubstr("no pair of numbers"));
  EXPECT_THAT(with("\"tileWidth\":256", "\"tileWidth\":0"), HasSubstr("tileWidth"));
  EXPECT_THAT(with("\"tileWidth\":256", "\"tileWidth\":2.5"), HasSubstr("no whole number"));
  EXPECT_THAT(with("\"tileHeight\":256", "\"tileHeight\":100000"), HasSubstr("tileHeight"));
  EXPECT_THAT(with("\"matrixWidth\":7", "\"matrixWidth\":1e12"), HasSubstr("matrixWidth"));
  EXPECT_THAT(with("\"id\":\"0\"", "\"id\":\"a/b\""), HasSubstr("cannot stand in an address"));
  EXPECT_THAT(with("\"matrixHeight\":5", "\"matrixHeight\":5,\"variableMatrixWidths\":[{}]"),
              HasSubstr("variableMatrixWidths"));
  EXPECT_THAT(with("\"pointOfOrigin\"", "\"cornerOfOrigin\":\"middle\",\"pointOfOrigin\""),
              HasSubstr("topLeft or bottomLeft"));
}

TEST(ReadTileMatrixSetTest, TheExamplesAreSound) {
  const std::string folder = TRAPEZE_CONFIG_FOLDER "/tile_matrix_sets/";
  const TileMatrixSets sets =
      tile_matrix_sets_with({folder + "swiss_lv95.json", folder + "british_national_grid.json",
                             folder + "dutch_rd.json", folder + "german_utm32.json"});
  for (const auto& [id, system] :
       {std::pair("SwissLV95", "EPSG:2056"), std::pair("BritishNationalGrid", "EPSG:27700"),
        std::pair("DutchRD", "EPSG:28992"), std::pair("GermanUTM32", "EPSG:25832"),
        std::pair("EuropeanETRS89_LAEAQuad", "EPSG:3035"),
        std::pair("UPSArcticWGS84Quad", "EPSG:5041"),
        std::pair("UPSAntarcticWGS84Quad", "EPSG:5042")}) {
    const auto set = sets.find(id);
    ASSERT_NE(set, nullptr) << id;
    EXPECT_EQ(set->system->name, system);
    for (std::size_t i = 1; i < set->matrices.size(); ++i) {
      EXPECT_LT(set->matrices[i].cell_size, set->matrices[i - 1].cell_size) << id << " " << i;
    }
  }
  // The published values.
  EXPECT_NEAR(sets.find("EuropeanETRS89_LAEAQuad")->matrices[0].scale_denominator,
              62779017.857142866, 1e-6);
  EXPECT_NEAR(sets.find("UPSAntarcticWGS84Quad")->matrices[0].scale_denominator, 458726544.4, 1);
  EXPECT_NEAR(sets.find("GermanUTM32")->matrices[0].zoom(), 5, 1e-6);
  EXPECT_THROW(tile_matrix_sets_with({folder + "swiss_lv95.json", folder + "swiss_lv95.json"}),
               std::runtime_error);
  EXPECT_THROW(tile_matrix_sets_with({folder + "none.json"}), std::runtime_error);
}

}  // namespace
}  // namespace trapeze
