// Dust for a style that draws features in classes: motes for each class, merged within the pixels
// of one picture, so that there are at most as many as its pixels times its classes.
#pragma once

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

/// Holds working memory for reuse; one thread at a time.
class ClassDust {
 public:
  /// Replaces `motes` by those of the grains born at `level` or before that lie in the box, in
  /// order of class, and within it of pixel. `pixel` is the side of a pixel in cells; `classes` has
  /// one for every row that a grain may name.
  void gather(const GrainIndex& grains, const Box& box, Level level, double pixel,
              std::span<const std::uint8_t> classes, std::vector<ClassMote>& motes);

 private:
  struct Sum {
    double x = 0;  // of places, weighted
    double y = 0;
    double area = 0;
    double weight = 0;
  };

  std::unordered_map<std::uint64_t, Sum> sums_;  // by class and pixel
  std::vector<std::uint64_t> keys_;
};

}  // namespace trapeze
