#include "core/io/export/export_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <random>

#include <ogrsf_frmts.h>

#include "core/graph/check_graph.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_ring_reader.h"
#include "core/sweep/graph_builder.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::vector<std::string> kExtensions = {".fgb", ".gpkg", ".geojson"};
const std::string kSquare = "POLYGON((0 0,100 0,100 100,0 100,0 0))";

/// A file as another program sees it.
class Written {
 public:
  explicit Written(const std::string& path)
      : dataset_(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR)) {
    if (dataset_ == nullptr) throw std::runtime_error("cannot open " + path);
    EXPECT_EQ(dataset_->GetLayerCount(), 1);
    layer_ = dataset_->GetLayer(0);
    for (OGRFeature* feature = layer_->GetNextFeature(); feature != nullptr;
         feature = layer_->GetNextFeature()) {
      features_.emplace_back(feature);
    }
    std::sort(features_.begin(), features_.end(), [](const auto& a, const auto& b) {
      return a->GetFieldAsInteger64("trapeze_id") < b->GetFieldAsInteger64("trapeze_id");
    });
  }

  std::size_t size() const { return features_.size(); }
  OGRLayer& layer() const { return *layer_; }
  /// In ascending order of trapeze_id.
  const OGRFeature& operator[](std::size_t i) const { return *features_[i]; }

  std::vector<std::string> texts(const char* field) const {
    std::vector<std::string> texts;
    for (const auto& feature : features_) {
      const int index = feature->GetFieldIndex(field);
      texts.push_back(index < 0 ? "no such field" : feature->GetFieldAsString(index));
    }
    return texts;
  }
  std::vector<std::string> field_names() const {
    std::vector<std::string> names;
    OGRFeatureDefn& definition = *layer_->GetLayerDefn();
    for (int i = 0; i < definition.GetFieldCount(); ++i) {
      names.emplace_back(definition.GetFieldDefn(i)->GetNameRef());
    }
    return names;
  }
  OGRFieldType type_of(const char* field) const {
    return layer_->GetLayerDefn()
        ->GetFieldDefn(layer_->GetLayerDefn()->GetFieldIndex(field))
        ->GetType();
  }
  std::string epsg() const { return layer_->GetSpatialRef()->GetAuthorityCode(nullptr); }
  bool are_all_valid() const {
    return std::all_of(features_.begin(), features_.end(), [](const auto& feature) {
      return feature->GetGeometryRef()->IsValid() != 0;
    });
  }

 private:
  GDALDatasetUniquePtr dataset_;
  OGRLayer* layer_ = nullptr;
  std::vector<OGRFeatureUniquePtr> features_;
};

std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

