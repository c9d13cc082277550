#include "render/mask/mask_digest.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "core/grid/set_hash.h"

namespace trapeze {
namespace {

// Replaces the points of a side that is completely west of the view.
constexpr std::uint64_t kWest = 0x6a09e667f3bcc908;

/// A range of rows of cells, counted from the origin of the view.
struct Span {
  std::int64_t top = 0;
  std::int64_t bottom = 0;
};

// Cells are counted from the corner of the view, modulo 2^32, which is the size of the grid.
std::uint64_t word_of(Point p, const View& view) {
  const auto x = static_cast<std::uint32_t>(p.x - view.origin_x);
  const auto y = static_cast<std::uint32_t>(p.y - view.origin_y);
  return std::uint64_t{x} << 32 | y;
}

class SidesInView {
 public:
  explicit SidesInView(const View& view)
      : view_(view),
        width_(view.width * view.cells_per_pixel),
        rows_{static_cast<std::int64_t>(std::floor(view.first_row * view.cells_per_row())),
              static_cast<std::int64_t>(
                  std::ceil((view.first_row + view.height) * view.cells_per_row()))} {}

  /// The rows of the whole view.
  Span rows() const { return rows_; }

  /// The part of a trapezoid's rows that is in the view; nothing if `top` is not less than
  /// `bottom`.
  Span span_of(const MeshView& mesh, const MeshTrapezoid& trapezoid) const {
    const std::int64_t top = mesh.vertices[trapezoid.top].y - view_.origin_y;
    const std::int64_t bottom = mesh.vertices[trapezoid.bottom].y - view_.origin_y;
    return {std::max(top, rows_.top), std::min(bottom, rows_.bottom)};
  }

  /// The area east of a side is covered, or for a right side, uncovered.
  void add(const MeshView& mesh, std::uint32_t edge, Span span, bool is_right,
           SetHash& hash) const {
    const Point upper = mesh.vertices[mesh.edges[edge].upper];
    const Point lower = mesh.vertices[mesh.edges[edge].lower];
    switch (place_of(upper, lower, span)) {
      case Place::east:
        return;
      case Place::west:
        return add_west(span, is_right, hash);
      case Place::within:
        break;
    }
    const SetHash::Item item = {
        word_of(upper, view_), word_of(lower, view_),
        static_cast<std::uint64_t>(span.top) << 32 ^ static_cast<std::uint64_t>(span.bottom)};
    is_right ? hash.take_away(item) : hash.add(item);
  }

  /// A side that is cut in two counts the same as the whole side.
  static void add_west(Span span, bool is_right, SetHash& hash) {
    const SetHash::Item from = {kWest, kWest, static_cast<std::uint64_t>(span.top)};
    const SetHash::Item to = {kWest, kWest, static_cast<std::uint64_t>(span.bottom)};
    hash.add(is_right ? from : to);
    hash.take_away(is_right ? to : from);
  }

 private:
  enum class Place { west, within, east };

  Place place_of(Point upper, Point lower, Span span) const {
    const auto x_upper = static_cast<double>(upper.x - view_.origin_x);
    const auto x_lower = static_cast<double>(lower.x - view_.origin_x);
    const auto [least, most] = std::minmax(x_upper, x_lower);
    if (least > 0 && most < width_) return Place::within;
    if (most <= 0) return Place::west;
    if (least >= width_) return Place::east;
    const auto y_upper = static_cast<double>(upper.y - view_.origin_y);
    const double slope = (x_lower - x_upper) / static_cast<double>(std::int64_t{lower.y} - upper.y);
    const double x_top = x_upper + (static_cast<double>(span.top) - y_upper) * slope;
    const double x_bottom = x_upper + (static_cast<double>(span.bottom) - y_upper) * slope;
    if (x_top <= 0 && x_bottom <= 0) return Place::west;
    return x_top >= width_ && x_bottom >= width_ ? Place::east : Place::within;
  }

  const View& view_;
  double width_;  // cells
  Span rows_;
};

/// Ink and dashes of a line.
std::uint64_t word_of_line(const OutlineEdge& edge) {
  Digester digester;
  for (const double number : {edge.ink, edge.along, edge.rate}) {
    digester.add(std::bit_cast<std::uint64_t>(number));
  }
  return digester.digest().low;
}

/// If lines are joined at shared vertices, sharing counts as well: vertices are numbered as they
/// occur along the lines, in an order determined by places.
Digest digest_of_joined(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                        const View& view) {
  std::vector<const OutlineEdge*> order;
  for (const OutlineEdge& edge : edges) order.push_back(&edge);
  std::ranges::sort(order, {}, [&](const OutlineEdge* edge) {
    return std::tuple(word_of(vertices[edge->from], view), word_of(vertices[edge->to], view),
                      word_of_line(*edge));
  });
  std::unordered_map<std::uint32_t, std::uint64_t> number_of;
  SetHash hash;
  for (const OutlineEdge* edge : order) {
    const std::uint64_t from = number_of.emplace(edge->from, number_of.size()).first->second;
    const std::uint64_t to = number_of.emplace(edge->to, number_of.size()).first->second;
    hash.add({word_of(vertices[edge->from], view), word_of(vertices[edge->to], view),
              word_of_line(*edge)});
    hash.add({from, to, 1});
  }
  return hash.digest();
}

}  // namespace

Digest mask_digest(std::span<const MeshPart> parts, const View& view) {
  const SidesInView sides(view);
  SetHash hash;
  for (const MeshPart& part : parts) {
    for_each_trapezoid(part.ranges, [&](std::uint32_t i) {
      const MeshTrapezoid& trapezoid = part.mesh.trapezoids[i];
      const Span span = sides.span_of(part.mesh, trapezoid);
      if (span.top >= span.bottom) return;
      sides.add(part.mesh, trapezoid.left, span, false, hash);
      sides.add(part.mesh, trapezoid.right, span, true, hash);
    });
  }
  return hash.digest();
}

Digest whole_mask_digest(const View& view) {
  SetHash hash;
  SidesInView::add_west(SidesInView(view).rows(), false, hash);
  return hash.digest();
}

Digest outline_digest(std::span<const Point> vertices, std::span<const OutlineEdge> edges,
                      const Stroke& stroke, const View& view) {
  if (stroke.join != LineJoin::round) return digest_of_joined(vertices, edges, view);
  SetHash hash;
  for (const OutlineEdge& edge : edges) {
    hash.add(
        {word_of(vertices[edge.from], view), word_of(vertices[edge.to], view), word_of_line(edge)});
  }
  return hash.digest();
}

}  // namespace trapeze
