#include "core/io/source/target_grid.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <ogr_spatialref.h>

#include "core/grid/grid.h"
#include "core/io/source/gdal_messages.h"

namespace trapeze {
namespace {

constexpr int kSamples = 64;        // across the area, in both directions
constexpr double kMostAround = 30;  // degrees
constexpr double kRoom = 1.001;     // factor for the square, so that nothing lies on its edge
constexpr double kMostGrowth = 4;   // of the square, because of the margin around the area of use:
                                    // Mercator reaches a pole, twelve times as far as the world

struct Area {
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
};

/// "EPSG:2056": an authority and a code. PROJ knows "epsg:2056" as well, but clients do not, and it
/// would be another grid and another file.
bool is_code(const std::string& name) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == name.size()) return false;
  const auto is_small = [](unsigned char c) { return std::islower(c) != 0; };
  if (std::any_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(colon), is_small)) {
    return false;
  }
  return std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == ':' || c == '_' || c == '-' || c == '.';
  });
}

OGRSpatialReference wgs84() {
  OGRSpatialReference reference;
  reference.SetWellKnownGeogCS("WGS84");
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw std::runtime_error(name + " " + why);
}

Area with_margin(const Area& area, double share) {
  const double longer = std::max(area.east - area.west, area.north - area.south);
  const double more = std::min(longer / 2, kMostAround) * share;
  Area around{area.west - more, std::max(area.south - more, -90.0), area.east + more,
              std::min(area.north + more, 90.0)};
  if (around.east - around.west >= 360) {
    around.west = -180;
    around.east = 180;
  }
  return around;
}

/// Whether the plane ends at a meridian within the area and continues on its other side, as that of
/// EPSG:8858 does at 90 degrees east: polygons there would lie across the map. The sides of the
/// area may be such a meridian, so the first and the last samples do not count. `x` and `y` hold
/// the samples from south to north, for one meridian after the other.
bool is_torn(const std::vector<double>& x, const std::vector<double>& y, double side) {
  constexpr std::size_t kOfMeridian = kSamples + 1;
  for (std::size_t i = kOfMeridian; i + 2 * kOfMeridian < x.size(); ++i) {
    const std::size_t east = i + kOfMeridian;
    if (std::hypot(x[east] - x[i], y[east] - y[i]) > side / 2) return true;
  }
  return false;
}

double side_of(const Area& sides) {
  return std::max(sides.east - sides.west, sides.north - sides.south);
}

/// Computes the extent of the area on the plane; false if a part of it cannot be projected, or the
/// plane is torn there.
bool project(const Area& area, OGRCoordinateTransformation& forward, Area& sides) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      x.push_back(area.west + (area.east - area.west) * i / kSamples);
      y.push_back(area.south + (area.north - area.south) * j / kSamples);
    }
  }
  std::vector<int> succeeded(x.size(), 0);
  const GdalMessages messages;
  forward.Transform(static_cast<int>(x.size()), x.data(), y.data(), nullptr, succeeded.data());
  const auto is_place = [&](std::size_t i) {
    return succeeded[i] != 0 && std::isfinite(x[i]) && std::isfinite(y[i]);
  };
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_place(i)) return false;
  }
  const auto [west, east] = std::minmax_element(x.begin(), x.end());
  const auto [south, north] = std::minmax_element(y.begin(), y.end());
  sides = {*west, *south, *east, *north};
  return !is_torn(x, y, side_of(sides));
}

/// Around a pole, eastings too may grow towards the north or the south.
bool is_northing_first(const OGRSpatialReference& reference) {
  OGRAxisOrientation orientation = OAO_Other;
  const char* name = reference.GetAxis(nullptr, 0, &orientation);
  const std::string axis = name == nullptr ? "" : name;
  if (axis.starts_with("East")) return false;
  return axis.starts_with("North") || orientation == OAO_North;
}

