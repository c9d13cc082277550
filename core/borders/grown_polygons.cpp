#include "core/borders/grown_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/borders/border_arcs.h"
#include "core/borders/border_lengths.h"
#include "core/borders/coverage_builder.h"
#include "core/borders/dividing_edges.h"
#include "core/borders/part_union.h"
#include "core/borders/regions.h"
#include "core/borders/set_map.h"
#include "core/grid/box_margin.h"
#include "core/grid/for_each_in_parallel.h"
#include "core/grid/item_count.h"
#include "core/grid/web_mercator.h"
#include "core/mesh/exaggeration.h"

namespace trapeze {
namespace {

// Size of the blocks processed as a whole: at least so many pixels, and so many times the distance
// around a place that must be known.
constexpr double kLeastBlock = 512;
constexpr double kReachesOfBlock = 4;

// Remainders beside triangles that end on cells have a smaller mean width than this, in cells.
constexpr double kLeftOver = 2;

using Triangle = Exaggeration::Triangle;

/// Finds the triangles by which features grow, block by block of the plane.
class Growth {
 public:
  Growth(std::span<DrawnPolygons* const> features, const GrowthSize& size, unsigned threads)
      : size_(size), threads_(threads) {
    const double reach = Exaggeration::reach_of(size.width);
    const double side = std::max(kLeastBlock, kReachesOfBlock * reach) * size.pixel;
    side_ = static_cast<std::int64_t>(std::ceil(std::min<double>(side, kGridSize)));
    reach_ = reach * size.pixel;
    std::size_t points = 0;
    for (const DrawnPolygons* feature : features) points += feature->polygons.rings.points.size();
    require_countable(points, "vertices of polygons that may grow");
    vertices_.reserve(points);
    edges_.reserve(points);
    sides_.reserve(points);
    for (std::uint32_t f = 0; f < features.size(); ++f) add(features[f]->polygons.rings, f);
  }

  /// The order of the result does not depend on the number of threads.
  std::vector<Triangle> find() {
    sort_into_blocks();
    std::vector<std::vector<Triangle>> found(blocks_.size());
    for_each_in_parallel(blocks_.size(), threads_, [&](std::size_t i) { found[i] = find_in(i); });
    std::vector<Triangle> all;
    for (const auto& in_block : found) all.insert(all.end(), in_block.begin(), in_block.end());
    return all;
  }

 private:
  struct SideOf {
    std::uint32_t feature = 0;
    bool is_right = false;  // whether the feature is on the right of the edge
  };
  /// By row and column.
  using Block = std::uint64_t;

  // Shells run counterclockwise and holes clockwise: the inside is on the right of an edge that is
  // followed downwards.
  void add(const Rings& rings, std::uint32_t feature) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
      const auto ring = rings[r];
      const auto first = static_cast<std::uint32_t>(vertices_.size());
      for (std::uint32_t i = 0; i < ring.size(); ++i) {
        const std::uint32_t next = i + 1 < ring.size() ? i + 1 : 0;
        const bool goes_down = is_above(ring[i], ring[next]);
        vertices_.push_back(ring[i]);
        edges_.push_back(goes_down ? MeshEdge{first + i, first + next}
                                   : MeshEdge{first + next, first + i});
        sides_.push_back({feature, goes_down});
      }
    }
  }

  std::int64_t number_at(double cell) const {
    const double at = std::clamp<double>(cell, kGridMin, kGridMax - 1) - kGridMin;
    return static_cast<std::int64_t>(at / static_cast<double>(side_));
  }
  Block block_at(Point p) const {
    return static_cast<Block>(number_at(p.y)) << 32 | static_cast<Block>(number_at(p.x));
  }

