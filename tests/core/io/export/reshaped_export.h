// Exports of generated shapes, with round corners or grown.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/io/export/export_layer.h"
#include "tests/core/io/export/exported_cells.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze::testing {

class ReshapedExportTest : public ::testing::Test {
 protected:
  ReshapedExportTest() {
    options_.overwrite = true;
    options_.crs = ExportCrs::web_mercator;
  }

  /// Polygons as WKT without the keyword, in metres of EPSG:3857; one is about 54 cells.
  void set_source(const std::vector<std::string>& polygons) {
    std::vector<TestFeature> features;
    for (const std::string& polygon : polygons) {
      features.push_back({.wkt = "POLYGON(" + polygon + ")"});
    }
    write_source(source_, "GPKG", {{.crs = "EPSG:3857", .features = features}});
  }

  std::vector<Rings> write() {
    report_ = export_layer(source_, output_, options_);
    return exported_rings(output_);
  }

  /// The bytes of an exported file, in a format that does not store the time.
  std::string write_text() {
    const std::string output = folder_.file("out.geojson");
    report_ = export_layer(source_, output, options_);
    std::ifstream file(output, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  TemporaryFolder folder_;
  const std::string source_ = folder_.file("source.gpkg");
  const std::string output_ = folder_.file("out.gpkg");
  ExportOptions options_;
  ExportReport report_;
};

}  // namespace trapeze::testing
