// Grids of reference systems other than Web Mercator: the system's plane in 2^31 x 2^31 square
// cells, x to the right and y downwards on a map, around the system's area of use.
//
// Thread-safety: grids are immutable; any thread. A transform belongs to one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

class OGRCoordinateTransformation;
class OGRSpatialReference;

namespace trapeze {

struct TargetGrid {
  std::string name;             // "EPSG:2056"
  std::string title;            // "CH1903+ / LV95"
  bool is_north_first = false;  // whether the authority has the northing before the easting
  double metres_per_unit = 1;
  // The square of the cells, in units: its middle, and half of its side.
  double middle_x = 0;
  double middle_y = 0;
  double half_side = 0;
  // What is drawn, in degrees: the area of use and half as much around it, but at most 30 degrees.
  // West is less than east, which may be more than 180; all the way round it is -180 to 180.
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
  std::shared_ptr<const OGRSpatialReference> reference;

  bool goes_around() const { return east - west >= 360; }
  double cells_per_unit() const;
  double metres_per_cell() const { return metres_per_unit / cells_per_unit(); }
};

/// The grid of a projected system, by what PROJ's database says of it; the same as long as PROJ
/// does. Throws std::runtime_error, in words that begin with the name, if there is none.
std::shared_ptr<const TargetGrid> find_target_grid(const std::string& name);

class GridTransform {
 public:
  /// `grid` must outlive it. Throws std::runtime_error if PROJ cannot do it.
  explicit GridTransform(const TargetGrid& grid);
  ~GridTransform();
  GridTransform(const GridTransform&) = delete;
  GridTransform& operator=(const GridTransform&) = delete;

  /// Replaces longitudes and latitudes by cells, not rounded. False if one of them has no place on
  /// the plane.
  bool to_cells(std::vector<double>& x, std::vector<double>& y);
  /// The other way round.
  bool to_lonlat(std::vector<double>& x, std::vector<double>& y);

 private:
  const TargetGrid& grid_;
  std::unique_ptr<OGRCoordinateTransformation> forward_;
  std::unique_ptr<OGRCoordinateTransformation> inverse_;
  std::vector<int> succeeded_;
};

}  // namespace trapeze
