// Dust for one image. Loops smaller than its pixels appear as motes for each class of features,
// merged within pixels, so there are at most as many as pixels times classes. Larger loops, which
// were removed only because of a large tolerance, appear as patches in their place.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/tolerance.h"
#include "core/layer/grains.h"

namespace trapeze {

/// The class of features that are not drawn.
constexpr std::uint8_t kNotDrawn = 0xff;

struct ClassMote {
  Box box;
  std::uint8_t feature_class = 0;
  bool is_hole = false;  // subtracts area
};

/// A grain that is larger than a pixel.
struct ClassPatch {
  std::array<Point, 4> corners;  // of a rectangle, in order around it
  std::uint8_t feature_class = 0;
  bool is_hole = false;  // subtracts area
};

struct ClassShapes {
  std::vector<ClassMote> motes;  // in order of class, then of pixel
  std::vector<ClassPatch> patches;
};

/// The requested grains, and the size of the pixels.
struct DustSelection {
  Box box;
  GrainIndex::Births births;
  double pixel = 0;  // side of a pixel, in cells
};

/// Holds working memory for reuse. One thread at a time.
class ClassDust {
 public:
  /// Replaces `shapes` by those of the selected grains. `classes` has one entry for every row that
  /// a grain may refer to; if it is empty, all are of class 0.
  void gather(const GrainIndex& grains, const DustSelection& selection,
              std::span<const std::uint8_t> classes, ClassShapes& shapes);

  /// The same for several layers whose features are drawn like those of one: call begin(), add()
  /// for each layer, finish().
  void begin(ClassShapes& shapes);
  void add(const GrainIndex& grains, const DustSelection& selection,
           std::span<const std::uint8_t> classes, ClassShapes& shapes);
  /// `pixel` is the pixel of the selections, which must be the same for all.
  void finish(double pixel, ClassShapes& shapes);

 private:
  struct Sum {
    double x = 0;  // weighted sum of positions
    double y = 0;
    double area = 0;
    double weight = 0;
  };

  void add_motes(const FeatureGrain& grain, std::uint8_t feature_class, double pixel);

  std::unordered_map<std::uint64_t, Sum> sums_;  // by class and pixel
  std::vector<std::uint64_t> keys_;
};

}  // namespace trapeze