std::shared_ptr<const TargetGrid> make_grid(const std::string& name) {
  if (!is_code(name)) refuse(name, "is not the name of a reference system such as EPSG:2056");
  auto reference = std::make_unique<OGRSpatialReference>();
  const GdalMessages messages;
  if (reference->SetFromUserInput(name.c_str()) != OGRERR_NONE) {
    refuse(name, "is a reference system that PROJ does not know");
  }
  if (reference->IsProjected() == 0) refuse(name, "is no system of a plane");
  Area used;
  if (!reference->GetAreaOfUse(&used.west, &used.south, &used.east, &used.north, nullptr)) {
    refuse(name, "has no area of use that PROJ knows");
  }
  if (used.west >= used.east) used.east += 360;
  auto grid = std::make_shared<TargetGrid>();
  grid->name = name;
  grid->title = reference->GetName() == nullptr ? name : reference->GetName();
  grid->is_north_first = is_northing_first(*reference);
  grid->metres_per_unit = reference->GetLinearUnits();
  reference->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const OGRSpatialReference lonlat = wgs84();
  const std::unique_ptr<OGRCoordinateTransformation> forward(
      OGRCreateCoordinateTransformation(&lonlat, reference.get()));
  Area inner;
  if (forward == nullptr || !project(used, *forward, inner)) {
    refuse(name,
           "cannot be transformed from WGS 84 in all of its area of use, or not without a break");
  }
  Area drawn = used;
  Area sides = inner;
  for (const double share : {1.0, 0.5, 0.25, 0.125}) {
    const Area around = with_margin(used, share);
    Area outer;
    if (!project(around, *forward, outer)) continue;
    if (side_of(outer) > kMostGrowth * side_of(inner)) continue;
    drawn = around;
    sides = outer;
    break;
  }
  grid->middle_x = (sides.west + sides.east) / 2;
  grid->middle_y = (sides.south + sides.north) / 2;
  grid->half_side = side_of(sides) / 2 * kRoom;
  grid->west = drawn.west;
  grid->south = drawn.south;
  grid->east = drawn.east;
  grid->north = drawn.north;
  grid->reference = std::move(reference);
  return grid;
}

}  // namespace

double TargetGrid::cells_per_unit() const {
  return static_cast<double>(kGridMax) / half_side;
}

std::shared_ptr<const TargetGrid> find_target_grid(const std::string& name) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const TargetGrid>> known;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const TargetGrid>& grid = known[name];
  if (grid != nullptr) return grid;
  try {
    grid = make_grid(name);
  } catch (...) {
    known.erase(name);
    throw;
  }
  return grid;
}

GridTransform::GridTransform(const TargetGrid& grid) : grid_(grid) {
  const OGRSpatialReference lonlat = wgs84();
  const GdalMessages messages;
  forward_.reset(OGRCreateCoordinateTransformation(&lonlat, grid.reference.get()));
  inverse_.reset(OGRCreateCoordinateTransformation(grid.reference.get(), &lonlat));
  if (forward_ == nullptr || inverse_ == nullptr) {
    throw std::runtime_error(grid.name + " cannot be transformed from WGS 84");
  }
}

GridTransform::~GridTransform() = default;

bool GridTransform::to_cells(std::vector<double>& x, std::vector<double>& y) {
  if (x.empty()) return true;
  const GdalMessages messages;
  succeeded_.assign(x.size(), 0);
  forward_->Transform(static_cast<int>(x.size()), x.data(), y.data(), nullptr, succeeded_.data());
  const double cells_per_unit = grid_.cells_per_unit();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (succeeded_[i] == 0 || !std::isfinite(x[i]) || !std::isfinite(y[i])) return false;
    x[i] = (x[i] - grid_.middle_x) * cells_per_unit;
    y[i] = (grid_.middle_y - y[i]) * cells_per_unit;
  }
  return true;
}

bool GridTransform::to_lonlat(std::vector<double>& x, std::vector<double>& y) {
  if (x.empty()) return true;
  const GdalMessages messages;
  const double cells_per_unit = grid_.cells_per_unit();
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = grid_.middle_x + x[i] / cells_per_unit;
    y[i] = grid_.middle_y - y[i] / cells_per_unit;
  }
  succeeded_.assign(x.size(), 0);
  inverse_->Transform(static_cast<int>(x.size()), x.data(), y.data(), nullptr, succeeded_.data());
  return std::none_of(succeeded_.begin(), succeeded_.end(), [](int done) { return done == 0; }) &&
         std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); }) &&
         std::all_of(y.begin(), y.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace trapeze
