// The paper's transfer to the device: vertices are sent once; a view sends the numbers of the
// vertices of its trapezoids, and the device looks up their positions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/experiment/screen.h"

namespace trapeze::experiment {

/// The numbers of the six vertices that define a trapezoid.
struct VertexNumbers {
  std::uint32_t top = 0;
  std::uint32_t bottom = 0;
  std::uint32_t left_upper = 0;
  std::uint32_t left_lower = 0;
  std::uint32_t right_upper = 0;
  std::uint32_t right_lower = 0;
};

class NumberedTrapezoids {
 public:
  /// Sends the vertices. `screen` must outlive this object. Throws std::runtime_error if the device
  /// does not support compute shaders.
  NumberedTrapezoids(Screen& screen, std::span<const Point> vertices);
  ~NumberedTrapezoids();
  NumberedTrapezoids(const NumberedTrapezoids&) = delete;
  NumberedTrapezoids& operator=(const NumberedTrapezoids&) = delete;

  /// Sends the numbers, and waits until the device has converted them to trapezoids.
  void send(std::span<const VertexNumbers> numbers);

  /// As in DeviceTrapezoids.
  DrawTimes draw(std::span<const std::uint32_t> ends, const View& view, std::vector<Mask>& masks) {
    return trapezoids_.draw(ends, view, masks);
  }

 private:
  Screen& screen_;
  DeviceTrapezoids trapezoids_;
  GLuint program_ = 0;
  GLint count_location_ = -1;
  GLuint vertices_ = 0;
  GLuint numbers_ = 0;
  std::size_t room_ = 0;  // for numbers
};

}  // namespace trapeze::experiment