  /// Assigns each edge to the blocks that have something within reach of it.
  void sort_into_blocks() {
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const Point upper = vertices_[edges_[e].upper];
      const Point lower = vertices_[edges_[e].lower];
      const std::int64_t last = number_at(lower.y + reach_);
      for (std::int64_t row = number_at(upper.y - reach_); row <= last; ++row) {
        // The part of the edge within reach of the row.
        const double top = kGridMin + static_cast<double>(row * side_) - reach_;
        const double bottom = top + static_cast<double>(side_) + 2 * reach_;
        double from = upper.x;
        double to = lower.x;
        if (upper.y != lower.y) {
          const EdgeLine line(upper, lower);
          from = line.x_at(std::clamp<double>(top, upper.y, lower.y));
          to = line.x_at(std::clamp<double>(bottom, upper.y, lower.y));
        }
        const std::int64_t east = number_at(std::max(from, to) + reach_ + 1);
        for (std::int64_t x = number_at(std::min(from, to) - reach_ - 1); x <= east; ++x) {
          in_blocks_.emplace_back(static_cast<Block>(row) << 32 | static_cast<Block>(x), e);
        }
      }
    }
    std::ranges::sort(in_blocks_);
    for (std::size_t i = 0; i < in_blocks_.size(); ++i) {
      if (i == 0 || in_blocks_[i - 1].first != in_blocks_[i].first) blocks_.push_back(i);
    }
  }

  /// The triangles whose uppermost corners lie in the block: each is found in exactly one block.
  std::vector<Triangle> find_in(std::size_t number) const {
    const Block block = in_blocks_[blocks_[number]].first;
    Exaggeration exaggeration;
    BoundaryMap& boundary = exaggeration.boundary();
    boundary.begin();
    boundary.begin_piece({0, vertices_, edges_, {}});
    for (std::size_t i = blocks_[number]; i < in_blocks_.size() && in_blocks_[i].first == block;
         ++i) {
      add_edge(in_blocks_[i].second, boundary);
    }
    const auto begin_of = [this](Block index) {
      return kGridMin + static_cast<std::int64_t>(index) * side_;
    };
    const auto end_of = [&](Block index) {
      return std::min<std::int64_t>(begin_of(index + 1), kGridMax);
    };
    const Block row = block >> 32;
    const Block column = block & 0xffffffff;
    const Box box{
        static_cast<std::int32_t>(begin_of(column)), static_cast<std::int32_t>(begin_of(row)),
        static_cast<std::int32_t>(end_of(column)), static_cast<std::int32_t>(end_of(row))};
    exaggeration.find({size_.width, size_.pixel}, box, nullptr);
    std::vector<Triangle> found;
    for (const Triangle& triangle : exaggeration.triangles()) {
      if (block_at(triangle.corners[0]) == block) found.push_back(triangle);
    }
    return found;
  }

  void add_edge(std::uint32_t edge, BoundaryMap& boundary) const {
    const Point upper = vertices_[edges_[edge].upper];
    const Point lower = vertices_[edges_[edge].lower];
    if (upper.y == lower.y) {
      boundary.add_edge(edge);
    } else {
      boundary.add_side(edge, sides_[edge].feature, sides_[edge].is_right);
    }
    if (is_on_frame(upper, lower)) boundary.add_cut(edge);
  }

  const GrowthSize size_;
  const unsigned threads_;
  std::int64_t side_ = 1;  // of a block, in cells
  double reach_ = 0;       // cells
  // Of all rings, edge by edge.
  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<SideOf> sides_;
  std::vector<std::pair<Block, std::uint32_t>> in_blocks_;  // edges, in order of blocks
  std::vector<std::size_t> blocks_;                         // where each begins
};

/// The growth of a feature.
struct Grown {
  std::size_t feature = 0;
  bool is_beside_others = false;
  Rings rings;  // inside by even-odd
};

/// By feature; growth beside others after all other growth.
std::vector<Grown> unite_triangles(const std::vector<Triangle>& triangles, unsigned threads,
                                   std::string& failure) {
  std::map<std::pair<bool, std::size_t>, std::vector<const Triangle*>> sorted;
  for (const Triangle& triangle : triangles) {
    sorted[{triangle.is_beside_others, BoundaryMap::number_of(triangle.face)}].push_back(&triangle);
  }
  std::vector<Grown> grown;
  std::vector<std::span<const Triangle* const>> parts;
  for (const auto& [key, own] : sorted) {
    Grown& one = grown.emplace_back();
    one.feature = key.second;
    one.is_beside_others = key.first;
    parts.emplace_back(own);
  }
  std::vector<std::string> failures(grown.size());
  for_each_in_parallel(grown.size(), threads, [&](std::size_t i) {
    Rings& rings = grown[i].rings;
    std::vector<std::uint32_t> ends;
    for (const Triangle* triangle : parts[i]) {
      rings.add(triangle->corners);
      ends.push_back(static_cast<std::uint32_t>(rings.size()));
    }
    failures[i] = unite_parts(rings, ends).failure;
  });
  for (const std::string& words : failures) {
    if (!words.empty()) failure = words;
  }
  return grown;
}

/// Features with their growth, as one coverage.
class GrownCoverage {
 public:
  GrownCoverage(std::span<DrawnPolygons* const> features, std::span<const Grown> grown,
                unsigned threads)
      : features_(features), grown_(grown), threads_(threads) {}

  /// The rings of each feature by even-odd; none on failure.
  std::optional<std::vector<Rings>> build(std::string& failure) {
    std::vector<const Rings*> all;
    for (const DrawnPolygons* feature : features_) all.push_back(&feature->polygons.rings);
    for (const Grown& growth : grown_) all.push_back(&growth.rings);
    SetMap map(all, threads_);
    if (!map.sweep(boundary_, trapezoidation_, graph_, HotCells::crossings_and_vertices)) {
      failure = map.failure();
      return std::nullopt;
    }
    name_faces(map);
    if (!keep_dividing()) return std::nullopt;
    dissolve_what_is_left_over();
    if (!keep_dividing()) return std::nullopt;
    BorderArcs arcs;
    arcs.trace(boundary_, static_cast<FaceId>(faces_.face_count()), Regions(graph_), graph_);
    return rings_of_features(graph_, faces_);
  }