std::string error_of(const std::string& source, const std::string& output,
                     const ExportOptions& options = {}) {
  try {
    export_layer(source, output, options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

/// Metres of EPSG:3857; one is about 54 cells.
std::string metres_source(const TemporaryFolder& folder, const std::vector<TestFeature>& features) {
  const std::string path = folder.file("source.gpkg");
  write_source(path, "GPKG", {{.crs = "EPSG:3857", .features = features}});
  return path;
}

TEST(ExportLayerTest, NamesOfReferenceSystemsAreThoseOfEpsg) {
  EXPECT_EQ(kExportCrsNames.find("EPSG:4326"), ExportCrs::degrees);
  EXPECT_EQ(kExportCrsNames.find("EPSG:3857"), ExportCrs::web_mercator);
  EXPECT_FALSE(kExportCrsNames.find("EPSG:25832"));
}

class ExportFormatTest : public ::testing::TestWithParam<std::string> {
 protected:
  std::string output() const { return folder_.file("out" + GetParam()); }

  TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Formats, ExportFormatTest, ::testing::ValuesIn(kExtensions),
                         [](const auto& test) { return test.param.substr(1); });

/// Features 7 and 11 with a field of every kind, and one with nothing set.
std::string source_of_all_types(const TemporaryFolder& folder) {
  const std::string path = folder.file("types.gpkg");
  const GDALDatasetUniquePtr dataset = create_source(path, "GPKG");
  OGRSpatialReference reference = test_reference("EPSG:4326");
  OGRLayer& layer = *dataset->CreateLayer("types", &reference, wkbPolygon, nullptr);
  const std::map<std::string, OGRFieldType> fields = {
      {"whole", OFTInteger}, {"large", OFTInteger64}, {"real", OFTReal},
      {"text", OFTString},   {"day", OFTDate},        {"moment", OFTDateTime}};
  for (const auto& [name, type] : fields) {
    OGRFieldDefn field(name.c_str(), type);
    layer.CreateField(&field);
  }
  OGRFieldDefn flag("flag", OFTInteger);
  flag.SetSubType(OFSTBoolean);
  layer.CreateField(&flag);
  for (const int id : {7, 11, 20}) {
    const OGRFeatureUniquePtr row(OGRFeature::CreateFeature(layer.GetLayerDefn()));
    row->SetFID(id);
    row->SetGeometry(test_geometry("POLYGON((0 0,1 0,1 1,0 0))").get());
    if (id != 20) {
      row->SetField("whole", id);
      row->SetField("large", static_cast<GIntBig>(9'000'000'000 + id));
      row->SetField("real", 0.1 * id);
      row->SetField("text", id == 7 ? "Nürnberg" : "a \"b\"\nc");
      row->SetField("day", 1999, 12, id);
      row->SetField("moment", 2020, 1, 2, 3, 4, static_cast<float>(id), 100);
      row->SetField("flag", id == 7 ? 1 : 0);
    }
    EXPECT_EQ(layer.CreateFeature(row.get()), OGRERR_NONE);
  }
  return path;
}

TEST_P(ExportFormatTest, AttributesKeepTheirTypesAndEveryFeatureItsId) {
  const ExportReport report = export_layer(source_of_all_types(folder_), output());
  EXPECT_EQ(report.written, 3u);
  const Written written(output());
  EXPECT_THAT(written.texts("trapeze_id"), ElementsAre("7", "11", "20"));
  EXPECT_THAT(written.texts("whole"), ElementsAre("7", "11", ""));
  EXPECT_THAT(written.texts("large"), ElementsAre("9000000007", "9000000011", ""));
  EXPECT_THAT(written.texts("text"), ElementsAre("Nürnberg", "a \"b\"\nc", ""));
  EXPECT_THAT(written.texts("flag"), ElementsAre("1", "0", ""));
  EXPECT_EQ(written[1].GetFieldAsDouble("real"), 0.1 * 11);
  EXPECT_EQ(written.type_of("whole"), OFTInteger);
  EXPECT_EQ(written.type_of("large"), OFTInteger64);
  EXPECT_EQ(written.type_of("real"), OFTReal);
  EXPECT_EQ(written.type_of("text"), OFTString);
  EXPECT_EQ(written.type_of("moment"), OFTDateTime);
  EXPECT_THAT(written.texts("moment"),
              ElementsAre("2020/01/02 03:04:07+00", "2020/01/02 03:04:11+00", ""));
  EXPECT_THAT(written.texts("day")[0], HasSubstr("1999/12/07"));
  const OGRFieldDefn& flag =
      *written.layer().GetLayerDefn()->GetFieldDefn(written[0].GetFieldIndex("flag"));
  EXPECT_EQ(flag.GetSubType(), OFSTBoolean);
}

/// The map stored in a file, feature by feature.
std::vector<std::vector<PlainTrapezoid>> maps_of(const std::string& path) {
  FeatureSource source(path);
  SourceRingReader reader(source);
  GraphBuilder builder;
  std::map<std::int64_t, std::vector<PlainTrapezoid>> maps;
  for (SourceFeature next; source.next(next);) {
    TrapezoidalGraph graph;
    FeatureRings& feature =
        reader.read(*next.feature->GetGeomFieldRef(next.layer->geometry_field), next.layer_index);
    EXPECT_FALSE(builder.build(feature.rings, graph).noded);
    maps[next.feature->GetFieldAsInteger64("number")] = plain_trapezoids(graph);
  }
  std::vector<std::vector<PlainTrapezoid>> in_order;
  for (auto& [number, map] : maps) in_order.push_back(std::move(map));
  return in_order;
}

std::string wkt_of(std::span<const Point> ring) {
  std::string text = "(";
  for (std::size_t i = 0; i <= ring.size(); ++i) {
    const Point p = ring[i % ring.size()];
    text += (i > 0 ? "," : "") + std::to_string(0.037 * p.x) + " " + std::to_string(0.037 * p.y);
  }
  return text + ")";
}

TEST_P(ExportFormatTest, CoordinatesComeBackToTheSameCells) {
  std::mt19937 random(1);
  std::vector<TestFeature> features;
  for (int i = 0; i < 20; ++i) {
    const Point centre{40'000'000 * i - 400'000'000, 35'000'000 * i - 350'000'000};
    const std::string shell = wkt_of(random_star(random, centre, 50, 5'000, 9'000));
    const std::string hole = wkt_of(random_star(random, centre, 20, 100, 4'000));
    features.push_back({.wkt = "POLYGON(" + shell + "," + hole + ")", .number = i});
  }
  const std::string source = metres_source(folder_, features);
  for (const ExportCrs crs : {ExportCrs::degrees, ExportCrs::web_mercator}) {
    ExportOptions options;
    options.crs = crs;
    options.overwrite = true;
    export_layer(source, output(), options);
    EXPECT_EQ(maps_of(output()), maps_of(source));
    EXPECT_EQ(Written(output()).epsg(), crs == ExportCrs::degrees ? "4326" : "3857");
  }
}

TEST_P(ExportFormatTest, FeaturesOfSeveralPartsAreMultipolygonsAndIslandsArePartsToo) {
  const std::string source = metres_source(
      folder_, {{.wkt = "POLYGON((0 0,100 0,100 100,0 100,0 0),(20 20,80 20,80 80,20 80,20 20),"
                        "(40 40,60 40,60 60,40 60,40 40))"},
                {.wkt = kSquare}});
  const ExportReport report = export_layer(source, output());
  EXPECT_EQ(report.polygons, 3u);
  EXPECT_EQ(report.rings, 4u);
  const Written written(output());
  ASSERT_EQ(written.size(), 2u);
  EXPECT_TRUE(written.are_all_valid());
  const OGRGeometry& islands = *written[0].GetGeometryRef();
  ASSERT_EQ(wkbFlatten(islands.getGeometryType()), wkbMultiPolygon);
  EXPECT_EQ(islands.toMultiPolygon()->getNumGeometries(), 2);
  const bool has_one_type = GetParam() != ".geojson";
  EXPECT_EQ(wkbFlatten(written[1].GetGeometryRef()->getGeometryType()),
            has_one_type ? wkbMultiPolygon : wkbPolygon);
}

TEST_P(ExportFormatTest, WhatIsTooSmallIsLeftOutAndCounted) {
  const std::string source = metres_source(
      folder_, {{.wkt = kSquare, .number = 1},
                {.wkt = "POLYGON((500 0,501 0,501 1,500 0))", .number = 2},
                {.wkt = "POLYGON((0 500,50 501,100 500,100 600,0 600,0 500))", .number = 3}});
  ExportOptions options;
  options.epsilon = 200;  // 3.7 metres
  const ExportReport report = export_layer(source, output(), options);
  EXPECT_EQ(report.features, 3u);
  EXPECT_EQ(report.written, 2u);
  EXPECT_EQ(report.too_small, 1u);
  EXPECT_EQ(report.all_vertices, 12u);
  EXPECT_EQ(report.vertices, 8u);
  EXPECT_EQ(report.held, 0u);
  EXPECT_THAT(Written(output()).texts("number"), ElementsAre("1", "3"));
}

/// Two neighbours with a jagged border; one has vertices on it that the other lacks.
std::vector<TestFeature> jagged_neighbours() {
  std::string down;
  std::string up;
  for (int i = 1; i < 60; ++i) {
    const auto at = [](int k) {
      return std::to_string(500 + (k * 37) % 23) + " " + std::to_string(10 * k);
    };
    down += at(i) + ",";
    up += at(60 - i) + ",";
  }
  return {{.wkt = "POLYGON((0 0,500 0," + down + "500 600,0 600,0 0))", .number = 1},
          {.wkt = "POLYGON((1000 0,1000 600,500 600," + up + "500 0,1000 0))", .number = 2}};
}

TEST_P(ExportFormatTest, NeighboursKeepTheirBorderInCommon) {
  const std::string source = metres_source(folder_, jagged_neighbours());
  ExportOptions options;
  options.crs = ExportCrs::web_mercator;
  for (const double epsilon : {30.0, 300.0, 700.0}) {
    SCOPED_TRACE("tolerance " + std::to_string(epsilon));
    options.epsilon = epsilon;
    options.overwrite = true;
    options.generalization.coverage = CoverageMode::automatic;
    const ExportReport report = export_layer(source, output(), options);
    EXPECT_EQ(report.written, 2u);
    EXPECT_LT(report.vertices, report.all_vertices);
    const Written written(output());
    ASSERT_EQ(written.size(), 2u);
    EXPECT_TRUE(written.are_all_valid());
    const OGRGeometry& left = *written[0].GetGeometryRef();
    const OGRGeometry& right = *written[1].GetGeometryRef();
    const std::unique_ptr<OGRGeometry> both(left.Union(&right));
    EXPECT_TRUE(left.Touches(&right));
    EXPECT_NEAR(both->toSurface()->get_Area(), 1000 * 600, 60);
    EXPECT_EQ(wkbFlatten(both->getGeometryType()), wkbPolygon);
    EXPECT_EQ(both->toPolygon()->getNumInteriorRings(), 0) << "there is a gap";
  }
}

/// The vertices of a polygon's shell.
std::vector<std::pair<double, double>> shell_of(const OGRGeometry& geometry) {
  const OGRPolygon* polygon = wkbFlatten(geometry.getGeometryType()) == wkbPolygon
                                  ? geometry.toPolygon()
                                  : geometry.toMultiPolygon()->getGeometryRef(0);
  std::vector<std::pair<double, double>> points;
  for (const OGRPoint& point : polygon->getExteriorRing()) {
    points.emplace_back(point.getX(), point.getY());
  }
  return points;
}

TEST_P(ExportFormatTest, NeighboursGetFurtherVerticesTogether) {
  // Only the first polygon needs additional vertices to be valid in degrees, see below.
  const std::string source = metres_source(
      folder_, {{.wkt = "POLYGON((0 0,10000000 0,10000000 10000000,0 0),"
                        "(5010000 5000000,5100000 5000000,5100000 5050000,5010000 5000000))"},
                {.wkt = "POLYGON((0 0,10000000 10000000,0 10000000,0 0))"}});
  ExportOptions options;
  options.crs = ExportCrs::degrees;
  options.epsilon = 1;
  options.generalization.coverage = CoverageMode::automatic;
  const ExportReport report = export_layer(source, output(), options);
  EXPECT_EQ(report.subdivided, 2u);
  const Written written(output());
  ASSERT_EQ(written.size(), 2u);
  EXPECT_TRUE(written.are_all_valid());
  const auto first = shell_of(*written[0].GetGeometryRef());
  const auto second = shell_of(*written[1].GetGeometryRef());
  const auto is_common = [&second](const auto& point) { return std::ranges::count(second, point); };
  EXPECT_GT(std::ranges::count_if(first, is_common), 10);
  const std::unique_ptr<OGRGeometry> cut(
      written[0].GetGeometryRef()->Intersection(written[1].GetGeometryRef()));
  EXPECT_TRUE(cut->IsEmpty() || cut->getDimension() < 2) << "they overlap";
}

TEST_P(ExportFormatTest, WhatIsNearEachOtherIsWrittenAsOneBlock) {
  const std::string source =
      metres_source(folder_, {{.wkt = "POLYGON((0 0,100 0,100 100,0 100,0 0))"},
                              {.wkt = "POLYGON((110 0,210 0,210 100,110 100,110 0))"}});
  ExportOptions options;
  options.generalization.merge = 4;
  options.epsilon = 40;  // cells: 16 times as many are 12 m
  const ExportReport report = export_layer(source, output(), options);
  EXPECT_EQ(report.written, 1u);
  const Written written(output());
  ASSERT_EQ(written.size(), 1u);
  EXPECT_TRUE(written.are_all_valid());
}

TEST_P(ExportFormatTest, AFileOfWhichNothingIsLeftHasFieldsAndNoFeatures) {
  const std::string source = metres_source(folder_, {{.wkt = kSquare}});
  ExportOptions options;
  options.epsilon = 1e9;
  EXPECT_EQ(export_layer(source, output(), options).written, 0u);
  const Written written(output());
  EXPECT_EQ(written.size(), 0u);
}

TEST_P(ExportFormatTest, AGeoPackageThatIsOpenElsewhereIsNotReplaced) {
  const std::string source = metres_source(folder_, {{.wkt = kSquare}});
  folder_.write("out" + GetParam(), "precious");
  folder_.write("out" + GetParam() + "-wal", "what SQLite would apply to the new file");
  ExportOptions options;
  options.overwrite = true;
  if (GetParam() == ".gpkg") {
    EXPECT_THAT(error_of(source, output(), options),
                AllOf(HasSubstr("cannot be written"), HasSubstr(output() + "-wal")));
    EXPECT_EQ(read_file(output()), "precious");
  } else {
    EXPECT_NO_THROW(export_layer(source, output(), options));
  }
}

TEST_P(ExportFormatTest, AnExistingFileIsReplacedOnlyIfAskedFor) {
  const std::string source = metres_source(folder_, {{.wkt = kSquare}});
  folder_.write("out" + GetParam(), "precious");
  EXPECT_THAT(error_of(source, output()), AllOf(HasSubstr(output()), HasSubstr("--overwrite")));
  EXPECT_EQ(read_file(output()), "precious");
  ExportOptions options;
  options.overwrite = true;
  export_layer(source, output(), options);
  EXPECT_EQ(Written(output()).size(), 1u);
  EXPECT_THAT(files_in(folder_.file("")), UnorderedElementsAre("source.gpkg", "out" + GetParam()));
}

/// During its lifetime no file may grow beyond `bytes`, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_P(ExportFormatTest, ADiskThatFillsUpIsAnErrorAndLeavesTheOldFile) {
  std::mt19937 random(1);
  std::vector<TestFeature> features;
  for (int i = 0; i < 300; ++i) {
    const auto ring = random_star(random, {i * 40'000, 0}, 300, 5'000, 9'000);
    features.push_back({.wkt = "POLYGON(" + wkt_of(ring) + ")", .number = i});
  }
  const std::string source = metres_source(folder_, features);
  folder_.write("out" + GetParam(), "precious");
  ExportOptions options;
  options.overwrite = true;
  {
    const FileSizeLimit limit(400'000);
    EXPECT_THAT(error_of(source, output(), options),
                AllOf(HasSubstr(output()), HasSubstr("cannot be written")));
  }
  EXPECT_EQ(read_file(output()), "precious");
  EXPECT_THAT(files_in(folder_.file("")), UnorderedElementsAre("source.gpkg", "out" + GetParam()));
}

TEST(ExportLayerTest, OutputsThatCannotBeAreRefusedByName) {
  const TemporaryFolder folder;
  const std::string source = metres_source(folder, {{.wkt = kSquare}});
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {folder.file("out.shp"), "must end in .fgb"},
      {folder.file("out"), "must end in .fgb"},
      {folder.file("none/out.fgb"), "there is no folder"},
      {folder.file("folder.gpkg"), "other than a regular file"},
      {source, "the source itself"}};
  std::filesystem::create_directory(folder.file("folder.gpkg"));
  ExportOptions options;
  options.overwrite = true;
  for (const auto& [output, says] : wrong) {
    EXPECT_THAT(error_of(source, output, options), AllOf(HasSubstr(output), HasSubstr(says)));
  }
  EXPECT_EQ(Written(source).size(), 1u);
}

TEST(ExportLayerTest, ASourceThatCannotBeReadLeavesNothingBehind) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of(folder.file("none.fgb"), folder.file("out.fgb")), HasSubstr("none.fgb"));
  const std::string metres_without_crs = folder.file("local.fgb");
  write_source(metres_without_crs, "FlatGeobuf",
               {{.crs = "", .features = {{.wkt = "POLYGON((0 0,1000 0,0 1000,0 0))"}}}});
  EXPECT_THAT(error_of(metres_without_crs, folder.file("out.fgb")),
              AllOf(HasSubstr("local.fgb"), HasSubstr("no coordinate reference system")));
  EXPECT_THAT(files_in(folder.file("")), ElementsAre("local.fgb"));
}

TEST(ExportLayerTest, EveryFeatureIsCountedOnce) {
  const TemporaryFolder folder;
  const std::string source = folder.file("mixed.gpkg");
  write_source(source, "GPKG",
               {{.features = {{.wkt = "POLYGON((0 0,1 0,1 1,0 0))"},
                              {.wkt = "POINT(1 1)"},
                              {.wkt = ""},
                              {.wkt = "POLYGON((0 89,1 89,1 89.5,0 89))"},
                              {.wkt = "POLYGON((0 0,1e400 0,1 1,0 0))"}}}});
  const ExportReport report = export_layer(source, folder.file("out.fgb"));
  EXPECT_EQ(report.features, 5u);
  EXPECT_EQ(report.written, 1u);
  EXPECT_EQ(report.other_geometry, 2u);
  EXPECT_EQ(report.empty, 1u);
  EXPECT_EQ(report.skipped, 1u);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].id, 5);
  EXPECT_THAT(report.notes[0].reason, HasSubstr("not a finite number"));
}

TEST(ExportLayerTest, NamesThatClashGetNumbersAndTheSourcesOwnStay) {
  const TemporaryFolder folder;
  const std::string source = folder.write(
      "source.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","id":5,"properties":)"
      R"({"trapeze_id":"mine","fid":"f","geom":"g","name":"a","NAME":"b"},"geometry":)"
      R"({"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}}]})");
  const std::string output = folder.file("out.gpkg");
  export_layer(source, output);
  const Written written(output);
  EXPECT_THAT(written.field_names(),
              UnorderedElementsAre("trapeze_id", "trapeze_id_2", "fid", "geom", "name", "NAME_2"));
  EXPECT_THAT(written.texts("trapeze_id"), ElementsAre("mine"));
  EXPECT_THAT(written.texts("trapeze_id_2"), ElementsAre("5"));
  EXPECT_THAT(written.texts("fid"), ElementsAre("f"));
  EXPECT_THAT(written.texts("geom"), ElementsAre("g"));
  EXPECT_THAT(written.texts("NAME_2"), ElementsAre("b"));
}

