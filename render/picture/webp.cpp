#include "render/picture/webp.h"

#include <webp/encode.h>

#include <stdexcept>
#include <vector>

namespace trapeze {
namespace {

// Of 0 to 9: the fastest, which makes tiles about as large as PNG has them, or smaller.
constexpr int kEffort = 0;

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

std::vector<std::uint8_t> rgba_bytes(const Picture& picture) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * static_cast<std::size_t>(picture.width) *
                static_cast<std::size_t>(picture.height));
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const Rgba colour = picture.at(column, row);
      bytes.insert(bytes.end(), {colour.r, colour.g, colour.b, colour.a});
    }
  }
  return bytes;
}

}  // namespace

bool has_webp() {
  return true;
}

std::string encode_webp(const Picture& picture) {
  WebPConfig config;
  if (WebPConfigInit(&config) == 0 || WebPConfigLosslessPreset(&config, kEffort) == 0) {
    throw std::runtime_error("libwebp is of another version");
  }
  config.exact = 1;
  WebpPicture webp;
  webp.picture.width = picture.width;
  webp.picture.height = picture.height;
  const std::vector<std::uint8_t> bytes = rgba_bytes(picture);
  const bool is_done = WebPPictureImportRGBA(&webp.picture, bytes.data(), 4 * picture.width) != 0 &&
                       WebPEncode(&config, &webp.picture) != 0;
  if (!is_done) throw std::runtime_error("libwebp could not encode a picture");
  return {reinterpret_cast<const char*>(webp.writer.mem), webp.writer.size};
}

}  // namespace trapeze
