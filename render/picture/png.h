// Pictures to PNG and back, in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "render/picture/picture.h"

namespace trapeze {

struct PngJob;

/// Encodes pictures one after the other, with working memory for reuse.
///
/// A picture of at most 256 colours gets the smallest palette (1, 2, 4 or 8 bits a pixel, opacities
/// in tRNS), any other is RGB if it is opaque and else RGBA. No pixel changes, except that wholly
/// transparent ones may lose their hidden colour. Rows are not filtered: flat colours make runs as
/// they are.
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

/// Decodes any PNG to a picture of colours. Throws std::runtime_error, saying why, if it cannot.
Picture decode_png(std::string_view bytes);

}  // namespace trapeze
