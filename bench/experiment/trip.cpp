#include "bench/experiment/trip.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/grid/tolerance.h"
#include "core/grid/web_mercator.h"

namespace trapeze::experiment {
namespace {

// Shares of the smallest scale, including those of Figure 7.
constexpr double kScales[] = {1.0,        142.0 / 250, 80.0 / 250, 50.0 / 250, 29.0 / 250,
                              15.0 / 250, 8.5 / 250,   5.0 / 250,  3.0 / 250};
constexpr int kViewsPerScale = 4;

Point middle_of(const Box& box) {
  return {static_cast<std::int32_t>((std::int64_t{box.min_x} + box.max_x) / 2),
          static_cast<std::int32_t>((std::int64_t{box.min_y} + box.max_y) / 2)};
}

/// The central part of a box, half as wide and high.
Box middle_part(const Box& box) {
  const auto quarter = [](std::int64_t min, std::int64_t max) {
    return static_cast<std::int32_t>((max - min) / 4);
  };
  const std::int32_t dx = quarter(box.min_x, box.max_x);
  const std::int32_t dy = quarter(box.min_y, box.max_y);
  return {box.min_x + dx, box.min_y + dy, box.max_x - dx, box.max_y - dy};
}

class Traveller {
 public:
  Traveller(const Map& map, const TripOptions& options)
      : map_(map), options_(options), random_(options.seed), centre_(middle_of(map.bounds)) {}

  void stay_at(double scale) {
    scale_ = scale;
    views_.push_back(view());
    for (int i = 1; i < kViewsPerScale; ++i) {
      centre_ = some_vertex(view().view.box());
      views_.push_back(view());
    }
  }
  void head_for_some_vertex() { centre_ = some_vertex(middle_part(view().view.box())); }

  std::vector<ScaledView> views() { return std::move(views_); }

 private:
  ScaledView view() const {
    return view_around(map_, centre_, scale_, kScreenWidth, kScreenHeight,
                       options_.simplify_pixels);
  }

  /// A random vertex in the box, or its centre if there is none. Uses no distribution: those differ
  /// between standard libraries.
  Point some_vertex(const Box& box) {
    std::vector<Point> there;
    for (const MapLayer& layer : map_.layers) {
      for (const Point p : layer.polygons.rings.points) {
        if (box.intersects({p.x, p.y, p.x, p.y})) there.push_back(p);
      }
    }
    return there.empty() ? centre_ : there[random_() % there.size()];
  }

  const Map& map_;
  const TripOptions& options_;
  std::mt19937 random_;
  Point centre_;
  double scale_ = 1;
  std::vector<ScaledView> views_;
};

}  // namespace

ScaledView view_around(const Map& map, Point centre, double scale, int width, int height,
                       double simplify_pixels) {
  const Point middle = middle_of(map.bounds);
  const double latitude = lonlat_from_grid(middle.x, middle.y).lat * std::numbers::pi / 180;
  const double metres_per_cell =
      2 * kMercatorHalfSide / static_cast<double>(kGridSize) * std::cos(latitude);
  const double cells_per_pixel = scale * kPixelMetres / metres_per_cell;
  ScaledView scaled;
  scaled.scale = scale;
  scaled.view.cells_per_pixel = cells_per_pixel;
  scaled.view.width = width;
  scaled.view.height = height;
  scaled.view.origin_x = std::llround(centre.x - cells_per_pixel * width / 2);
  scaled.view.origin_y = std::llround(centre.y - cells_per_pixel * height / 2);
  scaled.level = nearest_level(simplify_pixels * cells_per_pixel);
  return scaled;
}

std::vector<ScaledView> plan_trip(const Map& map, const TripOptions& options) {
  Traveller traveller(map, options);
  const double smallest = map.source.smallest_scale;
  for (const double share : kScales) {
    traveller.stay_at(share * smallest);
    traveller.head_for_some_vertex();
  }
  for (auto share = std::rbegin(kScales); share != std::rend(kScales); ++share) {
    traveller.stay_at(*share * smallest);
  }
  return traveller.views();
}

}  // namespace trapeze::experiment
