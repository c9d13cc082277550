// Dust for one picture: what was smaller than its pixels, as motes for each class of features,
// merged within its pixels, so that there are at most as many as its pixels times its classes; what
// was larger, and went only for a great tolerance, as patches, where it was.
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
  bool is_hole = false;  // takes area away
};

/// A grain that is larger than a pixel.
struct ClassPatch {
  std::array<Point, 4> corners;  // of a rectangle, one after the other
  std::uint8_t feature_class = 0;
  bool is_hole = false;  // takes area away
};

struct ClassShapes {
  std::vector<ClassMote> motes;  // in order of class, and within it of pixel
  std::vector<ClassPatch> patches;
};

/// Which grains are wanted, and for what pixels.
struct DustSelection {
  Box box;
  GrainIndex::Births births;
  double pixel = 0;  // its side, in cells
};

/// Holds working memory for reuse; one thread at a time.
class ClassDust {
 public:
  /// Replaces `shapes` by those of the grains that are wanted. `classes` has one for every row that
  /// a grain may name; if it is empty, all are of class 0.
  void gather(const GrainIndex& grains, const DustSelection& selection,
              std::span<const std::uint8_t> classes, ClassShapes& shapes);

  /// The same of several layers whose features are drawn as those of one: begin(), add() for each,
  /// finish().
  void begin(ClassShapes& shapes);
  void add(const GrainIndex& grains, const DustSelection& selection,
           std::span<const std::uint8_t> classes, ClassShapes& shapes);
  /// `pixel` is that of the selections, all of which had the same.
  void finish(double pixel, ClassShapes& shapes);

 private:
  struct Sum {
    double x = 0;  // of places, weighted
    double y = 0;
    double area = 0;
    double weight = 0;
  };

  void add_motes(const FeatureGrain& grain, std::uint8_t feature_class, double pixel);

  std::unordered_map<std::uint64_t, Sum> sums_;  // by class and pixel
  std::vector<std::uint64_t> keys_;
};

}  // namespace trapeze
