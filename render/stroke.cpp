#include "render/stroke.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace trapeze {
namespace {

constexpr double kMiterLimit = 4;

std::uint8_t to_level(double coverage) {
  return static_cast<std::uint8_t>(coverage * 255 + 0.5);
}

struct Columns {
  int begin;
  int end;
};

/// The columns whose centres lie between two places, within a picture.
Columns columns_between(double min, double max, int width) {
  const double begin = std::clamp(std::ceil(min - 0.5), 0.0, static_cast<double>(width));
  const double end = std::clamp(std::floor(max - 0.5) + 1, begin, static_cast<double>(width));
  return {static_cast<int>(begin), static_cast<int>(end)};
}

}  // namespace

bool Stroke::is_dashed() const {
  for (std::size_t i = 1; i < dashes.size(); i += 2) {
    if (dashes[i] > 0) return true;
  }
  return false;
}

double Stroke::reach(int scale) const {
  const double half = width * scale / 2;
  return (join == LineJoin::miter ? kMiterLimit * half : half) + 0.5;
}

Stroker::Line Stroker::Line::turned() const {
  return {to, from, -dx, -dy, length, along + length};
}

// A line's width and dashes, in pixels of one picture.
class Stroker::Pen {
 public:
  Pen(const Stroke& stroke, int scale, Coverage& levels)
      : half_(stroke.width * scale / 2), join_(stroke.join), levels_(levels) {
    if (!stroke.is_dashed()) return;
    for (const double length : stroke.dashes) {
      dashes_.push_back(length * scale);
      period_ += length * scale;
    }
  }

  double reach() const { return half_ + 0.5; }

  void draw_line(const Line& line) {
    const double top = std::min(line.from.y, line.to.y) - reach();
    const double bottom = std::max(line.from.y, line.to.y) + reach();
    const Columns rows = columns_between(top, bottom, levels_.height());
    for (int row = rows.begin; row < rows.end; ++row) draw_row(line, row);
  }

  // Round what is nearest to the end of lines that nothing or too much is joined to.
  void draw_dot(Place centre, double along) {
    const double dash = dash_coverage(along);
    for_each_pixel_around(centre, reach(),
                          [&](double x, double y) { return dash * across(std::hypot(x, y)); });
  }

  // Of `in`, which ends there, and `out`, which begins there.
  void draw_join(const Line& in, const Line& out) {
    const double cosine = std::clamp(in.dx * out.dx + in.dy * out.dy, -1.0, 1.0);
    const double half_cosine = std::sqrt((1 + cosine) / 2);  // of half the turn
    const LineJoin join =
        join_ == LineJoin::miter && half_cosine * kMiterLimit < 1 ? LineJoin::bevel : join_;
    const double radius = join == LineJoin::miter ? half_ / half_cosine + 0.5 : reach();
    const double dash = dash_coverage(out.along);
    for_each_pixel_around(out.from, radius, [&](double x, double y) {
      const bool is_beside_a_line = x * in.dx + y * in.dy < 0 || x * out.dx + y * out.dy > 0;
      if (is_beside_a_line) return 0.0;
      return dash * across(distance(join, in, out, half_cosine, x, y));
    });
  }

 private:
  // The distance from a vertex of a place near it, as the join has it.
  double distance(LineJoin join, const Line& in, const Line& out, double half_cosine, double x,
                  double y) const {
    if (join == LineJoin::round) return std::hypot(x, y);
    if (join == LineJoin::miter) {
      return std::max(std::abs(x * in.dy - y * in.dx), std::abs(x * out.dy - y * out.dx));
    }
    const double bisector_x = in.dx - out.dx;
    const double bisector_y = in.dy - out.dy;
    const double length = std::hypot(bisector_x, bisector_y);
    if (length == 0) return std::hypot(x, y);
    return (x * bisector_x + y * bisector_y) / length + half_ * (1 - half_cosine);
  }

  // Of the stretch of a pixel at that distance from the middle of the line.
  double across(double distance) const {
    return std::clamp(std::min(distance + 0.5, half_) - std::max(distance - 0.5, -half_), 0.0, 1.0);
  }

  double dash_coverage(double along) const {
    if (dashes_.empty()) return 1;
    const double place = along - period_ * std::floor(along / period_);
    double coverage = 0;
    for (const double shift : {-period_, 0.0, period_}) {
      double begin = shift;
      for (std::size_t i = 0; i < dashes_.size(); i += 2) {
        const double end = begin + dashes_[i];
        coverage += std::max(0.0, std::min(place + 0.5, end) - std::max(place - 0.5, begin));
        begin = end + dashes_[i + 1];
      }
    }
    return std::min(coverage, 1.0);
  }

