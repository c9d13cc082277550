// An export in EPSG:3857, converted back to the grid.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/grid/rings.h"
#include "core/grid/web_mercator.h"
#include "core/sweep/boundary.h"
#include "core/sweep/segment.h"

namespace trapeze::testing {

inline Segment downwards(Point a, Point b) {
  return is_above(a, b) ? Segment(a, b) : Segment(b, a);
}

struct BySweepOrder {
  bool operator()(const Segment& a, const Segment& b) const {
    const auto key = [](const Segment& s) {
      return std::pair(sweep_key(s.first), sweep_key(s.second));
    };
    return key(a) < key(b);
  }
};
using SegmentCounts = std::map<Segment, int, BySweepOrder>;

inline void append_ring(const OGRLinearRing& ring, Rings& rings) {
  for (int i = 0; i + 1 < ring.getNumPoints(); ++i) {
    const GridPosition cell = grid_from_metres(ring.getX(i), ring.getY(i));
    rings.points.push_back({static_cast<std::int32_t>(std::lround(cell.x)),
                            static_cast<std::int32_t>(std::lround(cell.y))});
  }
  rings.close_ring();
}

/// The rings of each feature by trapeze_id, shells counterclockwise on the map and holes clockwise.
/// An invalid polygon fails the test.
inline std::vector<Rings> exported_rings(const std::string& path) {
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  if (dataset == nullptr) throw std::runtime_error("cannot open " + path);
  std::vector<std::pair<GIntBig, Rings>> features;
  for (const auto& feature : *dataset->GetLayer(0)) {
    const OGRGeometry& geometry = *feature->GetGeometryRef();
    const GIntBig id = feature->GetFieldAsInteger64("trapeze_id");
    EXPECT_TRUE(geometry.IsValid()) << path << ", feature " << id;
    Rings rings;
    const auto append = [&rings](const OGRPolygon& polygon) {
      for (const OGRLinearRing* ring : polygon) append_ring(*ring, rings);
    };
    if (wkbFlatten(geometry.getGeometryType()) == wkbPolygon) {
      append(*geometry.toPolygon());
    } else {
      for (const OGRPolygon* polygon : *geometry.toMultiPolygon()) append(*polygon);
    }
    features.emplace_back(id, std::move(rings));
  }
  std::ranges::sort(features, {}, [](const auto& feature) { return feature.first; });
  std::vector<Rings> all;
  for (auto& [id, rings] : features) all.push_back(std::move(rings));
  return all;
}

/// For each segment, the number of features that it bounds.
inline SegmentCounts segments_of(const std::vector<Rings>& features) {
  SegmentCounts segments;
  for (const Rings& rings : features) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const auto ring = rings[r];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        ++segments[downwards(ring[i], ring[(i + 1) % ring.size()])];
      }
    }
  }
  return segments;
}

/// Twice the area, in cells squared.
inline Int128 doubled_area(const std::vector<Rings>& features) {
  Int128 sum = 0;
  for (const Rings& rings : features) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const auto ring = rings[r];
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point a = ring[i];
        const Point b = ring[(i + 1) % ring.size()];
        sum += Int128{b.x} * a.y - Int128{a.x} * b.y;  // y grows downwards
      }
    }
  }
  return sum;
}

}  // namespace trapeze::testing
