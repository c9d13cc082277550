#include "render/mask/canvas.h"

#include <algorithm>

namespace trapeze {

void Canvas::begin(int width, int height) {
  if (width != width_ || height != height_ || !is_clean_) {
    width_ = height_ = 0;  // what there is no memory for is begun anew the next time
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(height);
    values_.assign(columns * rows, 0);
    touched_.assign(columns, rows);
    width_ = width;
    height_ = height;
  }
  is_clean_ = false;
}

void Canvas::finish(Mask& mask) {
  mask.begin(width_, height_);
  const auto columns = static_cast<std::size_t>(width_);
  for (int row = 0; row < height_; ++row) {
    const auto i = static_cast<std::size_t>(row);
    std::uint8_t* values = values_.data() + i * columns;
    std::size_t done = 0;
    const auto append_zeros = [&](std::size_t end) {
      if (end > done) mask.append(end, 0);
    };
    for_each_touched(touched_.take(i), touched_.shift(), columns,
                     [&](std::size_t begin, std::size_t end) {
                       append_zeros(begin);
                       for (std::size_t k = begin; k < end; ++k) mask.append(k + 1, values[k]);
                       std::fill(values + begin, values + end, std::uint8_t{0});
                       done = end;
                     });
    append_zeros(columns);
    mask.end_row();
  }
  is_clean_ = true;
}

}  // namespace trapeze
