#include "core/io/source/source_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/load/load_layer.h"
#include "core/io/prepared/open_layer.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/source/source_name.h"
#include "core/io/source/source_stamp.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kMixed = TRAPEZE_FIXTURES "/mixed.geojson";
const std::string kVillage = TRAPEZE_FIXTURES "/village.osm";

TestFeature square(int number, const std::string& text) {
  const std::string x = std::to_string(2 * number);
  const std::string right = std::to_string(2 * number + 1);
  return {"POLYGON((" + x + " 0," + right + " 0," + right + " 1," + x + " 1," + x + " 0))", number,
          text};
}

class SourceSelectionTest : public ::testing::Test {
 protected:
  SourceSelectionTest() {
    write_source(town_, "GPKG",
                 {{.name = "houses",
                   .type = wkbPolygon,
                   .features = {square(1, "stone"), square(2, "wood"), square(3, "stone")}},
                  {.name = "lakes", .type = wkbPolygon, .features = {square(4, "deep")}},
                  {.name = "wells", .type = wkbPoint, .features = {{"POINT(0 0)", 5, "dry"}}}});
  }

  static std::vector<std::int64_t> numbers(const Layer& layer) {
    const FeatureTable& table = layer.features();
    std::vector<std::int64_t> numbers;
    for (std::uint32_t row = 0; row < table.size(); ++row) {
      numbers.push_back(std::get<std::int64_t>(table.value(row, table.field_index("number"))));
    }
    return numbers;
  }