 private:
  /// The face of a place covered by a set of features and growths: the growth there beside others;
  /// otherwise the features, of which there may be several if each was simplified by itself;
  /// otherwise the growth there into the void. Of two growths, which overlap because they end on
  /// cells, the first.
  FaceId face_of(const std::vector<std::uint32_t>& set) {
    if (set.empty()) return kOutside;
    const auto features = static_cast<std::uint32_t>(features_.size());
    const auto growth = std::ranges::lower_bound(set, features);
    const auto beside = std::find_if(growth, set.end(), [&](std::uint32_t item) {
      return grown_[item - features].is_beside_others;
    });
    const auto face_of_growth = [&](std::uint32_t item) {
      return static_cast<FaceId>(grown_[item - features].feature + 1);
    };
    if (beside != set.end()) return face_of_growth(*beside);
    if (growth == set.begin()) return face_of_growth(*growth);
    if (growth == set.begin() + 1) return static_cast<FaceId>(set.front() + 1);
    const auto [known, is_new] = of_several_.try_emplace({set.begin(), growth}, kOutside);
    if (is_new) known->second = faces_.add(known->first);
    return known->second;
  }

  void name_faces(const SetMap& map) {
    faces_ = FaceFeatures::in_order(features_.size());
    std::vector<FaceId> face_of_set;
    for (std::size_t i = 0; i < map.sets().size(); ++i) {
      face_of_set.push_back(face_of(map.sets()[static_cast<std::uint32_t>(i)]));
    }
    for (std::size_t e = 0; e < boundary_.edges.size(); ++e) {
      const Edge& edge = graph_.edge(EdgeId(e));
      sides_.emplace_back(face_of_set[edge.face[kLeft]], face_of_set[edge.face[kRight]]);
      const auto& owners = map.sets()[map.borders().owners[e]];
      is_new_.push_back(!owners.empty() && owners.back() >= features_.size());
    }
  }

  bool keep_dividing() {
    std::size_t kept = 0;
    for (std::size_t e = 0; e < sides_.size(); ++e) {
      if (sides_[e].first != sides_[e].second) is_new_[kept++] = is_new_[e];
    }
    is_new_.resize(kept);
    return keep_what_divides(sides_, boundary_, trapezoidation_, graph_, threads_);
  }

  void dissolve_what_is_left_over() {
    struct Around {
      double border = 0;  // its length, in cells
      bool is_beside_growth = false;
      BorderLengths neighbours = {};
    };
    const Regions regions(graph_);
    std::vector<Around> around(regions.face.size());
    for (std::size_t e = 0; e < sides_.size(); ++e) {
      const double length = length_of(graph_, graph_.edge(EdgeId(e)));
      for (const Side s : {kLeft, kRight}) {
        const RegionId region = regions.beside[EdgeId(e)][s];
        if (region == regions.unbounded) continue;  // it has any number of neighbours
        Around& one = around[region.value];
        one.border += length;
        one.is_beside_growth = one.is_beside_growth || is_new_[e];
        one.neighbours.add(s == kLeft ? sides_[e].second : sides_[e].first, length);
      }
    }
    const auto is_left_over = [&](RegionId region) {
      const Around& one = around[region.value];
      return region != regions.unbounded && one.is_beside_growth &&
             regions.area[region] <= kLeftOver * one.border / 2;
    };
    for (std::size_t e = 0; e < sides_.size(); ++e) {
      for (const Side s : {kLeft, kRight}) {
        const RegionId region = regions.beside[EdgeId(e)][s];
        if (!is_left_over(region)) continue;
        (s == kLeft ? sides_[e].first : sides_[e].second) =
            around[region.value].neighbours.longest();
      }
    }
  }

  const std::span<DrawnPolygons* const> features_;
  const std::span<const Grown> grown_;
  const unsigned threads_;
  Boundary boundary_;
  Trapezoidation trapezoidation_;
  TrapezoidalGraph graph_;
  FaceFeatures faces_;
  std::map<std::vector<std::uint32_t>, FaceId> of_several_;
  Sides sides_;               // by edge
  std::vector<bool> is_new_;  // by edge: whether it is an edge of a growth
};

}  // namespace

GrownPolygons grow(std::span<DrawnPolygons* const> features, const GrowthSize& size,
                   unsigned threads) {
  GrownPolygons result;
  std::vector<DrawnPolygons*> beside;  // features beside each other, without overlaps
  for (DrawnPolygons* feature : features) {
    if (!feature->lies_over_others) beside.push_back(feature);
  }
  const std::vector<Triangle> triangles = Growth(beside, size, threads).find();
  if (triangles.empty()) return result;
  const std::vector<Grown> grown = unite_triangles(triangles, threads, result.failure);
  if (!result.failure.empty()) return result;
  std::optional<std::vector<Rings>> rings =
      GrownCoverage(beside, grown, threads).build(result.failure);
  if (!rings) return result;
  std::vector<bool> grows(beside.size(), false);
  for (const Grown& growth : grown) grows[growth.feature] = true;
  result.grown = static_cast<std::size_t>(std::ranges::count(grows, true));
  const std::uint32_t graph = beside.front()->graph;
  for_each_in_parallel(beside.size(), threads, [&](std::size_t i) {
    beside[i]->polygons = polygons_of((*rings)[i]);
    beside[i]->graph = graph;
  });
  return result;
}

}  // namespace trapeze
