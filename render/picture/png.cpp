#include "render/picture/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/mask/mask.h"
#include "render/picture/run_deflater.h"

namespace trapeze {
namespace {

constexpr std::size_t kMaxColours = 256;

// The palette as it is stored: translucent colours first, so that tRNS ends with the last of them.
struct StoredPalette {
  std::vector<png_color> colours;
  std::vector<png_byte> opacities;     // of the first colours; the others are opaque
  std::vector<std::uint8_t> index_of;  // stored index for each colour of the picture
  int bits = 8;                        // per pixel
};

StoredPalette pack_palette(const RunPicture& picture) {
  StoredPalette stored;
  stored.index_of.resize(picture.colours.size());
  for (const bool opaque : {false, true}) {
    for (std::size_t i = 0; i < picture.colours.size(); ++i) {
      const Rgba colour = picture.colours[i];
      if ((colour.a == 255) != opaque) continue;
      stored.index_of[i] = static_cast<std::uint8_t>(stored.colours.size());
      stored.colours.push_back({colour.r, colour.g, colour.b});
      if (!opaque) stored.opacities.push_back(colour.a);
    }
  }
  const std::size_t count = stored.colours.size();
  stored.bits = count <= 2 ? 1 : count <= 4 ? 2 : count <= 16 ? 4 : 8;
  return stored;
}

/// Packs runs of indices into bytes, with the first pixel in the highest bits of a byte. Takes time
/// in proportion to the runs, not to the pixels.
class BitPacker {
 public:
  /// Appends to `runs`; `bits` per pixel: 1, 2 or 4.
  BitPacker(int bits, std::vector<PixelRun>& runs) : bits_(bits), runs_(runs) {}

  void add(std::uint32_t pixels, unsigned index) {
    for (; pixels > 0 && filled_ > 0; --pixels) add_pixel(index);
    const std::uint32_t per_byte = 8 / static_cast<std::uint32_t>(bits_);
    const unsigned index_everywhere = index * (0xff / ((1u << bits_) - 1));
    if (pixels >= per_byte) append(pixels / per_byte, index_everywhere);
    for (pixels %= per_byte; pixels > 0; --pixels) add_pixel(index);
  }
  /// Completes the last byte of the row with zeros.
  void finish() {
    while (filled_ > 0) add_pixel(0);
  }

 private:
  void add_pixel(unsigned index) {
    byte_ = byte_ << bits_ | index;
    filled_ += bits_;
    if (filled_ < 8) return;
    append(1, byte_);
    byte_ = 0;
    filled_ = 0;
  }
  void append(std::uint32_t bytes, unsigned byte) {
    end_ += bytes;
    if (!runs_.empty() && runs_.back().pixel == byte) {
      runs_.back().end = end_;
    } else {
      runs_.push_back({end_, byte});
    }
  }

  int bits_;
  std::vector<PixelRun>& runs_;
  std::uint32_t end_ = 0;  // bytes so far
  unsigned byte_ = 0;      // being filled
  int filled_ = 0;         // bits of it
};

}  // namespace

// Everything that libpng is to write, prepared in advance: no object with a destructor may be
// created where libpng may return by longjmp.
struct PngJob {
  int width = 0;
  int height = 0;
  int bits = 8;
  int colour_type = PNG_COLOR_TYPE_PALETTE;
  StoredPalette palette;
  RunDeflater deflater;
  std::vector<PixelRun> row;                 // input of the deflater
  std::span<const std::uint8_t> compressed;  // output of the deflater

  std::string bytes;  // the result
  std::string error;
};

namespace {

/// Passes the rows of the picture to the deflater, with colours converted to pixels by pixel_of.
template <typename PixelOf>
void deflate_rows(const RunPicture& picture, std::uint32_t bytes_per_pixel, PngJob& job,
                  const PixelOf& pixel_of) {
  job.deflater.begin(static_cast<std::uint32_t>(picture.width), bytes_per_pixel);
  for (int row = 0; row < picture.height; ++row) {
    job.row.clear();
    for (const Run& run : picture.row(row)) job.row.push_back({run.end, pixel_of(run.colour)});
    job.deflater.add_row(job.row);
  }
}

/// The same for indices that share bytes.
void deflate_packed_rows(const RunPicture& picture, PngJob& job) {
  const auto bits_of_row = static_cast<std::uint32_t>(picture.width * job.bits);
  job.deflater.begin((bits_of_row + 7) / 8, 1);
  for (int row = 0; row < picture.height; ++row) {
    job.row.clear();
    BitPacker packer(job.bits, job.row);
    std::uint32_t begin = 0;
    for (const Run& run : picture.row(row)) {
      packer.add(run.end - begin, job.palette.index_of[run.colour]);
      begin = run.end;
    }
    packer.finish();
    job.deflater.add_row(job.row);
  }
}

void deflate_indices(const RunPicture& picture, PngJob& job) {
  job.palette = pack_palette(picture);
  job.bits = job.palette.bits;
  job.colour_type = PNG_COLOR_TYPE_PALETTE;
  if (job.bits < 8) return deflate_packed_rows(picture, job);
  deflate_rows(picture, 1, job, [&job](std::uint32_t colour) -> std::uint32_t {
    return job.palette.index_of[colour];
  });
}

void deflate_colours(const RunPicture& picture, PngJob& job) {
  const bool is_opaque =
      std::ranges::all_of(picture.colours, [](Rgba colour) { return colour.a == 255; });
  job.bits = 8;
  job.colour_type = is_opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA;
  deflate_rows(picture, is_opaque ? 3 : 4, job, [&picture](std::uint32_t number) {
    const Rgba colour = picture.colours[number];
    return std::uint32_t{colour.r} | std::uint32_t{colour.g} << 8 | std::uint32_t{colour.b} << 16 |
           std::uint32_t{colour.a} << 24;
  });
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  PngJob& job = *static_cast<PngJob*>(png_get_error_ptr(png));
  try {
    job.error = message;
  } catch (...) {  // out of memory: the error has no message
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
  } catch (...) {  // exceptions must not pass through C code
  }
  if (!is_written) png_error(png, "out of memory");
}

void on_flush(png_structp) {}

// False if libpng returned by longjmp. Has no objects to destroy, so nothing leaks.
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

std::string PngEncoder::encode(const RunPicture& picture) {
  if (picture.width < 1 || picture.height < 1) {
    throw std::runtime_error("writing PNG failed: the picture has no pixels");
  }
  PngJob& job = *job_;
  job.width = picture.width;
  job.height = picture.height;
  job.bytes.clear();
  if (picture.colours.size() <= kMaxColours) {
    deflate_indices(picture, job);
  } else {
    deflate_colours(picture, job);
  }
  job.compressed = job.deflater.finish();
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
  Picture picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  static_assert(sizeof(Rgba) == 4, "libpng writes four bytes a pixel");
  picture.pixels.resize(std::size_t{image.width} * image.height);
  if (png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr) == 0) fail();
  return picture;
}

}  // namespace trapeze
