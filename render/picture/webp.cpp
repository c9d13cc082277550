#include "render/picture/webp.h"

#include <webp/encode.h>

#include <cstdint>
#include <stdexcept>

namespace trapeze {
namespace {

// From 0 to 9: a third smaller than with 0 and faster, for tiles of cities; higher values take more
// time for a few percent.
constexpr int kEffort = 2;

struct WebpPicture {
  WebpPicture() {
    if (WebPPictureInit(&picture) == 0) throw std::runtime_error("libwebp is of another version");
    WebPMemoryWriterInit(&writer);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    picture.use_argb = 1;
  }
  ~WebpPicture() {
    WebPPictureFree(&picture);
    WebPMemoryWriterClear(&writer);
  }
  WebpPicture(const WebpPicture&) = delete;
  WebpPicture& operator=(const WebpPicture&) = delete;

  WebPPicture picture;
  WebPMemoryWriter writer;
};

}  // namespace

bool has_webp() {
  return true;
}

int webp_version() {
  return WebPGetEncoderVersion();
}

std::string encode_webp(const RunPicture& picture) {
  WebPConfig config;
  if (WebPConfigInit(&config) == 0 || WebPConfigLosslessPreset(&config, kEffort) == 0) {
    throw std::runtime_error("libwebp is of another version");
  }
  config.exact = 1;
  WebpPicture webp;
  webp.picture.width = picture.width;
  webp.picture.height = picture.height;
  static_assert(sizeof(Rgba) == 4, "libwebp reads four bytes a pixel");
  const Picture spread = to_pixels(picture);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(spread.pixels.data());
  const bool is_done = WebPPictureImportRGBA(&webp.picture, bytes, 4 * picture.width) != 0 &&
                       WebPEncode(&config, &webp.picture) != 0;
  if (!is_done) throw std::runtime_error("libwebp could not encode a picture");
  return {reinterpret_cast<const char*>(webp.writer.mem), webp.writer.size};
}

}  // namespace trapeze