TEST(ExportLayerTest, SeveralLayersAreToldApartAndTheirFieldsJoined) {
  const TemporaryFolder folder;
  const std::string source = folder.file("layers.gpkg");
  write_source(source, "GPKG",
               {{.name = "north",
                 .type = wkbPolygon,
                 .features = {{.wkt = "POLYGON((0 1,1 1,1 2,0 1))", .number = 1, .text = "n"}}},
                {.name = "south",
                 .type = wkbPolygon,
                 .features = {{.wkt = "POLYGON((0 0,1 0,1 1,0 0))", .number = 2, .text = "s"}}}});
  export_layer(source, folder.file("out.geojson"));
  const Written written(folder.file("out.geojson"));
  EXPECT_THAT(written.texts("trapeze_layer"), ElementsAre("north", "south"));
  EXPECT_THAT(written.texts("trapeze_id"), ElementsAre("1", "1"));
  EXPECT_THAT(written.texts("text"), ElementsAre("n", "s"));
  EXPECT_THAT(written.texts("number"), ElementsAre("1", "2"));
}

TEST(ExportLayerTest, TheOutputDoesNotDependOnTheThreads) {
  const TemporaryFolder folder;
  std::mt19937 random(7);
  std::vector<TestFeature> features;
  for (int i = 0; i < 400; ++i) {
    const auto ring = random_star(random, {i * 900, i}, 5 + i % 60, 50, 500);
    features.push_back({.wkt = "POLYGON(" + wkt_of(ring) + ")", .number = i});
  }
  const std::string source = metres_source(folder, features);
  std::vector<std::string> outputs;
  for (const unsigned threads : {1u, 4u}) {
    ExportOptions options;
    options.epsilon = 100;
    options.threads = threads;
    options.overwrite = true;
    export_layer(source, folder.file("out.geojson"), options);
    outputs.push_back(read_file(folder.file("out.geojson")));
  }
  EXPECT_EQ(outputs[0], outputs[1]);
}

