// How far a picture of the program is from the truth.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/picture/compose.h"
#include "tests/oracle/true_tile.h"

namespace trapeze::oracle {

/// In 255ths, of red, green, blue and opacity, premultiplied.
struct Distance {
  std::size_t pixels = 0;
  double sum = 0;                     // over all pixels and channels
  std::size_t plainly_different = 0;  // pixels with a channel that is off by more than 64
  std::size_t inner = 0;              // pixels away from all edges
  std::size_t inner_different = 0;
  double worst = 0;
  std::string worst_place;  // tile, column, row
  std::string first_inner_place;

  double mean() const;   // over all channels
  double share() const;  // pixels that are plainly different
  void add(const Distance& other);
};

struct Comparison {
  const TruePicture* truth = nullptr;
  const std::vector<bool>* near_edges = nullptr;
  bool is_opaque = true;  // away from edges colours are equal, otherwise within 1
  std::string place;
};

/// A picture that does not have the size of a tile counts as wholly different.
Distance compare(const Picture& picture, const Comparison& comparison);

}  // namespace trapeze::oracle
