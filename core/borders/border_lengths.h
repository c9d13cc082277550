// The lengths of the borders of a region with each of its neighbours.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

/// The length of an edge, in cells.
inline double length_of(const TrapezoidalGraph& graph, const Edge& edge) {
  const Point a = graph.point(edge.end[kUp]);
  const Point b = graph.point(edge.end[kDown]);
  return std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
}

/// Lengths of borders, by the face beyond.
class BorderLengths {
 public:
  void add(FaceId beyond, double length) {
    const auto known = std::find_if(lengths_.begin(), lengths_.end(),
                                    [beyond](const auto& item) { return item.first == beyond; });
    if (known == lengths_.end()) {
      lengths_.emplace_back(beyond, length);
    } else {
      known->second += length;
    }
  }

  std::size_t faces() const { return lengths_.size(); }

  /// The face with the longest border; of several, the one with the smallest number. kOutside if
  /// there is none.
  FaceId longest() const {
    const auto found = find_longest();
    return found == lengths_.end() ? kOutside : found->first;
  }
  /// The length of that border; 0 if there is none.
  double greatest_length() const {
    const auto found = find_longest();
    return found == lengths_.end() ? 0 : found->second;
  }

 private:
  std::vector<std::pair<FaceId, double>>::const_iterator find_longest() const {
    return std::min_element(lengths_.begin(), lengths_.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second > b.second : a.first < b.first;
    });
  }

  std::vector<std::pair<FaceId, double>> lengths_;
};

}  // namespace trapeze