// The hole lies inside the long edge as it runs on the Web Mercator map, and outside the same edge
// drawn straight in degrees.
TEST(ExportLayerTest, LongEdgesGetVerticesInDegreesWhereThePolygonWouldNotBeValid) {
  const TemporaryFolder folder;
  const std::string source = metres_source(
      folder, {{.wkt = "POLYGON((0 0,10000000 0,10000000 10000000,0 0),"
                       "(5010000 5000000,5100000 5000000,5100000 5050000,5010000 5000000))"},
               {.wkt = "POLYGON((0 0,10000000 0,10000000 10000000,0 0))"}});
  const std::string output = folder.file("out.gpkg");
  const ExportReport degrees = export_layer(source, output);
  EXPECT_EQ(degrees.subdivided, 1u);
  EXPECT_EQ(degrees.invalid, 0u);
  const Written written(output);
  EXPECT_TRUE(written.are_all_valid());
  EXPECT_GT(written[0]
                .GetGeometryRef()
                ->toMultiPolygon()
                ->getGeometryRef(0)
                ->getExteriorRing()
                ->getNumPoints(),
            4);
  ExportOptions options;
  options.crs = ExportCrs::web_mercator;
  options.overwrite = true;
  const ExportReport metres = export_layer(source, output, options);
  EXPECT_EQ(metres.subdivided, 0u);
  EXPECT_TRUE(Written(output).are_all_valid());
}

