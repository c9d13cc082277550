#include "render/mask/stroke.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace trapeze {
namespace {

constexpr double kMiterLimit = 4;
constexpr std::uint16_t kMostMet = 3;  // more are no different
// Lines extend beyond their ends by so many pixels, so that smaller openings at joins need no join.
constexpr double kOverlap = 1.0 / 32;

std::uint8_t to_value(float share) {
  return static_cast<std::uint8_t>(share * 255 + 0.5f);
}

struct Columns {
  int begin;
  int end;
};

/// The columns whose centres lie between two places, within a picture.
Columns columns_between(double min, double max, int width) {
  const double first = std::clamp(min - 0.5, 0.0, static_cast<double>(width));
  const double last = std::clamp(max - 0.5, -1.0, static_cast<double>(width - 1));
  const int begin = static_cast<int>(first) + (first > static_cast<int>(first) ? 1 : 0);
  const int end = last < 0 ? 0 : static_cast<int>(last) + 1;
  return {begin, std::max(begin, end)};
}

/// Of what is between `from` and `to` for factor * x + offset; solved for x.
struct Slab {
  double inverse = 0;  // of the factor; 0 if that is none
  double from = 0;
  double to = 0;

  Slab(double factor, double slab_from, double slab_to)
      : inverse(std::abs(factor) < 1e-12 ? 0 : 1 / factor), from(slab_from), to(slab_to) {}

  void narrow(double offset, double& min, double& max) const {
    if (inverse == 0) {
      if (offset < from || offset > to) max = min - 1;
      return;
    }
    const double a = (from - offset) * inverse;
    const double b = (to - offset) * inverse;
    min = std::max(min, std::min(a, b));
    max = std::min(max, std::max(a, b));
  }
};

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

std::uint64_t Stroke::most_values(std::uint64_t edges, const View& view, int scale) const {
  const double pixels = static_cast<double>(view.width) * view.height;
  const double across = 2 * reach(scale);
  // A line as long as it is wide, and a join of that size, at either end.
  const double around_edge = std::min(3 * across * across, 3 * pixels);
  return static_cast<std::uint64_t>(static_cast<double>(edges) * around_edge);
}

Stroker::Line Stroker::Line::turned() const {
  return {to, from, -dx, -dy, length, along + length};
}

// A line's width and dashes, in pixels of one picture.
class Stroker::Pen {
 public:
  Pen(const Stroke& stroke, int scale, Mask& mask)
      : half_(stroke.width * scale / 2), join_(stroke.join), mask_(mask) {
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
    const Columns rows = columns_between(top, bottom, mask_.height());
    const Slab beside(line.dx, -kOverlap, line.length + kOverlap);
    const Slab near(line.dy, -reach(), reach());
    for (int row = rows.begin; row < rows.end; ++row) {
      const double y = row + 0.5 - line.from.y;
      double min = -line.from.x;
      double max = mask_.width() - line.from.x;
      beside.narrow(y * line.dy, min, max);
      near.narrow(-y * line.dx, min, max);
      if (min <= max) draw_row(line, row, y, min + line.from.x, max + line.from.x);
    }
  }

  // Round what is nearest to the end of lines that nothing or too much is joined to.
  void draw_dot(Place centre, double along) {
    const float dash = dash_share(along);
    for_each_pixel_around(centre, reach(), [&](double x, double y) {
      return dash * across(static_cast<float>(std::sqrt(x * x + y * y)));
    });
  }

  // Of `in`, which ends there, and `out`, which begins there.
  void draw_join(const Line& in, const Line& out) {
    const double cosine = std::clamp(in.dx * out.dx + in.dy * out.dy, -1.0, 1.0);
    const double opening = std::abs(in.dx * out.dy - in.dy * out.dx) * reach();
    if (cosine > 0 && opening < kOverlap) return;
    const double half_cosine = std::sqrt((1 + cosine) / 2);  // of half the turn
    const LineJoin join =
        join_ == LineJoin::miter && half_cosine * kMiterLimit < 1 ? LineJoin::bevel : join_;
    const double radius = join == LineJoin::miter ? half_ / half_cosine + 0.5 : reach();
    const float dash = dash_share(out.along);
    for_each_pixel_around(out.from, radius, [&](double x, double y) {
      const bool is_beside_a_line = x * in.dx + y * in.dy < 0 || x * out.dx + y * out.dy > 0;
      if (is_beside_a_line) return 0.0f;
      return dash * across(static_cast<float>(distance(join, in, out, half_cosine, x, y)));
    });
  }

 private:
  // The distance from a vertex of a place near it, as the join has it.
  double distance(LineJoin join, const Line& in, const Line& out, double half_cosine, double x,
                  double y) const {
    if (join == LineJoin::round) return std::sqrt(x * x + y * y);
    if (join == LineJoin::miter) {
      return std::max(std::abs(x * in.dy - y * in.dx), std::abs(x * out.dy - y * out.dx));
    }
    const double bisector_x = in.dx - out.dx;
    const double bisector_y = in.dy - out.dy;
    const double length = std::sqrt(bisector_x * bisector_x + bisector_y * bisector_y);
    if (length == 0) return std::sqrt(x * x + y * y);
    return (x * bisector_x + y * bisector_y) / length + half_ * (1 - half_cosine);
  }

