// Encodes and decodes PNG, in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "render/picture/picture.h"

namespace trapeze {

struct PngJob;

/// Encodes pictures one after the other, with reused working memory.
///
/// A picture with at most 256 colours gets the smallest palette (1, 2, 4 or 8 bits per pixel,
/// opacities in tRNS); any other is RGB if it is opaque, else RGBA. No pixel changes, except that
/// fully transparent ones may lose their hidden colour. Rows are not filtered: flat colours form
/// runs without that.
///
/// Thread-safety: one thread at a time.
class PngEncoder {
 public:
  PngEncoder();
  ~PngEncoder();
  PngEncoder(PngEncoder&&) noexcept;
  PngEncoder& operator=(PngEncoder&&) noexcept;

  /// Throws std::runtime_error if the picture has no pixels or libpng fails.
  std::string encode(const RunPicture& picture);

 private:
  std::unique_ptr<PngJob> job_;
};

/// Decodes any PNG to a picture with one colour per pixel. Throws std::runtime_error with the
/// reason if it cannot.
Picture decode_png(std::string_view bytes);

}  // namespace trapeze