  static std::string failure_of(const std::string& path, const SourceSelection& selection) {
    try {
      load_layer(path, {.selection = selection});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "was loaded";
  }
  std::string failure_of(const SourceSelection& selection) const {
    return failure_of(town_, selection);
  }

  TemporaryFolder folder_;
  const std::string town_ = folder_.file("town.gpkg");
};

TEST_F(SourceSelectionTest, TakesAllThatHoldPolygonsUnlessToldOtherwise) {
  EXPECT_THAT(numbers(*load_layer(town_).layer), ElementsAre(1, 2, 3, 4));
}

TEST_F(SourceSelectionTest, TakesFeaturesByIdInTheOrderInWhichTheyAreNamed) {
  const auto of_ids = [&](std::vector<std::int64_t> ids, const std::string& where) {
    return numbers(
        *load_layer(town_, {.selection = {.layer = "houses", .where = where, .ids = ids}}).layer);
  };
  EXPECT_THAT(of_ids({3, 1}, ""), ElementsAre(3, 1));
  EXPECT_THAT(of_ids({2, 77, 3}, ""), ElementsAre(2, 3)) << "77 is not there";
  EXPECT_THAT(of_ids({3, 2, 1}, "text = 'stone' OR number = 9"), ElementsAre(3, 1));
  EXPECT_THAT(of_ids({}, ""), ElementsAre());
  std::vector<std::int64_t> many(5000);
  std::iota(many.rbegin(), many.rend(), -4000);
  EXPECT_THAT(of_ids(many, ""), ElementsAre(3, 2, 1)) << "in several requests";
}

TEST_F(SourceSelectionTest, TakesFeaturesOfAFileById) {
  const std::string file = folder_.file("town.geojson");
  write_source(
      file, "GeoJSON",
      {{.type = wkbPolygon, .features = {square(1, "a"), square(2, "b"), square(3, "c")}}});
  EXPECT_THAT(numbers(*load_layer(file, {.selection = {.ids = {{2, 0}}}}).layer),
              ElementsAre(3, 1));
}

TEST_F(SourceSelectionTest, TakesOneLayerOfSeveral) {
  const LoadedLayer lakes = load_layer(town_, {.selection = {.layer = "lakes"}});
  EXPECT_THAT(numbers(*lakes.layer), ElementsAre(4));
  EXPECT_EQ(lakes.report.features, 1u);
  EXPECT_EQ(lakes.report.other_geometry, 0u);
}

TEST_F(SourceSelectionTest, TakesTheFeaturesForWhichAConditionHolds) {
  const SourceSelection stone = {.layer = "houses", .where = "text = 'stone' AND number > 1"};
  const LoadedLayer loaded = load_layer(town_, {.selection = stone});
  EXPECT_THAT(numbers(*loaded.layer), ElementsAre(3));
  EXPECT_EQ(loaded.report.features, 1u);
  // Applies to all layers if none is named.
  EXPECT_THAT(numbers(*load_layer(town_, {.selection = {.where = "number >= 3"}}).layer),
              ElementsAre(3, 4));
}

TEST_F(SourceSelectionTest, ReadsAConditionOnOpenStreetMapToo) {
  const std::size_t all = load_layer(kVillage).report.loaded;
  const LoadedLayer houses = load_layer(kVillage, {.selection = {.where = "building = 'house'"}});
  EXPECT_GT(houses.report.loaded, 0u);
  EXPECT_LT(houses.report.loaded, all);
  const FeatureTable& table = houses.layer->features();
  for (std::uint32_t row = 0; row < table.size(); ++row) {
    EXPECT_EQ(table.value(row, table.field_index("building")), Value("house"));
  }
}

std::string with_attributes(int count) {
  std::string properties;
  for (int i = 0; i < count; ++i) {
    properties += (i == 0 ? "\"c" : ",\"c") + std::to_string(i) + "\":" + std::to_string(i);
  }
  return R"({"type":"Feature","properties":{)" + properties +
         R"(},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}})";
}

TEST_F(SourceSelectionTest, TooManyAttributesAreRefusedWithTheFigure) {
  const std::string most = folder_.write("most.geojson", with_attributes(4096));
  EXPECT_EQ(load_layer(most, {}).layer->features().fields().size(), 4096U);
  const std::string wide = folder_.write("wide.geojson", with_attributes(4097));
  EXPECT_EQ(failure_of(wide, {}),
            wide +
                ": has 4097 attributes, of which there can be 4096 at most; `ogr2ogr "
                "-select` makes a copy with those that are needed");
}

TEST_F(SourceSelectionTest, KeepsTheNamedAttributesInTheOrderOfTheSource) {
  const SourceSelection selection = {.attributes = {{"text"}}};
  const LoadedLayer loaded = load_layer(town_, {.selection = selection});
  ASSERT_EQ(loaded.layer->features().fields().size(), 1u);
  EXPECT_EQ(loaded.layer->features().fields()[0].name, "text");
  EXPECT_EQ(std::get<std::string_view>(loaded.layer->features().value(3, 0)), "deep");

  const LoadedLayer bare = load_layer(town_, {.selection = {.attributes = {{}}}});
  EXPECT_TRUE(bare.layer->features().fields().empty());
  EXPECT_EQ(bare.layer->features().size(), 4u);
  // A condition may use an attribute that is not kept.
  const SourceSelection both = {.where = "number = 2", .attributes = {{"text"}}};
  EXPECT_EQ(load_layer(town_, {.selection = both}).report.loaded, 1u);
}

TEST_F(SourceSelectionTest, SaysWhatIsNotThere) {
  EXPECT_THAT(
      failure_of({.layer = "roads"}),
      AllOf(StartsWith(town_), HasSubstr("no layer \"roads\""), HasSubstr("houses, lakes, wells")));
  EXPECT_THAT(failure_of({.layer = "wells"}), HasSubstr("\"wells\" holds no polygons"));
  EXPECT_THAT(failure_of({.attributes = {{"text", "colour"}}}),
              AllOf(StartsWith(town_), HasSubstr("no attribute \"colour\"")));
}

TEST_F(SourceSelectionTest, SaysInOneLineWhichConditionALayerDoesNotUnderstand) {
  for (const std::string& path : {town_, kMixed}) {  // a database, and GDAL filtering
    for (const std::string where : {"colour = 'red'", "number = "}) {
      EXPECT_THAT(failure_of(path, {.where = where}),
                  AllOf(StartsWith(path), HasSubstr("cannot be asked where " + where + ": "),
                        ::testing::Not(HasSubstr("\n")), ::testing::Not(HasSubstr("^"))));
    }
  }
}

TEST_F(SourceSelectionTest, AConditionIsOneCondition) {
  for (const std::string& path : {town_, kMixed}) {
    for (const std::string where :
         {"number = 1; DROP TABLE houses", "number = 1;", ";", "text = ''';' OR 1 = 1; x",
          "number = 1 /* ; */ ; SELECT 1", "number = 1 -- ;\n; SELECT 1"}) {
      EXPECT_THAT(failure_of(path, {.where = where}),
                  AllOf(StartsWith(path), HasSubstr("cannot be asked where " + where),
                        HasSubstr("a semicolon")));
    }
  }
  for (const std::string where :
       {"text <> 'a;b'", "text <> 'it''s;'", "\"text\" <> ';' AND \"number\" > 0",
        "number > 0 /* one; two */", "number > 0 -- one; two", "[number] > 0 AND `text` <> ';'"}) {
    const SourceSelection selection = {.layer = "houses", .where = where};
    EXPECT_THAT(numbers(*load_layer(town_, {.selection = selection}).layer), ElementsAre(1, 2, 3))
        << where;
  }
}

TEST_F(SourceSelectionTest, ANameInQuotesIsTheNameOfAColumn) {
  const std::string copy = folder_.file("copy.sqlite");
  write_source(copy, "SQLite", {{.type = wkbPolygon, .features = {square(1, "stone")}}});
  for (const std::string& path : {town_, copy, kMixed}) {
    for (const std::string where : {"\"colour\" > 1", "\"colour\" = 'red'", "text = \"stone\""}) {
      EXPECT_THAT(failure_of(path, {.where = where}),
                  AllOf(StartsWith(path), HasSubstr("cannot be asked where " + where + ": ")));
    }
  }
  for (const std::string where : {"\"TEXT\" = 'stone'", "text || '\"x\"' = 'stone\"x\"'"}) {
    const SourceSelection stone = {.layer = "houses", .where = where};
    EXPECT_THAT(numbers(*load_layer(town_, {.selection = stone}).layer), ElementsAre(1, 3));
  }
}

TEST_F(SourceSelectionTest, AConditionThatHoldsForNothingIsUnderstood) {
  EXPECT_EQ(load_layer(town_, {.selection = {.where = "number > 100"}}).report.loaded, 0u);
}

TEST_F(SourceSelectionTest, TellsAllThatIsMissingAtOnce) {
  try {
    load_layer(town_, {.selection = {.where = "colour = 1", .attributes = {{"a", "text", "b"}}}});
    FAIL();
  } catch (const SelectionError& error) {
    ASSERT_EQ(error.problems().size(), 3u);
    EXPECT_EQ(error.problems()[0].part, SelectionPart::where);
    EXPECT_EQ(error.problems()[1].part, SelectionPart::attributes);
    EXPECT_EQ(error.problems()[1].index, 0u);
    EXPECT_EQ(error.problems()[2].index, 2u);
    EXPECT_THAT(error.what(), AllOf(HasSubstr("where colour = 1"), HasSubstr("; has no attribute "
                                                                             "\"a\"; has no")));
  }
}

TEST_F(SourceSelectionTest, FindsTheSameWithoutReading) {
  const auto parts = [this](const OpenOptions& options) {
    std::vector<OpenPart> found;
    for (const OpenFinding& finding : examine_layer(town_, options)) {
      EXPECT_THAT(finding.what, StartsWith(town_));
      found.push_back(finding.part);
    }
    return found;
  };
  EXPECT_THAT(parts({}), ::testing::IsEmpty());
  EXPECT_THAT(parts({.selection = {.where = "a = 1", .attributes = {{"b"}}}}),
              ElementsAre(OpenPart::where, OpenPart::attributes));
  EXPECT_THAT(parts({.selection = {.layer = "roads"}}), ElementsAre(OpenPart::layer));
  EXPECT_THAT(parts({.coverage = CoverageMode::off, .close_gaps = 1}),
              ElementsAre(OpenPart::close_gaps));
  EXPECT_THAT(parts({.coverage = CoverageMode::off, .merge = 1}), ElementsAre(OpenPart::merge));
  std::filesystem::resize_file(town_, 5000);
  EXPECT_THAT(parts({}), ElementsAre(OpenPart::file));
  std::filesystem::remove(town_);
  EXPECT_THAT(parts({}), ElementsAre(OpenPart::file));
}

TEST_F(SourceSelectionTest, OfAPreparedLayerTakesTheSourceOnly) {
  const LoadedLayer houses = load_layer(town_, {.selection = {.layer = "houses"}});
  const std::string path = folder_.file("houses.trapeze");
  save_prepared_layer(path, houses, 1, stamp_source(town_));
  EXPECT_EQ(open_layer(path).layer->features().size(), 3u);
  OpenOptions options;
  options.selection.where = "number = 1";
  EXPECT_THROW(open_layer(path, options), std::runtime_error);
}

TEST(NameOfSourceTest, HidesPasswordsAndNothingElse) {
  for (const char* plain :
       {"/maps/a.gpkg", "/vsizip/a.zip/b.shp", "PG:host=db user=me dbname=x",
        "postgresql://me@db/maps", "/vsicurl/https://example.org/a.fgb", "ODBC:me@maps,roads",
        "OCI:", "/maps/key=1/a.fgb", "/vsicurl/https://a.org/b?tokens=2&x=1"}) {
    EXPECT_EQ(name_of_source(plain), plain);
  }
  EXPECT_EQ(name_of_source("PG:host=db password=secret user=me"),
            "PG:host=db password=*** user=me");
  EXPECT_EQ(name_of_source("PG:dbname='a' PASSWORD = 'se\\'cr et' user='me'"),
            "PG:dbname='a' PASSWORD = *** user='me'");
  EXPECT_EQ(name_of_source("postgresql://me:secret@db:5432/maps"),
            "postgresql://me:***@db:5432/maps");
  EXPECT_EQ(name_of_source("postgresql://db/maps?user=me&password=secret&x=1"),
            "postgresql://db/maps?user=me&password=***&x=1");
  EXPECT_EQ(name_of_source("MSSQL:server=db;uid=me;PWD=se cret;database=x"),
            "MSSQL:server=db;uid=me;PWD=***;database=x");
  EXPECT_EQ(name_of_source("MSSQL:uid=me;pwd={a;b};database=x"), "MSSQL:uid=me;pwd=***;database=x");
  EXPECT_EQ(name_of_source("/vsicurl/https://me:secret@example.org/a.fgb"),
            "/vsicurl/https://me:***@example.org/a.fgb");
  EXPECT_EQ(name_of_source("ODBC:me/sec@ret@maps,a@b"), "ODBC:me/***@maps,a@b");
  EXPECT_EQ(name_of_source("OCI:me/secret@db:land"), "OCI:me/***@db:land");
}

TEST(NameOfSourceTest, HidesKeysInTheQueryOfAUrl) {
  EXPECT_EQ(name_of_source("WFS:https://a.org/wfs?access_token=se/cret&service=WFS"),
            "WFS:https://a.org/wfs?access_token=***&service=WFS");
  EXPECT_EQ(name_of_source("/vsicurl/https://a.org/b.fgb?sv=1&sig=a%2Fb&se=2"),
            "/vsicurl/https://a.org/b.fgb?sv=1&sig=***&se=2");
  EXPECT_EQ(name_of_source("/vsicurl/https://a.org/b?X-Amz-Signature=12&API_KEY=3#part"),
            "/vsicurl/https://a.org/b?X-Amz-Signature=***&API_KEY=***#part");
}

TEST(NameOfSourceTest, HidesAllOfAPasswordOfAnyCharacters) {
  EXPECT_EQ(name_of_source("PG:password='se cret"), "PG:password=***");
  EXPECT_EQ(name_of_source("PG:password='a\\\\' user='me'"), "PG:password=*** user='me'");
  EXPECT_EQ(name_of_source("PG:password='' host=db"), "PG:password=*** host=db");
  EXPECT_EQ(name_of_source("PG:password=password=a password=b"), "PG:password=*** password=***");
  EXPECT_EQ(name_of_source("PG:password= "), "PG:password= ");
  EXPECT_EQ(name_of_source("PG:host=db password=se&cret user=me"),
            "PG:host=db password=*** user=me");
  EXPECT_EQ(name_of_source("PG:password=se\\ cret\\' user=me"), "PG:password=*** user=me");
  EXPECT_EQ(name_of_source("PG:password=secret\\"), "PG:password=***");
  EXPECT_EQ(name_of_source("postgresql://db/maps?sslpassword=secret&user=me"),
            "postgresql://db/maps?sslpassword=***&user=me");
  EXPECT_EQ(name_of_source("password"), "password");
  EXPECT_EQ(name_of_source("postgresql://me:se@cret@db/maps"), "postgresql://me:***@db/maps");
  EXPECT_EQ(name_of_source("postgresql://me:@db/maps"), "postgresql://me:***@db/maps");
  EXPECT_EQ(name_of_source("postgresql://me@db:5432/maps"), "postgresql://me@db:5432/maps");
}

TEST(NameOfSourceTest, APasswordMayBeOfAnyLength) {
  const std::string secret(1'000'000, 'a');
  EXPECT_EQ(name_of_source("PG:password='" + secret + "'"), "PG:password=***");
  EXPECT_EQ(name_of_source("PG:password=" + secret), "PG:password=***");
  EXPECT_EQ(name_of_source("postgresql://me:" + secret + "@db"), "postgresql://me:***@db");
  EXPECT_EQ(name_of_source("postgresql://" + secret), "postgresql://" + secret);
}

}  // namespace
}  // namespace trapeze
