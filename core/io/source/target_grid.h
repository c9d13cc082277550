// Grids of reference systems other than Web Mercator: the plane of the system, divided into 2^31 x
// 2^31 square cells around its area of use, x to the right and y downwards on a map.
//
// Thread-safety: grids are immutable and may be used from any thread. A transform is for one
// thread.
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
  bool is_north_first = false;  // whether the authority places the northing before the easting
  double metres_per_unit = 1;
  // The square of the cells, in units of the system: its centre, and half of its side.
  double middle_x = 0;
  double middle_y = 0;
  double half_side = 0;
  // The drawn area, in degrees: the area of use extended on each side by half of its longer side,
  // but at most 30 degrees, and by less if the projection fails there or the square would become
  // too large. West is less than east, which may exceed 180; the full circle is -180 to 180.
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
  std::shared_ptr<const OGRSpatialReference> reference;

  bool goes_around() const { return east - west >= 360; }
  double cells_per_unit() const;
  double metres_per_cell() const { return metres_per_unit / cells_per_unit(); }
};

/// The grid of a projected system according to PROJ's database; it stays the same as long as that
/// does. Throws std::runtime_error, with a message that begins with the name, if there is none.
std::shared_ptr<const TargetGrid> find_target_grid(const std::string& name);

class GridTransform {
 public:
  /// `grid` must outlive this object. Throws std::runtime_error if PROJ does not support it.
  explicit GridTransform(const TargetGrid& grid);
  ~GridTransform();
  GridTransform(const GridTransform&) = delete;
  GridTransform& operator=(const GridTransform&) = delete;

  /// Replaces longitudes and latitudes by cells, not rounded. False if one of them cannot be
  /// projected.
  bool to_cells(std::vector<double>& x, std::vector<double>& y);
  /// The inverse.
  bool to_lonlat(std::vector<double>& x, std::vector<double>& y);

 private:
  const TargetGrid& grid_;
  std::unique_ptr<OGRCoordinateTransformation> forward_;
  std::unique_ptr<OGRCoordinateTransformation> inverse_;
  std::vector<int> succeeded_;
};

}  // namespace trapeze
