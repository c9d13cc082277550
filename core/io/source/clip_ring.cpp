#include "core/io/source/clip_ring.h"

#include <algorithm>
#include <utility>

namespace trapeze {
namespace {

enum class Axis { x, y };
enum class Keep { below, above };

template <Axis axis>
double along(Position p) {
  return axis == Axis::x ? p.x : p.y;
}

template <Axis axis>
double across(Position p) {
  return axis == Axis::x ? p.y : p.x;
}

// The intersection of ab with the line; the ends are ordered first so that ba yields the same bits.
template <Axis axis>
Position cut(Position a, Position b, double line) {
  if (along<axis>(b) < along<axis>(a)) std::swap(a, b);
  // Halving keeps the difference of two huge numbers finite.
  const double run = 0.5 * along<axis>(b) - 0.5 * along<axis>(a);
  const double share = (0.5 * line - 0.5 * along<axis>(a)) / run;
  const double value = across<axis>(a) * (1 - share) + across<axis>(b) * share;
  return axis == Axis::x ? Position{line, value} : Position{value, line};
}

template <Axis axis, Keep keep>
void clip_half_plane(PositionRing& ring, double line, PositionRing& scratch) {
  const auto is_inside = [line](Position p) {
    return keep == Keep::below ? along<axis>(p) <= line : along<axis>(p) >= line;
  };
  if (std::all_of(ring.begin(), ring.end(), is_inside)) return;
  scratch.clear();
  Position previous = ring.back();
  for (const Position current : ring) {
    if (is_inside(previous) != is_inside(current)) {
      scratch.push_back(cut<axis>(previous, current, line));
    }
    if (is_inside(current)) scratch.push_back(current);
    previous = current;
  }
  std::swap(ring, scratch);
}

}  // namespace

void clip_ring(PositionRing& ring, const ClipWindow& window, PositionRing& scratch) {
  clip_half_plane<Axis::y, Keep::above>(ring, window.min_y, scratch);
  clip_half_plane<Axis::y, Keep::below>(ring, window.max_y, scratch);
  clip_half_plane<Axis::x, Keep::above>(ring, window.min_x, scratch);
  clip_half_plane<Axis::x, Keep::below>(ring, window.max_x, scratch);
}

}  // namespace trapeze
