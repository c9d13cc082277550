#include "render/picture/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/picture/deflater.h"

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

constexpr std::size_t kBlock = 8;  // pixels looked at together: most of a tile is flat
constexpr std::uint64_t kEachByte = 0x0101010101010101;

std::uint64_t block_at(const std::uint8_t* indices) {
  std::uint64_t block = 0;
  std::memcpy(&block, indices, sizeof block);
  return block;
}

std::array<bool, kMaxColours> used_indices(std::span<const std::uint8_t> indices) {
  std::array<bool, kMaxColours> is_used{};
  std::uint64_t seen = indices.size() < kBlock ? 0 : ~block_at(indices.data());
  std::size_t i = 0;
  for (; i + kBlock <= indices.size(); i += kBlock) {
    const std::uint64_t block = block_at(indices.data() + i);
    if (block == seen) continue;
    seen = block;
    for (std::size_t k = i; k < i + kBlock; ++k) is_used[indices[k]] = true;
  }
  for (; i < indices.size(); ++i) is_used[indices[i]] = true;
  return is_used;
}

StoredPalette pack_palette(const Picture& picture) {
  const auto is_used = used_indices(picture.indices);
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

// Writes indices as they are stored, `Bits` to each, the first pixel in the highest bits of a byte.
template <int Bits>
void pack_row(std::span<const std::uint8_t> indices, const StoredPalette& palette,
              std::uint8_t* row) {
  constexpr std::size_t kPerByte = 8 / Bits;
  const auto pack_byte = [&](std::size_t first, std::size_t end) {
    unsigned byte = 0;
    for (std::size_t i = first; i < first + kPerByte; ++i) {
      byte = (byte << Bits) | (i < end ? palette.index_of[indices[i]] : 0u);
    }
    return static_cast<std::uint8_t>(byte);
  };
  std::size_t i = 0;
  for (; i + kBlock <= indices.size(); i += kBlock, row += kBlock / kPerByte) {
    const std::uint64_t block = block_at(indices.data() + i);
    if (block == (block & 0xff) * kEachByte) {
      std::memset(row, pack_byte(i, i + kPerByte), kBlock / kPerByte);
    } else {
      for (std::size_t k = 0; k < kBlock / kPerByte; ++k) {
        row[k] = pack_byte(i + k * kPerByte, indices.size());
      }
    }
  }
  for (; i < indices.size(); i += kPerByte) *row++ = pack_byte(i, indices.size());
}

void pack_row(std::span<const std::uint8_t> indices, const StoredPalette& palette,
              std::uint8_t* row) {
  switch (palette.bits) {
    case 1:
      return pack_row<1>(indices, palette, row);
    case 2:
      return pack_row<2>(indices, palette, row);
    case 4:
      return pack_row<4>(indices, palette, row);
    default:
      return pack_row<8>(indices, palette, row);
  }
}

}  // namespace

// Everything that libpng is to write, prepared beforehand: no object with a destructor may be
// created where libpng may jump out by longjmp.
struct PngJob {
  int width = 0;
  int height = 0;
  int bits = 8;
  int colour_type = PNG_COLOR_TYPE_PALETTE;
  StoredPalette palette;
  std::vector<std::uint8_t> rows;  // each begins with the number of its filter
  Deflater deflater;
  std::span<const std::uint8_t> compressed;  // of the deflater

  std::string bytes;  // the result
  std::string error;
};

namespace {

/// Calls `fill` with each row's number and place, once the row has its filter: none.
template <typename Fill>
void make_rows(PngJob& job, std::size_t row_bytes, Fill fill) {
  job.rows.resize((1 + row_bytes) * static_cast<std::size_t>(job.height));
  std::uint8_t* row = job.rows.data();
  for (std::size_t i = 0; i < static_cast<std::size_t>(job.height); ++i, row += 1 + row_bytes) {
    *row = PNG_FILTER_VALUE_NONE;
    fill(i, row + 1);
  }
}

void take_indices(const Picture& picture, PngJob& job) {
  job.palette = pack_palette(picture);
  job.bits = job.palette.bits;
  job.colour_type = PNG_COLOR_TYPE_PALETTE;
  const auto width = static_cast<std::size_t>(picture.width);
  const std::span<const std::uint8_t> indices(picture.indices);
  make_rows(job, (width * static_cast<std::size_t>(job.bits) + 7) / 8,
            [&](std::size_t row, std::uint8_t* out) {
              pack_row(indices.subspan(row * width, width), job.palette, out);
            });
}

void take_colours(const Picture& picture, PngJob& job) {
  static_assert(sizeof(Rgba) == 4, "a pixel is stored as four bytes");
  const bool is_opaque = std::all_of(picture.pixels.begin(), picture.pixels.end(),
                                     [](Rgba colour) { return colour.a == 255; });
  job.bits = 8;
  job.colour_type = is_opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA;
  const auto width = static_cast<std::size_t>(picture.width);
  make_rows(job, width * (is_opaque ? 3 : 4), [&](std::size_t row, std::uint8_t* out) {
    const Rgba* pixels = picture.pixels.data() + row * width;
    if (!is_opaque) {
      std::memcpy(out, pixels, width * sizeof(Rgba));
      return;
    }
    for (std::size_t i = 0; i < width; ++i, out += 3) {
      out[0] = pixels[i].r;
      out[1] = pixels[i].g;
      out[2] = pixels[i].b;
    }
  });
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  PngJob& job = *static_cast<PngJob*>(png_get_error_ptr(png));
  try {
    job.error = message;
  } catch (...) {  // without memory the error stays without words
  }
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep data, std::size_t size) {
  PngJob& job = *static_cast<PngJob*>(png_get_io_ptr(png));
  bool is_written = false;
  try {
    job.bytes.append(reinterpret_cast<const char*>(data), size);
    is_written = true;
  } catch (...) {  // no exception may pass through C
  }
  if (!is_written) png_error(png, "out of memory");
}

void on_flush(png_structp) {}

// False if libpng jumped out by longjmp. Has no objects to destroy, so nothing leaks.
bool write(png_structp png, png_infop info, PngJob& job) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, &job, on_write, on_flush);
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
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), job.compressed.data(),
                  job.compressed.size());
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
  return true;
}

void run(PngJob& job) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  const bool is_written = info != nullptr && write(png, info, job);
  png_destroy_write_struct(&png, &info);
  if (!is_written) throw std::runtime_error("writing PNG failed: " + job.error);
}

}  // namespace

PngEncoder::PngEncoder() : job_(std::make_unique<PngJob>()) {}
PngEncoder::~PngEncoder() = default;
PngEncoder::PngEncoder(PngEncoder&&) noexcept = default;
PngEncoder& PngEncoder::operator=(PngEncoder&&) noexcept = default;

std::string PngEncoder::encode(const Picture& picture) {
  if (picture.width < 1 || picture.height < 1) {
    throw std::runtime_error("writing PNG failed: the picture has no pixels");
  }
  PngJob& job = *job_;
  job.width = picture.width;
  job.height = picture.height;
  job.bytes.clear();
  if (picture.is_indexed()) {
    take_indices(picture, job);
  } else {
    take_colours(picture, job);
  }
  job.compressed = job.deflater.compress(job.rows);
  run(job);
  return std::move(job.bytes);
}

Picture decode_png(std::string_view bytes) {
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