  void draw_row(const Line& line, int row) {
    const double y = row + 0.5 - line.from.y;
    double min = -line.from.x;
    double max = levels_.width() - line.from.x;
    // Beside the line: 0 <= x * dx + y * dy <= length.
    narrow(line.dx, y * line.dy, 0, line.length, min, max);
    // Near it: |x * dy - y * dx| <= reach.
    narrow(line.dy, -y * line.dx, -reach(), reach(), min, max);
    if (min > max) return;
    const Columns columns = columns_between(line.from.x + min, line.from.x + max, levels_.width());
    std::uint8_t* out = levels_.row_begin(row);
    for (int column = columns.begin; column < columns.end; ++column) {
      const double x = column + 0.5 - line.from.x;
      double coverage = across(std::abs(x * line.dy - y * line.dx));
      if (!dashes_.empty()) coverage *= dash_coverage(line.along + x * line.dx + y * line.dy);
      out[column] = std::max(out[column], to_level(coverage));
    }
  }

  // To the x for which from <= factor * x + offset <= to.
  static void narrow(double factor, double offset, double from, double to, double& min,
                     double& max) {
    constexpr double kLevel = 1e-12;
    if (std::abs(factor) < kLevel) {
      if (offset < from || offset > to) max = min - 1;
      return;
    }
    const double a = (from - offset) / factor;
    const double b = (to - offset) / factor;
    min = std::max(min, std::min(a, b));
    max = std::min(max, std::max(a, b));
  }

  template <typename CoverageAt>
  void for_each_pixel_around(Place centre, double radius, const CoverageAt& coverage_at) {
    const Columns rows = columns_between(centre.y - radius, centre.y + radius, levels_.height());
    const Columns columns = columns_between(centre.x - radius, centre.x + radius, levels_.width());
    for (int row = rows.begin; row < rows.end; ++row) {
      std::uint8_t* out = levels_.row_begin(row);
      for (int column = columns.begin; column < columns.end; ++column) {
        const double coverage = coverage_at(column + 0.5 - centre.x, row + 0.5 - centre.y);
        out[column] = std::max(out[column], to_level(coverage));
      }
    }
  }

  const double half_;
  const LineJoin join_;
  std::vector<double> dashes_;  // empty: no gaps
  double period_ = 0;
  Coverage& levels_;
};

void Stroker::draw(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                   const Stroke& stroke, const View& view, int scale, Coverage& levels) {
  if (levels.width() != view.width || levels.height() != view.height) {
    throw std::invalid_argument("the levels of an outline are not as large as the picture");
  }
  measure(vertices, edges, view);
  Pen pen(stroke, scale, levels);
  for (const Line& line : lines_) pen.draw_line(line);
  for (std::size_t begin = 0; begin < ends_.size();) {
    std::size_t end = begin;
    while (end < ends_.size() && ends_[end].vertex == ends_[begin].vertex) ++end;
    draw_vertex(std::span(ends_).subspan(begin, end - begin), pen);
    begin = end;
  }
}

void Stroker::measure(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                      const View& view) {
  const auto place_of = [&](std::uint32_t vertex) {
    const Point p = vertices[vertex];
    return Place{static_cast<double>(p.x - view.origin_x) / view.cells_per_pixel,
                 static_cast<double>(p.y - view.origin_y) / view.cells_per_pixel};
  };
  lines_.clear();
  ends_.clear();
  for (const OutlineEdge& edge : edges) {
    const auto line = static_cast<std::uint32_t>(lines_.size());
    ends_.push_back({edge.from, line, true});
    ends_.push_back({edge.to, line, false});
    const Place from = place_of(edge.from);
    const Place to = place_of(edge.to);
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    lines_.push_back({from, to, (to.x - from.x) / length, (to.y - from.y) / length, length,
                      edge.along / view.cells_per_pixel});
  }
  std::sort(ends_.begin(), ends_.end());
}

void Stroker::draw_vertex(std::span<const End> ends, Pen& pen) const {
  const Line first = leaving(ends[0]);
  if (ends.size() == 2) {
    pen.draw_join(first.turned(), leaving(ends[1]));
  } else {
    pen.draw_dot(first.from, first.along);
  }
}

// The line as it goes away from its end.
Stroker::Line Stroker::leaving(const End& end) const {
  const Line& line = lines_[end.line];
  return end.is_first ? line : line.turned();
}

}  // namespace trapeze