  // The share of a pixel at that distance from the middle of the line that the line covers.
  float across(float distance) const {
    const float half = static_cast<float>(half_);
    const float covered = std::min(distance + 0.5f, half) - std::max(distance - 0.5f, -half);
    return std::min(std::max(covered, 0.0f), 1.0f);
  }

  float dash_share(double along) const {
    if (dashes_.empty()) return 1;
    const double place = along - period_ * std::floor(along / period_);
    double share = 0;
    for (const double shift : {-period_, 0.0, period_}) {
      double begin = shift;
      for (std::size_t i = 0; i < dashes_.size(); i += 2) {
        const double end = begin + dashes_[i];
        share += std::max(0.0, std::min(place + 0.5, end) - std::max(place - 0.5, begin));
        begin = end + dashes_[i + 1];
      }
    }
    return static_cast<float>(std::min(share, 1.0));
  }

  void draw_row(const Line& line, int row, double y, double west, double east) {
    const Columns columns = columns_between(west, east, mask_.width());
    std::uint8_t* out = mask_.row_begin(row);
    const double x = columns.begin + 0.5 - line.from.x;
    const auto offset = static_cast<float>(x * line.dy - y * line.dx);
    const auto step = static_cast<float>(line.dy);
    for (int column = columns.begin; column < columns.end; ++column) {
      const int i = column - columns.begin;
      float share = across(std::abs(offset + static_cast<float>(i) * step));
      if (!dashes_.empty()) {
        share *= dash_share(line.along + (x + i) * line.dx + y * line.dy);
      }
      out[column] = std::max(out[column], to_value(share));
    }
  }

  template <typename ShareAt>
  void for_each_pixel_around(Place centre, double radius, const ShareAt& share_at) {
    const Columns rows = columns_between(centre.y - radius, centre.y + radius, mask_.height());
    const Columns columns = columns_between(centre.x - radius, centre.x + radius, mask_.width());
    for (int row = rows.begin; row < rows.end; ++row) {
      std::uint8_t* out = mask_.row_begin(row);
      for (int column = columns.begin; column < columns.end; ++column) {
        const float share = share_at(column + 0.5 - centre.x, row + 0.5 - centre.y);
        out[column] = std::max(out[column], to_value(share));
      }
    }
  }

  const double half_;
  const LineJoin join_;
  std::vector<double> dashes_;  // empty: no gaps
  double period_ = 0;
  Mask& mask_;
};

void Stroker::draw(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                   const Stroke& stroke, const View& view, int scale, Mask& mask) {
  if (mask.width() != view.width || mask.height() != view.height) {
    throw std::invalid_argument("the mask of an outline is not as large as the picture");
  }
  measure(vertices, edges, view);
  Pen pen(stroke, scale, mask);
  for (const Line& line : lines_) pen.draw_line(line);
  meet_.assign(std::bit_ceil(3 * edges.size() + 1), Meeting());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    meet(edges[i].from, i, false, pen);
    meet(edges[i].to, i, true, pen);
  }
  for (const Meeting& meeting : meet_) {
    if (meeting.count != 1) continue;
    const Line line = leaving(meeting.line, meeting.is_end);
    pen.draw_dot(line.from, line.along);
  }
}

void Stroker::measure(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                      const View& view) {
  const double pixels_per_cell = 1 / view.cells_per_pixel;
  const auto place_of = [&](std::uint32_t vertex) {
    const Point p = vertices[vertex];
    return Place{static_cast<double>(p.x - view.origin_x) * pixels_per_cell,
                 static_cast<double>(p.y - view.origin_y) * pixels_per_cell};
  };
  lines_.clear();
  for (const OutlineEdge& edge : edges) {
    const Place from = place_of(edge.from);
    const Place to = place_of(edge.to);
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    lines_.push_back({from, to, dx / length, dy / length, length, edge.along * pixels_per_cell});
  }
}

// Two lines that meet are joined; where more than two meet, rings touch.
void Stroker::meet(std::uint32_t vertex, std::uint32_t line, bool is_end, Pen& pen) {
  std::size_t i = (vertex * 0x9e3779b1u) >> 7 & (meet_.size() - 1);
  while (meet_[i].count > 0 && meet_[i].vertex != vertex) i = (i + 1) & (meet_.size() - 1);
  Meeting& meeting = meet_[i];
  if (meeting.count < kMostMet) ++meeting.count;
  if (meeting.count == 1) {
    meeting = {vertex, 1, is_end, line};
    return;
  }
  const Line second = leaving(line, is_end);
  if (meeting.count == 2) {
    pen.draw_join(leaving(meeting.line, meeting.is_end).turned(), second);
  } else {
    pen.draw_dot(second.from, second.along);
  }
}

// The line in the direction that leads away from its end or from its beginning.
Stroker::Line Stroker::leaving(std::uint32_t line, bool is_end) const {
  return is_end ? lines_[line].turned() : lines_[line];
}

}  // namespace trapeze
