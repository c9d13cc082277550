#include "tests/pictures/true_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace trapeze::testing {
namespace {

constexpr int kSamples = kSamplesPerSide * kSamplesPerSide;

/// The sample points of a picture: rows and columns at the middles of squares.
class SampleGrid {
 public:
  explicit SampleGrid(const View& view)
      : view_(view),
        cells_(view.cells_per_pixel / kSamplesPerSide),
        columns_(view.width * kSamplesPerSide),
        rows_(view.height * kSamplesPerSide) {}

  /// The first row that is not above `y`, at least 0 and at most the number of rows.
  int row_from(double y) const { return first_from(y - offset(view_.origin_y), rows_); }
  int column_from(double x) const { return first_from(x - offset(view_.origin_x), columns_); }
  double y_of_row(int row) const { return offset(view_.origin_y) + (row + 0.5) * cells_; }

 private:
  static double offset(std::int64_t origin) { return static_cast<double>(origin); }
  int first_from(double cells, int count) const {
    return static_cast<int>(
        std::clamp(std::ceil(cells / cells_ - 0.5), 0.0, static_cast<double>(count)));
  }

  const View& view_;
  double cells_;  // between two sample points
  int columns_;
  int rows_;
};

/// Where an outline crosses a row of sample points: the first column at or right of it. Ordered by
/// row, then by column.
using Crossing = std::uint32_t;

Crossing crossing(int row, int column) {
  return static_cast<Crossing>(row) << 16 | static_cast<Crossing>(column);
}
int row_of(Crossing c) {
  return static_cast<int>(c >> 16);
}
int column_of(Crossing c) {
  return static_cast<int>(c & 0xffff);
}

void append_crossings(Point a, Point b, const SampleGrid& grid, std::vector<Crossing>& crossings) {
  if (a.y > b.y) std::swap(a, b);
  const int begin = grid.row_from(a.y);
  const int end = grid.row_from(b.y);
  const double slope = (static_cast<double>(b.x) - a.x) / (static_cast<double>(b.y) - a.y);
  for (int row = begin; row < end; ++row) {
    crossings.push_back(crossing(row, grid.column_from(a.x + (grid.y_of_row(row) - a.y) * slope)));
  }
}

/// Counts of inside sample points, by pixel. For pixels wholly within a span, only the steps at its
/// ends are stored.
class Counts {
 public:
  Counts(int width, int height)
      : width_(width),
        partial_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height)),
        steps_(partial_.size()) {}

  void add_span(int row, int begin, int end) {
    if (begin >= end) return;
    const int first = begin / kSamplesPerSide;
    const int last = end / kSamplesPerSide;
    const std::size_t line = index(row / kSamplesPerSide, 0);
    const auto at = [line](int column) { return line + static_cast<std::size_t>(column); };
    partial_[at(first)] -= begin % kSamplesPerSide;
    partial_[at(last)] += end % kSamplesPerSide;
    steps_[at(first)] += kSamplesPerSide;
    steps_[at(last)] -= kSamplesPerSide;
  }

  Mask resolve(int height) const {
    Mask mask;
    mask.begin(width_, height);
    for (int row = 0; row < height; ++row) {
      std::int32_t whole = 0;
      for (int column = 0; column < width_; ++column) {
        whole += steps_[index(row, column)];
        const std::int32_t inside = std::min(whole + partial_[index(row, column)], kSamples);
        mask.append(static_cast<std::size_t>(column) + 1,
                    static_cast<std::uint8_t>((inside * 255 + kSamples / 2) / kSamples));
      }
      mask.end_row();
    }
    return mask;
  }

 private:
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_ + 1) +
           static_cast<std::size_t>(column);
  }

  int width_;
  std::vector<std::int32_t> partial_;
  std::vector<std::int32_t> steps_;
};

}  // namespace

TrueOutlines::TrueOutlines(const Layer& layer) {
  Rings rings;
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    rings.clear();
    layer.append_outline(row, rings);
    add(rings);
  }
}

void TrueOutlines::add(const Rings& rings) {
  Box box;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    for (const Point p : rings[r]) {
      box.include(p);
      points_.push_back(p);
    }
    ring_ends_.push_back(points_.size());
  }
  features_.push_back({box, ring_ends_.size()});
}

Mask TrueOutlines::draw(const View& view) const {
  if (std::max(view.width, view.height) * kSamplesPerSide >
      std::numeric_limits<std::uint16_t>::max())
    throw std::invalid_argument("the view has more sample points in a row than can be counted");
  const SampleGrid grid(view);
  const Box box = view.box();
  Counts counts(view.width, view.height);
  std::vector<Crossing> crossings;
  std::size_t ring = 0;
  for (const Feature& feature : features_) {
    const std::size_t begin = ring;
    ring = feature.rings_end;
    if (feature.box.is_empty() || !feature.box.intersects(box)) continue;
    crossings.clear();
    for (std::size_t r = begin; r < feature.rings_end; ++r) {
      const std::size_t first = r == 0 ? 0 : ring_ends_[r - 1];
      const std::size_t last = ring_ends_[r] - 1;
      for (std::size_t i = first; i <= last; ++i) {
        append_crossings(points_[i], points_[i == last ? first : i + 1], grid, crossings);
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      counts.add_span(row_of(crossings[i]), column_of(crossings[i]), column_of(crossings[i + 1]));
    }
  }
  return counts.resolve(view.height);
}

}  // namespace trapeze::testing
