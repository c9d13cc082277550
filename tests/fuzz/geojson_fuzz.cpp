// Reads a GeoJSON text with the reader of all sources, builds the graph of each feature, applies
// any removals and reverts them. Each feature is counted once, with its outcome.
//
// Input: a byte of flags, then the text. Each text is read feature by feature; every second one is
// also loaded as a layer.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include "core/io/load/load_layer.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_ring_reader.h"
#include "tests/fuzz/check_operators.h"
#include "tests/fuzz/input_share.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::require;

const std::string kPath = "/vsimem/fuzz.geojson";
constexpr std::size_t kMaxPoints = 400;  // of a feature; checks are slower than the code

/// An in-memory file that refers to the input.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : text_(text) {
    VSIFCloseL(VSIFileFromMemBuffer(kPath.c_str(), reinterpret_cast<GByte*>(text_.data()),
                                    text_.size(), /*bTakeOwnership=*/FALSE));
  }
  ~MemoryFile() { VSIUnlink(kPath.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

 private:
  std::string text_;
};

/// A reference system may be given as a URL: nothing must be fetched here.
void stay_offline() {
  CPLSetConfigOption("GDAL_HTTP_PROXY", "127.0.0.1:9");
  CPLSetConfigOption("GDAL_HTTP_TIMEOUT", "1");
}

/// Leaves only the JSON drivers of GDAL. Most of the time would otherwise be spent on probing each
/// input with all the others.
void leave_only_json() {
  constexpr std::array<std::string_view, 4> kJson = {"GeoJSON", "GeoJSONSeq", "TopoJSON",
                                                     "ESRIJSON"};
  GDALDriverManager& drivers = *GetGDALDriverManager();
  for (int i = drivers.GetDriverCount() - 1; i >= 0; --i) {
    GDALDriver* driver = drivers.GetDriver(i);
    if (std::ranges::find(kJson, driver->GetDescription()) == kJson.end()) {
      drivers.DeregisterDriver(driver);
      GDALDestroyDriver(driver);
    }
  }
}

void check_rings(const Rings& rings) {
  for (const Point p : rings.points) {
    require(p.x >= kGridMin && p.x <= kGridMax && p.y >= kGridMin && p.y <= kGridMax,
            "a point lies outside of the world");
  }
}

void check_features(const fuzzing::Operations& operations) {
  FeatureSource source(kPath);
  SourceRingReader reader(source);
  SourceFeature next;
  while (source.next(next)) {
    const OGRGeometry* geometry =
        next.layer == nullptr ? nullptr : next.feature->GetGeomFieldRef(next.layer->geometry_field);
    if (geometry == nullptr || !has_polygons(*geometry)) continue;
    FeatureRings& feature = reader.read(*geometry, next.layer_index);
    if (!feature.failure.empty()) continue;
    check_rings(feature.rings);
    if (feature.rings.points.size() <= kMaxPoints) {
      fuzzing::check_operators(feature.rings, operations);
    }
  }
}

void check_loading() {
  LoadOptions options;
  options.threads = 1;
  const LoadedLayer loaded = load_layer(kPath, options);
  const LoadReport& report = loaded.report;
  require(report.features == report.loaded + report.other_geometry + report.empty + report.skipped,
          "a feature is not counted once");
  require(loaded.layer->features().size() + report.other_geometry <= report.features,
          "there are more rows than features");
}

/// Calls `read`, which may refuse the whole source with a message that names it.
template <typename Read>
void expect_words(Read read) {
  try {
    read();
  } catch (const SourceError& error) {
    require(error.what()[0] != '\0', "a source is refused without words");
  } catch (const std::runtime_error& error) {
    require(std::string_view(error.what()).find(kPath) != std::string_view::npos,
            "the refusal of a source does not name it");
  }
}

bool set_up() {
  stay_offline();
  const MemoryFile file(R"({"type": "FeatureCollection", "features": []})");
  expect_words([] { const FeatureSource registers_all_formats(kPath); });
  leave_only_json();
  return true;
}

void check(std::uint8_t flags, std::string_view text, std::uint32_t hash) {
  static const bool is_set_up [[maybe_unused]] = set_up();
  const MemoryFile file(text);
  fuzzing::Operations operations;
  operations.generalization.topology = (flags & 1) != 0 ? Topology::fast : Topology::strict;
  operations.generalization.weights = static_cast<WeightRule>((flags >> 1) % 4);
  operations.seed = flags;
  operations.greatest_tolerance = static_cast<double>(1 << 30);
  operations.checks = fuzzing::checks_of(hash / 2);
  expect_words([&operations] { check_features(operations); });
  if (hash % 2 == 0) expect_words([] { check_loading(); });
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  trapeze::check(data[0], trapeze::fuzzing::text_of(data + 1, size - 1),
                 trapeze::fuzzing::hash_of(data, size));
  return 0;
}
