#include "core/borders/rounded_polygons.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/item_count.h"
#include "core/grid/web_mercator.h"
#include "core/mesh/corner_rounding.h"
#include "core/sweep/boundary.h"
#include "core/sweep/meetings.h"
#include "core/sweep/noding.h"

namespace trapeze {
namespace {

/// Whether a point lies within about a cell of a segment.
bool is_near(const Segment& segment, Point p) {
  const double x = static_cast<double>(segment.second.x) - segment.first.x;
  const double y = static_cast<double>(segment.second.y) - segment.first.y;
  const auto off = static_cast<double>(orientation(segment.first, segment.second, p));
  return std::abs(off) <= std::hypot(x, y);
}

class Rounding {
 public:
  using WayPoints = std::vector<PlateCarreeMesh::PointOnWay>;

  Rounding(std::span<DrawnPolygons* const> features, const RoundingSize& size, unsigned threads)
      : features_(features.begin(), features.end()), size_(size), threads_(threads) {
    std::ranges::stable_sort(features_, {}, &DrawnPolygons::graph);
    std::size_t points = 0;
    for (const DrawnPolygons* feature : features_) {
      const bool is_new = graphs_.empty() || graphs_.back().number != feature->graph;
      if (is_new) graphs_.push_back({feature->graph, first_point_.size()});
      graphs_.back().end = first_point_.size() + 1;
      first_point_.push_back(points);
      points += feature->polygons.rings.points.size();
    }
    first_point_.push_back(points);
    require_countable(points, "vertices of polygons to round");
    vertices_.resize(points);
    edges_.resize(points);
    vertex_of_.resize(points);
    edge_of_.resize(points);
  }

  RoundedCorners run() {
    for_each_graph([this](const Graph& graph) {
      number_vertices(graph);
      number_edges(graph);
    });
    find_corners();
    const std::size_t found = corners_.corners().size();
    for (std::vector<std::uint32_t> graphs = all_graphs(); !graphs.empty();) {
      graphs = leave_sharp_what_crosses(graphs);
    }
    for_each_in_parallel(features_.size(), threads_, [this](std::size_t i) { replace(i); });
    const std::size_t left = corners_.corners().size();
    return {left, found - left};
  }

 private:
  /// Features [begin, end) are of one graph. Each of its vertices and edges has the number of one
  /// of the points of their rings.
  struct Graph {
    std::uint32_t number = 0;
    std::size_t begin = 0;
    std::size_t end = 0;
  };

  const Rings& rings_of(std::size_t feature) const { return features_[feature]->polygons.rings; }
  MeshView mesh() const { return {0, vertices_, edges_, {}}; }

  template <typename Visit>
  void for_each_graph(const Visit& visit) {
    for_each_in_parallel(graphs_.size(), threads_, [&](std::size_t i) { visit(graphs_[i]); });
  }

  /// Calls visit(point, next) with the numbers of points for every edge of the rings of a feature.
  template <typename Visit>
  void for_each_edge(std::size_t feature, const Visit& visit) const {
    const Rings& rings = rings_of(feature);
    std::size_t begin = 0;
    for (const std::size_t end : rings.ends) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t next = i + 1 < end ? i + 1 : begin;
        visit(first_point_[feature] + i, first_point_[feature] + next);
      }
      begin = end;
    }
  }

