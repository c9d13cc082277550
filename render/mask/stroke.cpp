#include "render/mask/stroke.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace trapeze {
namespace {

constexpr double kMiterLimit = 4;
constexpr std::uint16_t kMostMet = 3;  // more are no different
// Lines extend beyond their ends by so many pixels, so that smaller openings at joins need no join.
constexpr double kOverlap = 1.0 / 32;
constexpr double kMergedParts = 32;  // of a pixel: the grid of ends that are merged
// Half of the width from which the nearest edge is found for all pixels.
constexpr double kLeastHalfOfNearest = 2;
// Patterns of dashes that repeat within fewer pixels cannot be told from a tint.
constexpr double kLeastPeriod = 1.0 / 8;
constexpr std::size_t kMostBandPixels = std::size_t{1} << 21;

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

/// Tells a place from others, but for one chance in 2^64 with each.
std::uint64_t number_of(const PicturePlace& place) {
  const auto x = std::bit_cast<std::uint64_t>(place.x);
  const auto y = std::bit_cast<std::uint64_t>(place.y);
  const std::uint64_t mixed = (x ^ (x >> 29)) * 0xbf58476d1ce4e5b9u + y;
  return (mixed ^ (mixed >> 32)) * 0x94d049bb133111ebu;
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

std::uint64_t Stroke::most_values(std::uint64_t edges, const View& view, int scale) const {
  const double pixels = static_cast<double>(view.width) * view.height;
  // A line as long as it is wide, and a join at either end.
  const auto around_edges = [edges](double half) {
    return static_cast<double>(edges) * 3 * (2 * half + 1) * (2 * half + 1);
  };
  const double half = width * scale / 2;
  const double nearest = 2 * static_cast<double>(Stroker::kCrowd) * pixels;
  const double most = std::max(nearest, around_edges(kLeastHalfOfNearest));
  return static_cast<std::uint64_t>(std::min(around_edges(half), most));
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
    for (std::size_t i = 0; i + 1 < stroke.dashes.size(); i += 2) {
      dashes_.push_back({period_, stroke.dashes[i] * scale});
      period_ += (stroke.dashes[i] + stroke.dashes[i + 1]) * scale;
      ink_ += stroke.dashes[i] * scale;
    }
  }

  double half() const { return half_; }
  double reach() const { return half_ + 0.5; }
  std::uint64_t values() const { return values_; }

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
  void draw_dot(PicturePlace centre, double along) {
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

  // The share of a pixel at that distance from the middle of the line that the line covers.
  float across(float distance) const {
    const auto half = static_cast<float>(half_);
    const float covered = std::min(distance + 0.5f, half) - std::max(distance - 0.5f, -half);
    return std::min(std::max(covered, 0.0f), 1.0f);
  }

  // The share of the pixel around that place along the line that dashes cover.
  float dash_share(double along) const {
    if (dashes_.empty()) return 1;
    if (period_ < kLeastPeriod) return static_cast<float>(ink_ / period_);
    return static_cast<float>(ink_up_to(along + 0.5) - ink_up_to(along - 0.5));
  }

 private:
  struct Dash {
    double begin;
    double length;
  };

  // The length of the dashes between the beginning of the outline and a place along it.
  double ink_up_to(double along) const {
    const double periods = std::floor(along / period_);
    const double rest = along - periods * period_;
    double ink = periods * ink_;
    for (const Dash& dash : dashes_) ink += std::clamp(rest - dash.begin, 0.0, dash.length);
    return ink;
  }

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

  void draw_row(const Line& line, int row, double y, double west, double east) {
    const Columns columns = columns_between(west, east, mask_.width());
    values_ += static_cast<std::uint64_t>(columns.end - columns.begin);
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
  void for_each_pixel_around(PicturePlace centre, double radius, const ShareAt& share_at) {
    const Columns rows = columns_between(centre.y - radius, centre.y + radius, mask_.height());
    const Columns columns = columns_between(centre.x - radius, centre.x + radius, mask_.width());
    values_ += static_cast<std::uint64_t>(rows.end - rows.begin) *
               static_cast<std::uint64_t>(columns.end - columns.begin);
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
  std::vector<Dash> dashes_;  // of one period; empty: no gaps
  double period_ = 0;
  double ink_ = 0;  // length of the dashes of a period
  Mask& mask_;
  std::uint64_t values_ = 0;  // computed so far
};

void Stroker::draw(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                   const Stroke& stroke, const View& view, int scale, Mask& mask,
                   const Cancellation* cancellation) {
  if (mask.width() != view.width || mask.height() != view.height) {
    throw std::invalid_argument("the mask of an outline is not as large as the picture");
  }
  measure(vertices, edges, view);
  Pen pen(stroke, scale, mask);
  const double most = static_cast<double>(kCrowd) * view.width * view.height;
  const bool is_crowded = values_of_lines(pen, view) > most;
  if (is_crowded) merge_lines();
  if (cancellation != nullptr) cancellation->check();
  if (is_crowded && pen.half() >= kLeastHalfOfNearest && values_of_lines(pen, view) > most) {
    draw_nearest(pen, mask, cancellation);
  } else {
    draw_each(pen, cancellation);
  }
}

void Stroker::measure(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                      const View& view) {
  const double pixels_per_cell = 1 / view.cells_per_pixel;
  const auto place_of = [&](std::uint32_t vertex) {
    const Point p = vertices[vertex];
    return PicturePlace{static_cast<double>(p.x - view.origin_x) * pixels_per_cell,
                        static_cast<double>(p.y - view.origin_y) * pixels_per_cell};
  };
  lines_.clear();
  ends_.clear();
  for (const OutlineEdge& edge : edges) {
    lines_.push_back(
        line_between(place_of(edge.from), place_of(edge.to), edge.along * pixels_per_cell));
    ends_.push_back({edge.from, edge.to});
  }
}

Stroker::Line Stroker::line_between(PicturePlace from, PicturePlace to, double along) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length = std::sqrt(dx * dx + dy * dy);
  return {from, to, dx / length, dy / length, length, along};
}

// About as many as draw_each() would compute.
double Stroker::values_of_lines(const Pen& pen, const View& view) const {
  const double across = 2 * pen.reach();
  const double longest = static_cast<double>(view.width) + view.height;
  double values = 0;
  for (const Line& line : lines_) {
    const auto [west, east] = std::minmax(line.from.x, line.to.x);
    const auto [north, south] = std::minmax(line.from.y, line.to.y);
    const bool is_seen = east > -pen.reach() && west < view.width + pen.reach() &&
                         south > -pen.reach() && north < view.height + pen.reach();
    // Along the line, and around its beginning.
    if (is_seen) values += across * (std::min(line.length, longest) + across);
  }
  return values;
}

// Moves the ends to a grid, which no eye can see; lines without length vanish, and of equal ones
// the first one stays.
void Stroker::merge_lines() {
  const auto moved = [](PicturePlace place) {
    // Sums with 0 have no negative zeros, whose bits are different.
    return PicturePlace{std::round(place.x * kMergedParts) / kMergedParts + 0.0,
                        std::round(place.y * kMergedParts) / kMergedParts + 0.0};
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;  // what tells lines apart, and line
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    lines_[i] = line_between(moved(line.from), moved(line.to), line.along);
    ends_[i] = {number_of(line.from), number_of(line.to)};
    if (ends_[i].from != ends_[i].to) order.emplace_back(ends_[i].from + ends_[i].to, i);
  }
  std::ranges::sort(order);
  const auto is_same = [](const auto& a, const auto& b) { return a.first == b.first; };
  order.erase(std::unique(order.begin(), order.end(), is_same), order.end());
  const auto by_line = [](const auto& item) { return item.second; };
  std::ranges::sort(order, {}, by_line);
  for (std::size_t i = 0; i < order.size(); ++i) {
    lines_[i] = lines_[order[i].second];
    ends_[i] = ends_[order[i].second];
  }
  lines_.resize(order.size());
  ends_.resize(order.size());
}

void Stroker::draw_each(Pen& pen, const Cancellation* cancellation) {
  CancellationCheck check(cancellation, 64);
  for (const Line& line : lines_) {
    check();
    pen.draw_line(line);
  }
  meet_.assign(std::bit_ceil(3 * lines_.size() + 1), Meeting());
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    check();
    meet(ends_[i].from, i, false, pen);
    meet(ends_[i].to, i, true, pen);
  }
  for (const Meeting& meeting : meet_) {
    if (meeting.count != 1) continue;
    check();
    const Line line = leaving(meeting.line, meeting.is_end);
    pen.draw_dot(line.from, line.along);
  }
  values_ = pen.values();
}

// Two lines that meet are joined; where more than two meet, rings touch.
void Stroker::meet(std::uint64_t place, std::uint32_t line, bool is_end, Pen& pen) {
  std::size_t i = (place * 0x9e3779b97f4a7c15u) >> 32 & (meet_.size() - 1);
  while (meet_[i].count > 0 && meet_[i].place != place) i = (i + 1) & (meet_.size() - 1);
  Meeting& meeting = meet_[i];
  if (meeting.count < kMostMet) ++meeting.count;
  if (meeting.count == 1) {
    meeting = {place, line, 1, is_end};
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

// In bands of rows, so that memory is bounded.
void Stroker::draw_nearest(const Pen& pen, Mask& mask, const Cancellation* cancellation) {
  values_ = 0;
  CancellationCheck check(cancellation, 1024);
  const int most_rows =
      std::max(1, static_cast<int>(kMostBandPixels / static_cast<std::size_t>(mask.width())));
  for (int first = 0; first < mask.height(); first += most_rows) {
    const int rows = std::min(most_rows, mask.height() - first);
    field_.begin(mask.width(), rows, pen.reach());
    for (const Line& line : lines_) {
      check();
      const auto share_at = [&](double part) {
        return pen.dash_share(line.along + part * line.length);
      };
      field_.add({line.from.x, line.from.y - first}, {line.to.x, line.to.y - first}, share_at);
    }
    field_.spread(cancellation);
    for (int row = 0; row < rows; ++row) {
      std::uint8_t* out = mask.row_begin(first + row);
      for (int column = 0; column < mask.width(); ++column) {
        const auto [distance, share] = field_.nearest(column, row);
        out[column] = std::max(out[column], to_value(share * pen.across(distance)));
      }
    }
    values_ += field_.steps();
  }
}

}  // namespace trapeze
