#include "render/software/software_renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "render/mask/resolve_row.h"
#include "render/mask/stopwatch.h"

namespace trapeze {

// Converts cells to pixels of the picture.
struct SoftwareRenderer::Frame {
  std::int64_t origin_x;
  std::int64_t origin_y;
  double columns_per_cell;
  double rows_per_cell;
  double columns_per_row;  // of a square area on the ground
  double first_row;
  double width;
  double height;

  explicit Frame(const View& view)
      : origin_x(view.origin_x),
        origin_y(view.origin_y),
        columns_per_cell(1.0 / view.cells_per_pixel),
        rows_per_cell(1.0 / view.cells_per_row()),
        columns_per_row(columns_per_cell / rows_per_cell),
        first_row(view.first_row),
        width(view.width),
        height(view.height) {}

  // The subtraction is exact, so the error is that of one multiplication: 2^-22 pixel at worst.
  double x(std::int32_t cells) const {
    return static_cast<double>(cells - origin_x) * columns_per_cell;
  }
  double y(std::int32_t cells) const {
    return static_cast<double>(cells - origin_y) * rows_per_cell - first_row;
  }
};

// A straight piece of an edge, in pixels; y_top < y_bottom.
struct SoftwareRenderer::Piece {
  double x_top;
  double y_top;
  double x_bottom;
  double y_bottom;
};

// The part of a piece in one row.
struct SoftwareRenderer::RowPiece {
  double x_from;
  double x_to;
  std::int32_t height;  // in units
};

// How the shares of a side are rounded to units.
struct SoftwareRenderer::Rounding {
  std::int32_t sign;  // positive for the left side of a trapezoid, negative for the right side
  double threshold;   // from 0 to 1
};

namespace {

// For 0 <= value; cheaper than std::floor.
int truncate(double value) {
  return static_cast<int>(value);
}

/// A pseudo-random number derived from the bits of another one.
std::uint64_t mixed(std::uint64_t bits) {
  const std::uint64_t product = (bits ^ bits >> 32) * 0x9e3779b97f4a7c15;
  return (product ^ product >> 29) * 0x94d049bb133111eb;
}

/// From 0 to 1.
double threshold_of(std::uint64_t mixed_bits) {
  return static_cast<double>(static_cast<std::int64_t>(mixed_bits >> 40)) * 0x1p-24;
}

/// For a position between the north of a row, 0, and its south, 1.
std::int32_t units_of(double place) {
  return truncate(place * kUnitsPerPixel +
                  threshold_of(mixed(std::bit_cast<std::uint64_t>(place))));
}

/// The threshold for the shares of a trapezoid, derived from the positions of its top and its
/// bottom within their rows.
double threshold_between(double y_top, double y_bottom) {
  const auto bits = [](double y) { return std::bit_cast<std::uint64_t>(y - truncate(y)); };
  return threshold_of(mixed(bits(y_top) + 3 * bits(y_bottom)));
}

}  // namespace

DrawTimes SoftwareRenderer::draw(std::span<const MaskTask> tasks) {
  DrawTimes times;
  for (const MaskTask& task : tasks) draw(task, times);
  return times;
}

void SoftwareRenderer::draw(const MaskTask& task, DrawTimes& times) {
  const View& view = task.view;
  view.check();
  prepare(view);
  task.out->begin(view.width, view.height);
  const Frame frame(view);
  bool is_wanted = true;
  try {
    {
      const Stopwatch stopwatch(times.draw_ms);
      for (const MeshPart& part : task.parts) {
        is_wanted = is_wanted && add(part, frame, task.cancellation);
      }
    }
    const Stopwatch stopwatch(times.resolve_ms);
    resolve(*task.out);
  } catch (...) {
    release_memory();  // so that no areas remain for the next picture
    throw;
  }
  if (!is_wanted) throw Cancelled();
}

std::string SoftwareRenderer::description() const {
  return "software renderer (exact area, one thread)";
}

void SoftwareRenderer::release_memory() {
  width_ = height_ = 0;
  added_ = 0;
  // {} would assign an empty list, which keeps the memory of a vector.
  differences_ = std::vector<std::int32_t>();
  touched_ = {};
  sums_ = std::vector<std::int64_t>();
}

void SoftwareRenderer::prepare(const View& view) {
  if (view.width == width_ && view.height == height_) return;
  width_ = height_ = 0;  // if memory runs out below, the next call starts over
  stride_ = static_cast<std::size_t>(view.width) + 2;
  differences_.assign(stride_ * static_cast<std::size_t>(view.height), 0);
  sums_ = {};
  touched_.assign(stride_, static_cast<std::size_t>(view.height));
  width_ = view.width;
  height_ = view.height;
}

bool SoftwareRenderer::add(const MeshPart& part, const Frame& frame,
                           const Cancellation* cancellation) {
  constexpr std::uint32_t kTrapezoids = 4096;  // between two checks for cancellation
  std::uint32_t since_look = 0;
  for (TrapezoidRange range : part.ranges) {
    while (range.count > 0) {
      if (added_ == kMostTrapezoids) set_aside();
      const std::uint32_t count = std::min(range.count, kMostTrapezoids - added_);
      for (const MeshTrapezoid& trapezoid : part.mesh.trapezoids.subspan(range.first, count)) {
        add_trapezoid(part.mesh, trapezoid, frame);
      }
      added_ += count;
      range.first += count;
      range.count -= count;
      since_look += count;
    }
    if (since_look < kTrapezoids) continue;
    since_look = 0;
    if (cancellation != nullptr && cancellation->is_over()) return false;
  }
  return true;
}

void SoftwareRenderer::add_trapezoid(const MeshView& mesh, const MeshTrapezoid& trapezoid,
                                     const Frame& frame) {
  const std::int32_t top = mesh.vertices[trapezoid.top].y;
  const std::int32_t bottom = mesh.vertices[trapezoid.bottom].y;
  if (top == bottom) return;
  const double y_top = std::max(frame.y(top), 0.0);
  const double y_bottom = std::min(frame.y(bottom), frame.height);
  if (y_top >= y_bottom) return;

  const MeshEdge& left = mesh.edges[trapezoid.left];
  const MeshEdge& right = mesh.edges[trapezoid.right];
  const Point left_upper = mesh.vertices[left.upper];
  const Point left_lower = mesh.vertices[left.lower];
  const Point right_upper = mesh.vertices[right.upper];
  const Point right_lower = mesh.vertices[right.lower];
  // Either side may be the western one: if they are swapped, the area is negative.
  if (frame.x(std::max({left_upper.x, left_lower.x, right_upper.x, right_lower.x})) <= 0) return;
  if (frame.x(std::min({left_upper.x, left_lower.x, right_upper.x, right_lower.x})) >= frame.width)
    return;

  const double threshold = threshold_between(y_top, y_bottom);
  add_side(left_upper, left_lower, y_top, y_bottom, {1, threshold}, frame);
  add_side(right_upper, right_lower, y_top, y_bottom, {-1, threshold}, frame);
}

// Adds the part of the edge between two heights. The edge is not horizontal there: the trapezoid
// that it bounds has a height, and the edge spans it.
void SoftwareRenderer::add_side(Point upper, Point lower, double y_top, double y_bottom,
                                Rounding rounding, const Frame& frame) {
  const auto dx = static_cast<double>(std::int64_t{lower.x} - upper.x);
  const auto dy = static_cast<double>(std::int64_t{lower.y} - upper.y);
  const double slope = dx / dy * frame.columns_per_row;
  const double x = frame.x(upper.x);
  const double y = frame.y(upper.y);
  const Piece piece{x + (y_top - y) * slope, y_top, x + (y_bottom - y) * slope, y_bottom};
  const auto [low, high] = std::minmax(piece.x_top, piece.x_bottom);
  if (low >= 0 && high <= frame.width) {
    add_piece(piece, rounding);
  } else {
    add_clipped(piece, rounding);
  }
}

// An edge off the picture counts as if it ran along the border that it is beyond: either the whole
// row is to its right, or nothing.
void SoftwareRenderer::add_clipped(const Piece& piece, Rounding rounding) {
  const double width = width_;
  const Piece clamped{std::clamp(piece.x_top, 0.0, width), piece.y_top,
                      std::clamp(piece.x_bottom, 0.0, width), piece.y_bottom};
  Piece inside = clamped;
  if (clamped.x_top != clamped.x_bottom) {
    const double rows_per_column = (piece.y_bottom - piece.y_top) / (piece.x_bottom - piece.x_top);
    const auto y_where_x_is = [&](double x) {
      return std::clamp(piece.y_top + (x - piece.x_top) * rows_per_column, piece.y_top,
                        piece.y_bottom);
    };
    if (clamped.x_top != piece.x_top) inside.y_top = y_where_x_is(clamped.x_top);
    if (clamped.x_bottom != piece.x_bottom) inside.y_bottom = y_where_x_is(clamped.x_bottom);
    add_piece({clamped.x_top, piece.y_top, clamped.x_top, inside.y_top}, rounding);
    add_piece({clamped.x_bottom, inside.y_bottom, clamped.x_bottom, piece.y_bottom}, rounding);
  }
  add_piece(inside, rounding);
}

// Adds a piece within one row; its height is spread evenly. In the column that contains it, the
// area to the right of the piece is covered. In all columns further east the full height is
// covered, which the running sum carries on.
inline void SoftwareRenderer::add_row(int row, const RowPiece& piece, Rounding rounding) {
  const double low = std::min(piece.x_from, piece.x_to);
  const double high = std::max(piece.x_from, piece.x_to);
  const int first = truncate(low);
  const int last = truncate(high);
  // The column after the last one is written, too.
  touched_.touch(static_cast<std::size_t>(row), static_cast<std::size_t>(first),
                 static_cast<std::size_t>(last) + 1);
  std::int32_t* cells = differences_.data() + static_cast<std::size_t>(row) * stride_;

  std::int32_t sum = 0;  // of the columns so far
  const auto add_to = [&](int column, double share) {
    const auto next = static_cast<std::int32_t>(share * piece.height + rounding.threshold);
    cells[column] += rounding.sign * (next - sum);
    sum = next;
  };
  if (first == last) {
    add_to(first, 1.0 - (0.5 * (low + high) - first));
  } else {
    // The part of the height west of a column covers the whole column, the rest half of it.
    const double share_of_column = 1.0 / (high - low);
    double x = low;
    double west = 0;
    for (int column = first; column < last; ++column) {
      const double next_x = column + 1.0;
      const double part = std::min((next_x - x) * share_of_column, 1.0 - west);
      add_to(column, west + part * (1.0 - (0.5 * (x + next_x) - column)));
      west += part;
      x = next_x;
    }
    add_to(last, west + (1.0 - west) * (1.0 - (0.5 * (x + high) - last)));
  }
  cells[last + 1] += rounding.sign * (piece.height - sum);
}

// Adds a piece inside the picture, row by row; a piece without height adds nothing.
void SoftwareRenderer::add_piece(const Piece& piece, Rounding rounding) {
  if (!(piece.y_top < piece.y_bottom)) return;
  const int first = truncate(piece.y_top);
  std::int32_t from = units_of(piece.y_top - first);
  if (piece.y_bottom <= first + 1) {
    const std::int32_t height = units_of(piece.y_bottom - first) - from;
    if (height > 0) add_row(first, {piece.x_top, piece.x_bottom, height}, rounding);
    return;
  }
  const double slope = (piece.x_bottom - piece.x_top) / (piece.y_bottom - piece.y_top);
  // Rounding must not move a position out of the picture.
  const auto [low, high] = std::minmax(piece.x_top, piece.x_bottom);
  double x = piece.x_top;
  for (int row = first; row < piece.y_bottom; ++row) {
    const double next_y = std::min(row + 1.0, piece.y_bottom);
    const double next_x = std::clamp(piece.x_top + (next_y - piece.y_top) * slope, low, high);
    const std::int32_t height = units_of(next_y - row) - from;
    if (height > 0) add_row(row, {x, next_x, height}, rounding);
    from = 0;
    x = next_x;
  }
}

// Adds the differences so far to sums that have room for more, and resets them.
void SoftwareRenderer::set_aside() {
  sums_.resize(differences_.size());
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += std::exchange(differences_[i], 0);
  added_ = 0;
}

// Sums the rows and clears the differences for the next picture.
void SoftwareRenderer::resolve(Mask& out) {
  const bool has_sums = !sums_.empty();
  if (has_sums) set_aside();
  added_ = 0;
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t row = 0; row < static_cast<std::size_t>(height_); ++row) {
    const std::uint64_t touched = touched_.take(row);
    const std::size_t begin = row * stride_;
    if (has_sums) {
      resolve_row(std::span(sums_).subspan(begin, width), out);
      continue;
    }
    std::int32_t* cells = differences_.data() + begin;
    resolve_row({cells, width}, touched, touched_.shift(), out);
    // Nothing is visible on the east border and beyond.
    cells[width] = cells[width + 1] = 0;
  }
  sums_ = {};
}

}  // namespace trapeze