  /// For items of a key and a point: sorts them and gives points of equal keys the same number,
  /// from `first` on.
  template <typename Item>
  static void number_equals(std::vector<Item>& items, std::size_t first,
                            std::vector<std::uint32_t>& numbers) {
    std::ranges::sort(items);
    auto number = static_cast<std::uint32_t>(first);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (i > 0 && items[i].first != items[i - 1].first) ++number;
      numbers[items[i].second] = number;
    }
  }

  void number_vertices(const Graph& graph) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> points;
    const std::size_t first = first_point_[graph.begin];
    points.reserve(first_point_[graph.end] - first);
    for (std::size_t f = graph.begin; f < graph.end; ++f) {
      const std::vector<Point>& all = rings_of(f).points;
      for (std::size_t i = 0; i < all.size(); ++i) {
        points.emplace_back(sweep_key(all[i]), static_cast<std::uint32_t>(first_point_[f] + i));
      }
    }
    number_equals(points, first, vertex_of_);
    for (std::size_t f = graph.begin; f < graph.end; ++f) {
      const std::vector<Point>& all = rings_of(f).points;
      for (std::size_t i = 0; i < all.size(); ++i) {
        vertices_[vertex_of_[first_point_[f] + i]] = all[i];
      }
    }
  }

  void number_edges(const Graph& graph) {
    std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> sides;
    const std::size_t first = first_point_[graph.begin];
    sides.reserve(first_point_[graph.end] - first);
    for (std::size_t f = graph.begin; f < graph.end; ++f) {
      for_each_edge(f, [&](std::size_t point, std::size_t next) {
        sides.emplace_back(std::minmax(vertex_of_[point], vertex_of_[next]),
                           static_cast<std::uint32_t>(point));
      });
    }
    number_equals(sides, first, edge_of_);
    for (const auto& [ends, point] : sides) edges_[edge_of_[point]] = {ends.first, ends.second};
  }

  bool goes_down(std::size_t point) const {
    return edges_[edge_of_[point]].upper == vertex_of_[point];
  }

  // Shells run counterclockwise and holes clockwise: the inside is on the left along the path as
  // seen on the map, which is on the right of an edge that is followed downwards.
  void find_corners() {
    corners_.begin();
    corners_.begin_piece(mesh());
    for (std::size_t f = 0; f < features_.size(); ++f) {
      for_each_edge(f, [&](std::size_t point, std::size_t) {
        const std::uint32_t edge = edge_of_[point];
        const Point upper = vertices_[edges_[edge].upper];
        const Point lower = vertices_[edges_[edge].lower];
        const bool is_sharp = features_[f]->lies_over_others || is_on_frame(upper, lower);
        if (upper.y == lower.y) {
          corners_.add_edge(edge, is_sharp);
        } else {
          corners_.add_side(edge, static_cast<std::uint32_t>(f), goes_down(point), is_sharp);
        }
      });
    }
    corners_.find({size_.radius, size_.pixel});
  }

  std::vector<std::uint32_t> all_graphs() const {
    std::vector<std::uint32_t> all(graphs_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
  }

  /// For these graphs; returns those in which anything was found.
  std::vector<std::uint32_t> leave_sharp_what_crosses(std::span<const std::uint32_t> graphs) {
    std::vector<std::vector<std::uint32_t>> found(graphs.size());
    for_each_in_parallel(graphs.size(), threads_,
                         [&](std::size_t i) { found[i] = corners_that_cross(graphs_[graphs[i]]); });
    std::vector<std::uint32_t> all;
    std::vector<std::uint32_t> changed;
    for (std::size_t i = 0; i < graphs.size(); ++i) {
      if (!found[i].empty()) changed.push_back(graphs[i]);
      all.insert(all.end(), found[i].begin(), found[i].end());
    }
    std::ranges::sort(all);
    corners_.leave_sharp(0, all);
    return changed;
  }

  /// The edges of the graph, each once.
  std::vector<std::uint32_t> edges_of(const Graph& graph) const {
    std::vector<std::uint32_t> edges(
        edge_of_.begin() + static_cast<std::ptrdiff_t>(first_point_[graph.begin]),
        edge_of_.begin() + static_cast<std::ptrdiff_t>(first_point_[graph.end]));
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
  }

  bool is_rounded(std::uint32_t vertex) const { return corners_.corner_at(0, vertex) != nullptr; }

  /// Calls visit(segment) for the pieces of an edge, the upper end of each first.
  template <typename Visit>
  void for_each_piece(std::uint32_t edge, WayPoints& way, const Visit& visit) const {
    corners_.trace(0, mesh(), edge, way);
    for (std::size_t i = 1; i < way.size(); ++i) {
      const Point a = way[i - 1].place;
      const Point b = way[i].place;
      visit(is_above(a, b) ? Segment(a, b) : Segment(b, a));
    }
  }

  /// The rounded vertices of edges with a piece that meets another one other than at an end.
  std::vector<std::uint32_t> corners_that_cross(const Graph& graph) const {
    const std::vector<std::uint32_t> edges = edges_of(graph);
    const auto has_corner = [this](std::uint32_t edge) {
      return is_rounded(edges_[edge].upper) || is_rounded(edges_[edge].lower);
    };
    if (std::ranges::none_of(edges, has_corner)) return {};
    std::vector<Segment> pieces;
    WayPoints way;
    for (const std::uint32_t edge : edges) {
      for_each_piece(edge, way, [&](const Segment& piece) { pieces.push_back(piece); });
    }
    const auto order = [](const Segment& s) {
      return std::pair(sweep_key(s.first), sweep_key(s.second));
    };
    std::ranges::sort(pieces, {}, order);
    pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
    const auto meetings = find_meetings(pieces, most_meetings(pieces.size()));
    if (meetings && meetings->empty()) return {};
    std::vector<std::uint32_t> found;
    for (const bool do_ends_count : {false, true}) {
      for (const std::uint32_t edge : edges) {
        bool meets = !meetings;  // too many
        for_each_piece(edge, way, [&](const Segment& piece) {
          meets = meets || is_near_any(piece, *meetings, do_ends_count);
        });
        for (const std::uint32_t vertex : {edges_[edge].upper, edges_[edge].lower}) {
          if (meets && is_rounded(vertex)) found.push_back(vertex);
        }
      }
      // Otherwise the edge that passes through the point is not rounded, but the one that ends
      // there is.
      if (!found.empty()) break;
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Whether one of the points, which are in sweep order and rounded to cells, lies on the segment,
  /// not counting its ends unless do_ends_count.
  static bool is_near_any(const Segment& segment, const std::vector<Point>& points,
                          bool do_ends_count) {
    const Box box = box_of(segment);
    auto point = std::ranges::lower_bound(points, box.min_y - 1, {}, &Point::y);
    for (; point != points.end() && point->y <= box.max_y + 1; ++point) {
      const bool is_beside = point->x < box.min_x - 1 || point->x > box.max_x + 1;
      const bool is_end = *point == segment.first || *point == segment.second;
      if (is_beside || (is_end && !do_ends_count)) continue;
      if (is_near(segment, *point)) return true;
    }
    return false;
  }

  void replace(std::size_t feature) {
    bool is_any_rounded = false;
    for_each_edge(feature, [&](std::size_t point, std::size_t) {
      is_any_rounded = is_any_rounded || is_rounded(vertex_of_[point]);
    });
    if (!is_any_rounded) return;
    Rings rings;
    WayPoints way;
    for_each_edge(feature, [&](std::size_t point, std::size_t next) {
      corners_.trace(0, mesh(), edge_of_[point], way);
      if (!goes_down(point)) std::ranges::reverse(way);
      // The last point is the first one of the next edge.
      for (std::size_t i = 0; i + 1 < way.size(); ++i) rings.points.push_back(way[i].place);
      if (next <= point) rings.close_ring();
    });
    features_[feature]->polygons = polygons_of(rings);
  }

  std::vector<DrawnPolygons*> features_;  // by graph
  const RoundingSize size_;
  const unsigned threads_;
  std::vector<Graph> graphs_;
  std::vector<std::size_t> first_point_;  // by feature, and the end of the last
  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<std::uint32_t> vertex_of_;  // by point of the rings, one after another
  std::vector<std::uint32_t> edge_of_;    // of the edge that leads from it to the next point
  CornerRounding corners_;
};

}  // namespace

RoundedCorners round_corners(std::span<DrawnPolygons* const> features, const RoundingSize& size,
                             unsigned threads) {
  return Rounding(features, size, threads).run();
}

}  // namespace trapeze
