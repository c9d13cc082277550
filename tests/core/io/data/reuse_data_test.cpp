// Real layers that are edited: a file that takes over from the previous layer equals one that is
// prepared from scratch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/io/load/load_layer.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/io/source/source_stamp.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using Features = std::vector<OGRFeatureUniquePtr>;

/// An in-memory layer that can be changed and written.
class EditedLayer {
 public:
  explicit EditedLayer(const std::string& path) {
    GDALAllRegister();
    source_.reset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
    if (source_ == nullptr) return;
    for (const auto& feature : source_->GetLayer(0)) features_.emplace_back(feature->Clone());
  }

  bool is_there() const { return source_ != nullptr; }

  void write(const std::string& path) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("FlatGeobuf");
    const GDALDatasetUniquePtr out(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRLayer& from = *source_->GetLayer(0);
    CPLStringList options;
    options.SetNameValue("SPATIAL_INDEX", "NO");  // it would put them in another order
    OGRLayer* layer = out->CreateLayer("edited", from.GetSpatialRef(), wkbUnknown, options.List());
    OGRFeatureDefn& definition = *from.GetLayerDefn();
    for (int i = 0; i < definition.GetFieldCount(); ++i) {
      layer->CreateField(definition.GetFieldDefn(i));
    }
    for (const auto& feature : features_) {
      const OGRFeatureUniquePtr copy(OGRFeature::CreateFeature(layer->GetLayerDefn()));
      copy->SetFrom(feature.get());
      ASSERT_EQ(layer->CreateFeature(copy.get()), OGRERR_NONE);
    }
  }

  /// Changes one feature, or the order of features.
  void edit(std::mt19937& random) {
    const auto below = [&random](std::size_t end) {
      return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
    };
    const std::size_t at = below(features_.size());
    const auto place = features_.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(6)) {
      case 0:
        features_.erase(place);
        break;
      case 1:  // over the existing one
        features_.emplace(features_.begin() + static_cast<std::ptrdiff_t>(below(features_.size())),
                          features_[at]->Clone());
        break;
      case 2:
        std::swap(features_[at], features_[below(features_.size())]);
        break;
      case 3:
        for (int i = 0; i < features_[at]->GetFieldCount(); ++i) features_[at]->UnsetField(i);
        break;
      default:
        move_vertex(*features_[at], random);
    }
  }
  void shuffle(std::mt19937& random) { std::ranges::shuffle(features_, random); }
  std::size_t size() const { return features_.size(); }

 private:
  static void move_vertex(OGRFeature& feature, std::mt19937& random) {
    OGRGeometry* geometry = feature.GetGeometryRef();
    if (geometry == nullptr || geometry->IsEmpty()) return;
    OGRPolygon* polygon = wkbFlatten(geometry->getGeometryType()) == wkbMultiPolygon
                              ? geometry->toMultiPolygon()->getGeometryRef(0)
                              : geometry->toPolygon();
    OGRLinearRing& ring = *polygon->getExteriorRing();
    std::uniform_real_distribution<double> by(-1e-4, 1e-4);
    const int i = std::uniform_int_distribution<int>(1, ring.getNumPoints() - 2)(random);
    ring.setPoint(i, ring.getX(i) + by(random), ring.getY(i) + by(random));
  }

  GDALDatasetUniquePtr source_;
  Features features_;
};

using Case = std::tuple<std::string, CoverageMode>;

class ReuseDataTest : public ::testing::TestWithParam<Case> {
 protected:
  /// Prepares the source written last; returns the prepared file.
  std::string prepare(const std::string& name, const EarlierPrepared& earlier, unsigned threads) {
    LoadOptions options;
    options.generalization.coverage = std::get<CoverageMode>(GetParam());
    options.threads = threads;
    options.earlier = earlier.layer;
    loaded_ = load_layer(source_, options);
    save_prepared_layer(folder_.file(name), loaded_, 1, stamp_source(source_), {}, earlier);
    return folder_.file(name);
  }

  const TemporaryFolder folder_;
  const std::string source_ = folder_.file("source.fgb");
  LoadedLayer loaded_;
};

TEST_P(ReuseDataTest, IsTheFileThatIsPreparedAnew) {
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) GTEST_SKIP() << "TRAPEZE_DATA is not set";
  EditedLayer edited(std::string(folder) + "/" + std::get<std::string>(GetParam()) + ".fgb");
  if (!edited.is_there()) GTEST_SKIP() << "that file is not in TRAPEZE_DATA";
  std::mt19937 random(static_cast<unsigned>(edited.size()));
  edited.write(source_);
  prepare("before.trapeze", {}, 0);
  EXPECT_EQ(loaded_.report.taken_over, 0u);
  EarlierPrepared before;
  before.layer = std::move(loaded_.layer);
  for (int step = 0; step < 4; ++step) {
    SCOPED_TRACE("step " + std::to_string(step));
    for (int changes = 0; changes < 1 + 4 * step; ++changes) edited.edit(random);
    if (step == 3) edited.shuffle(random);
    std::filesystem::remove(source_);
    edited.write(source_);
    const std::string anew = read_file(prepare("anew.trapeze", {}, 0));
    const std::string reused = read_file(prepare("reused.trapeze", before, 1 + step % 2));
    EXPECT_TRUE(anew == reused);
    if (std::get<CoverageMode>(GetParam()) == CoverageMode::off) {
      EXPECT_GE(loaded_.report.taken_over + 20, loaded_.report.loaded);
    }
    // Alternates between an in-memory layer and a memory-mapped one.
    if (step % 2 == 0) {
      before = open_earlier_layer(folder_.file("reused.trapeze"),
                                  {{}, std::get<CoverageMode>(GetParam()), 0});
    } else {
      before = {};
      before.layer = std::move(loaded_.layer);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Layers, ReuseDataTest,
    ::testing::Combine(
        ::testing::Values("malta_buildings", "malta_landuse", "melbourne_natural", "us_counties"),
        ::testing::Values(CoverageMode::off, CoverageMode::automatic, CoverageMode::on)),
    [](const auto& of) {
      return std::get<std::string>(of.param) + "_" +
             std::string(kCoverageNames.name_of(std::get<CoverageMode>(of.param)));
    });

}  // namespace
}  // namespace trapeze
