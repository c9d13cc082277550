#include "render/png.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <stdexcept>
#include <string>

namespace trapeze {
namespace {

constexpr std::size_t kMaxColours = 256;

// The palette as it is stored: only colours that pixels have, the translucent ones in front, so
// that tRNS ends with the last of them.
struct StoredPalette {
  std::vector<png_color> colours;
  std::vector<png_byte> opacities;                   // of the first colours; the others are opaque
  std::array<std::uint8_t, kMaxColours> index_of{};  // stored index of each index of the picture
  int bits = 8;                                      // a pixel
};

StoredPalette pack_palette(const Picture& picture) {
  std::array<bool, kMaxColours> is_used{};
  for (const std::uint8_t index : picture.indices) is_used[index] = true;
  StoredPalette stored;
  for (const bool opaque : {false, true}) {
    for (std::size_t i = 0; i < picture.palette.size(); ++i) {
      const Rgba colour = picture.palette[i];
      if (!is_used[i] || (colour.a == 255) != opaque) continue;
      stored.index_of[i] = static_cast<std::uint8_t>(stored.colours.size());
      stored.colours.push_back({colour.r, colour.g, colour.b});
      if (!opaque) stored.opacities.push_back(colour.a);
    }
  }
  const std::size_t count = stored.colours.size();
  stored.bits = count <= 2 ? 1 : count <= 4 ? 2 : count <= 16 ? 4 : 8;
  return stored;
}

// A row of indices with `bits` to each, the first pixel in the highest bits.
void pack_row(const std::uint8_t* indices, int width, const StoredPalette& palette,
              std::uint8_t* row) {
  const int per_byte = 8 / palette.bits;
  for (int column = 0; column < width; column += per_byte) {
    unsigned byte = 0;
    for (int i = 0; i < per_byte; ++i) {
      const unsigned index = column + i < width ? palette.index_of[indices[column + i]] : 0u;
      byte = (byte << palette.bits) | index;
    }
    *row++ = static_cast<std::uint8_t>(byte);
  }
}

// Everything that libpng is to write, ready beforehand: between its jumps there must be nothing
// with a destructor.
struct Job {
  int width = 0;
  int height = 0;
  int bits = 8;
  int colour_type = PNG_COLOR_TYPE_PALETTE;
  StoredPalette palette;
  std::size_t row_bytes = 0;
  std::vector<std::uint8_t> rows;

  std::vector<std::uint8_t> bytes;  // the result
  std::string error;
};

Job job_for_indices(const Picture& picture) {
  Job job;
  job.palette = pack_palette(picture);
  job.bits = job.palette.bits;
  const auto width = static_cast<std::size_t>(picture.width);
  job.row_bytes = (width * static_cast<std::size_t>(job.bits) + 7) / 8;
  job.rows.resize(job.row_bytes * static_cast<std::size_t>(picture.height));
  for (std::size_t row = 0; row < static_cast<std::size_t>(picture.height); ++row) {
    pack_row(picture.indices.data() + row * width, picture.width, job.palette,
             job.rows.data() + row * job.row_bytes);
  }
  return job;
}

Job job_for_colours(const Picture& picture) {
  Job job;
  const bool is_opaque = std::all_of(picture.pixels.begin(), picture.pixels.end(),
                                     [](Rgba colour) { return colour.a == 255; });
  job.colour_type = is_opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA;
  const std::size_t channels = is_opaque ? 3 : 4;
  job.row_bytes = static_cast<std::size_t>(picture.width) * channels;
  job.rows.resize(picture.pixels.size() * channels);
  std::uint8_t* out = job.rows.data();
  for (const Rgba colour : picture.pixels) {
    *out++ = colour.r;
    *out++ = colour.g;
    *out++ = colour.b;
    if (!is_opaque) *out++ = colour.a;
  }
  return job;
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  Job& job = *static_cast<Job*>(png_get_error_ptr(png));
  try {
    job.error = message;
  } catch (...) {  // without memory the error stays without words
  }
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep data, std::size_t size) {
  Job& job = *static_cast<Job*>(png_get_io_ptr(png));
  bool is_written = false;
  try {
    job.bytes.insert(job.bytes.end(), data, data + size);
    is_written = true;
  } catch (...) {  // no exception may pass through C
  }
  if (!is_written) png_error(png, "out of memory");
}

void on_flush(png_structp) {}

// False if libpng jumped out. Has nothing to destroy, so jumping leaks nothing.
bool write(png_structp png, png_infop info, Job& job) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, &job, on_write, on_flush);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
  png_set_compression_level(png, 1);
  // Indices come in runs: looking for those alone is faster and, at this level, smaller.
  png_set_compression_strategy(
      png, job.colour_type == PNG_COLOR_TYPE_PALETTE ? Z_RLE : Z_DEFAULT_STRATEGY);
  png_set_IHDR(png, info, static_cast<png_uint_32>(job.width), static_cast<png_uint_32>(job.height),
               job.bits, job.colour_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (job.colour_type == PNG_COLOR_TYPE_PALETTE) {
    png_set_PLTE(png, info, job.palette.colours.data(),
                 static_cast<int>(job.palette.colours.size()));
    if (!job.palette.opacities.empty()) {
      png_set_tRNS(png, info, job.palette.opacities.data(),
                   static_cast<int>(job.palette.opacities.size()), nullptr);
    }
  }
  png_write_info(png, info);
  const png_byte* row = job.rows.data();
  for (int i = 0; i < job.height; ++i, row += job.row_bytes) png_write_row(png, row);
  png_write_end(png, nullptr);
  return true;
}

void run(Job& job) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  const bool is_written = info != nullptr && write(png, info, job);
  png_destroy_write_struct(&png, &info);
  if (!is_written) throw std::runtime_error("writing PNG failed: " + job.error);
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Picture& picture) {
  Job job = picture.is_indexed() ? job_for_indices(picture) : job_for_colours(picture);
  job.width = picture.width;
  job.height = picture.height;
  run(job);
  return std::move(job.bytes);
}

Picture decode_png(std::span<const std::uint8_t> bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto fail = [&image] {
    const std::string reason = image.message;
    png_image_free(&image);
    throw std::runtime_error("reading PNG failed: " + reason);
  };
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) fail();
  image.format = PNG_FORMAT_RGBA;
  if (image.width > static_cast<png_uint_32>(kMaxPicturePixels) ||
      image.height > static_cast<png_uint_32>(kMaxPicturePixels)) {
    png_image_free(&image);
    throw std::runtime_error("reading PNG failed: the picture is too large");
  }
  Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}, {}, {}};
  static_assert(sizeof(Rgba) == 4, "libpng writes four bytes a pixel");
  picture.pixels.resize(std::size_t{image.width} * image.height);
  if (png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr) == 0) fail();
  return picture;
}

}  // namespace trapeze
