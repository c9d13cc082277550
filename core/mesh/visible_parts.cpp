#include "core/mesh/visible_parts.h"

#include <algorithm>
#include <array>

namespace trapeze {
namespace {

constexpr double kNothing = 1.0 / 64;  // cells: edges this near to each other are one

/// An edge between two heights.
struct Side {
  std::uint32_t edge;
  EdgeLine line;
  double top;     // x
  double bottom;  // x

  Side(const MeshView& mesh, std::uint32_t index, std::int32_t y0, std::int32_t y1)
      : edge(index), line(mesh, index), top(line.x_at(y0)), bottom(line.x_at(y1)) {}

  bool is_west_of(const Side& other) const {
    return top <= other.top + kNothing && bottom <= other.bottom + kNothing;
  }
};

/// The heights at which the sides of two trapezoids cross, in ascending order, between y0 and y1,
/// which come first and last.
class Heights {
 public:
  Heights(std::int32_t y0, std::int32_t y1) : heights_{y0}, last_(y1) {}

  void add_crossing(const Side& a, const Side& b) {
    const double above = a.top - b.top;
    const double below = a.bottom - b.bottom;
    const bool cross =
        (above > kNothing && below < -kNothing) || (above < -kNothing && below > kNothing);
    if (!cross) return;
    const double y =
        heights_[0] + (static_cast<double>(last_) - heights_[0]) * above / (above - below);
    const auto rounded = static_cast<std::int32_t>(y + 0.5 - (y < 0));
    if (rounded > heights_[0] && rounded < last_) heights_[count_++] = rounded;
  }

  std::span<const std::int32_t> sorted() {
    heights_[count_++] = last_;
    std::sort(heights_.begin(), heights_.begin() + count_);
    return {heights_.data(), count_};
  }

 private:
  std::array<std::int32_t, 6> heights_;
  std::size_t count_ = 1;
  std::int32_t last_;
};

}  // namespace

void Sheet::assign(const MeshView& mesh, std::span<const std::uint32_t> trapezoids) {
  items_.clear();
  for (const std::uint32_t i : trapezoids) {
    const MeshTrapezoid& t = mesh.trapezoids[i];
    const std::int32_t top = mesh.vertices[t.top].y;
    const std::int32_t bottom = mesh.vertices[t.bottom].y;
    if (top < bottom) items_.push_back({top, bottom, 0, t.left, t.right});
  }
  std::ranges::sort(items_, {}, &Item::top);
  std::int32_t reach = kGridMin;
  for (Item& item : items_) item.reach = reach = std::max(reach, item.bottom);
}

void VisibleParts::begin(const MeshView& mesh) {
  mesh_ = mesh;
  parts_.clear();
  last_ = 0;
  pending_.clear();  // something is left if it was cancelled
}

void VisibleParts::add(std::uint32_t trapezoid) {
  last_ = parts_.size();
  const MeshTrapezoid& t = mesh_.trapezoids[trapezoid];
  const std::int32_t top = mesh_.vertices[t.top].y;
  const std::int32_t bottom = mesh_.vertices[t.bottom].y;
  if (top < bottom) parts_.push_back({top, bottom, t.left, t.right, 1});
}

void VisibleParts::cover(const Sheet& sheet, float share, CancellationCheck& check) {
  covered_.assign(parts_.begin() + static_cast<std::ptrdiff_t>(last_), parts_.end());
  parts_.resize(last_);
  for (const TrapezoidPart& part : covered_) {
    const auto first = std::ranges::upper_bound(sheet.items(), part.top, {}, &Sheet::Item::reach);
    pending_.push_back({part, static_cast<std::size_t>(first - sheet.items().begin())});
    while (!pending_.empty()) {
      const Pending pending = pending_.back();
      pending_.pop_back();
      cover(pending, sheet.items(), share, check);
    }
  }
}

void VisibleParts::cover(const Pending& pending, std::span<const Sheet::Item> items, float share,
                         CancellationCheck& check) {
  const TrapezoidPart& part = pending.part;
  for (std::size_t i = pending.next; i < items.size() && items[i].top < part.bottom; ++i) {
    check();
    if (items[i].bottom > part.top && cut(part, items[i], share, i + 1)) return;
  }
  parts_.push_back(part);
}

/// False if the part is not touched. Parts beside the trapezoid above are then pending.
bool VisibleParts::cut(const TrapezoidPart& part, const Sheet::Item& above, float share,
                       std::size_t next) {
  const std::int32_t y0 = std::max(part.top, above.top);
  const std::int32_t y1 = std::min(part.bottom, above.bottom);
  const Side left(mesh_, part.left, y0, y1);
  const Side above_right(mesh_, above.right, y0, y1);
  if (above_right.is_west_of(left)) return false;
  const Side right(mesh_, part.right, y0, y1);
  const Side above_left(mesh_, above.left, y0, y1);
  if (right.is_west_of(above_left)) return false;

  Heights heights(y0, y1);
  for (const Side* side : {&left, &right}) {
    heights.add_crossing(*side, above_left);
    heights.add_crossing(*side, above_right);
  }
  const auto keep_between = [&](std::int32_t top, std::int32_t bottom, const Side& from,
                                const Side& to) {
    keep({top, bottom, from.edge, to.edge, part.share}, next);
  };
  keep_between(part.top, y0, left, right);
  const std::span<const std::int32_t> slabs = heights.sorted();
  for (std::size_t i = 0; i + 1 < slabs.size(); ++i) {
    const std::int32_t top = slabs[i];
    const std::int32_t bottom = slabs[i + 1];
    const double middle = (static_cast<double>(top) + bottom) / 2;
    const auto is_west = [middle](const Side& a, const Side& b) {
      return a.line.x_at(middle) <= b.line.x_at(middle) + kNothing;
    };
    if (is_west(above_right, left) || is_west(right, above_left)) {
      keep_between(top, bottom, left, right);
      continue;
    }
    const bool has_west = !is_west(above_left, left);
    const bool has_east = !is_west(right, above_right);
    if (has_west) keep_between(top, bottom, left, above_left);
    if (has_east) keep_between(top, bottom, above_right, right);
    if (part.share * share >= kLeastShare && top < bottom) {
      parts_.push_back({top, bottom, has_west ? above_left.edge : left.edge,
                        has_east ? above_right.edge : right.edge, part.share * share});
    }
  }
  keep_between(y1, part.bottom, left, right);
  return true;
}

void VisibleParts::keep(const TrapezoidPart& part, std::size_t next) {
  if (part.top < part.bottom) pending_.push_back({part, next});
}

}  // namespace trapeze