// The island lies beside the long edge as it runs on the Web Mercator map, and within the polygon
// if that edge is drawn straight in degrees.
TEST(ExportLayerTest, LongEdgesGetVerticesInDegreesWhereAnIslandWouldLieWithinThePolygon) {
  const TemporaryFolder folder;
  const std::string island = "((3000730 2998700,3001300 2998700,3001300 2999300,3000730 2998700))";
  const std::string source = metres_source(
      folder, {{.wkt = "MULTIPOLYGON(((0 0,6000000 6000000,0 6000000,0 0))," + island + ")"},
               {.wkt = "POLYGON" + island}});
  const std::string output = folder.file("out.gpkg");
  for (const CoverageMode coverage : {CoverageMode::off, CoverageMode::on}) {
    ExportOptions options;
    options.generalization.coverage = coverage;
    options.overwrite = true;
    const ExportReport report = export_layer(source, output, options);
    EXPECT_GT(report.subdivided, 0u);
    EXPECT_EQ(report.invalid, 0u);
    EXPECT_TRUE(Written(output).are_all_valid());
  }
}

// A and B share a long edge, near which A has a vertex. C has a vertex that almost touches its own
// long edge, so no number of additional vertices makes it valid in degrees.
TEST(ExportLayerTest, AFeatureThatIsNotValidInDegreesLeavesTheBordersOfOthersIdentical) {
  const TemporaryFolder folder;
  const std::string source = metres_source(folder, {{.wkt = "POLYGON(("
                                                            "0.0 6446275.837354153,"
                                                            "0.0 5621521.477824285,"
                                                            "2207728.429933299 5621521.477824285,"
                                                            "2226389.813791984 8747495.747667242,"
                                                            "2245051.19765067 5621521.477824285,"
                                                            "4452779.627583968 5621521.477824285,"
                                                            "4452779.627583968 11068715.641564585,"
                                                            "0.0 6446275.837354153"
                                                            "))"},
                                                    {.wkt = "POLYGON(("
                                                            "0.0 6446275.837354153,"
                                                            "4452779.627583968 11068715.641564585,"
                                                            "4452779.627583968 11753184.596831644,"
                                                            "1451126.1720493205 11753184.596831644,"
                                                            "1413803.4043319493 11753184.596831644,"
                                                            "0.0 11753184.596831644,"
                                                            "0.0 6446275.837354153"
                                                            "))"},
                                                    {.wkt = "POLYGON(("
                                                            "0.0 11753184.596831644,"
                                                            "1413803.4043319493 11753184.596831644,"
                                                            "1432464.788190635 13488101.44990033,"
                                                            "1451126.1720493205 11753184.596831644,"
                                                            "4452779.627583968 11753184.596831644,"
                                                            "4452779.646245353 15538711.086229393,"
                                                            "0.0 12515545.197932897,"
                                                            "0.0 11753184.596831644"
                                                            "))"}});
  ExportOptions options;
  options.epsilon = 0;
  const ExportReport report = export_layer(source, folder.file("out.gpkg"), options);
  EXPECT_EQ(report.invalid, 1u);
  const Written written(folder.file("out.gpkg"));
  EXPECT_NE(written[0].GetGeometryRef()->Overlaps(written[1].GetGeometryRef()), TRUE);
}

// The bump of 30 metres at the side of the square is less than the tolerance, and the hole reaches
// into it.
TEST(ExportLayerTest, TheTopologyTestHoldsAVertexWithoutWhichTheHoleWouldCrossTheShell) {
  const TemporaryFolder folder;
  const std::string source =
      metres_source(folder, {{.wkt = "POLYGON((0 0,100 0,130 50,100 100,0 100,0 0),"
                                     "(10 10,115 50,10 90,10 10))"}});
  const std::string output = folder.file("out.fgb");
  ExportOptions options;
  options.epsilon = 40 / 0.0186;
  const ExportReport strict = export_layer(source, output, options);
  EXPECT_EQ(strict.held, 1u);
  EXPECT_EQ(strict.crossed, 0u);
  EXPECT_TRUE(Written(output).are_all_valid());
  options.generalization.topology = Topology::fast;
  options.overwrite = true;
  const ExportReport fast = export_layer(source, output, options);
  EXPECT_EQ(fast.held, 0u);
  EXPECT_EQ(fast.crossed, 1u);
  EXPECT_TRUE(Written(output).are_all_valid());
}

}  // namespace
}  // namespace trapeze
