// The labels in the pictures of a plan, identified by their position in the world.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "server/labels/label_book.h"
#include "server/tiles/tile_plan.h"
#include "tests/server/service/sample_site.h"

namespace trapeze::testing {

/// A label with the position that it has in every picture of that scale.
struct SeenLabel {
  std::int64_t left = 0;  // in pixels from the middle of the world
  std::int64_t top = 0;
  std::shared_ptr<const LabelImage> image;

  auto key() const { return std::tuple(left, top, image->look().identity); }
  bool operator<(const SeenLabel& other) const { return key() < other.key(); }
  bool operator==(const SeenLabel& other) const { return key() == other.key(); }
};

inline std::set<SeenLabel> labels_in(const TilePlan& plan, const View& view, double scale) {
  std::set<SeenLabel> seen;
  const auto pixel = [&view](std::int64_t origin) {
    return static_cast<std::int64_t>(
        std::floor(static_cast<double>(origin) / view.cells_per_pixel));
  };
  for (const DrawnLabel& label : label_book()->find({*plan.dataset, plan.labels, view, scale})) {
    seen.insert({pixel(view.origin_x) + label.left, pixel(view.origin_y) + label.top, label.image});
  }
  return seen;
}

/// A label with its centre in cells, which does not depend on the scale.
struct LabelPlace {
  double x = 0;
  double y = 0;
  std::string identity;
};

inline std::vector<LabelPlace> label_places(const TilePlan& plan, const View& view) {
  std::vector<LabelPlace> places;
  for (const auto& label : label_book()->find({*plan.dataset, plan.labels, view, plan.scale})) {
    const auto along = [&view](std::int64_t origin, int first, int pixels) {
      return static_cast<double>(origin) + (first + pixels / 2) * view.cells_per_pixel;
    };
    const TextMask& mask = label.image->mask();
    places.push_back({along(view.origin_x, label.left, mask.width),
                      along(view.origin_y, label.top, mask.height), label.image->look().identity});
  }
  return places;
}

/// Whether the same label is in `places`, less than `within` cells away in either direction.
inline bool is_among(const LabelPlace& wanted, const std::vector<LabelPlace>& places,
                     double within) {
  return std::ranges::any_of(places, [&](const LabelPlace& place) {
    return place.identity == wanted.identity && std::abs(place.x - wanted.x) < within &&
           std::abs(place.y - wanted.y) < within;
  });
}

}  // namespace trapeze::testing
