#include "render/mask/stroke.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

constexpr double kMiterLimit = 4;
constexpr std::uint16_t kMostMet = 3;  // a greater number makes no difference
// Lines extend beyond their ends by this many pixels, so that joins with smaller openings need no
// drawing.
constexpr double kOverlap = 1.0 / 32;
constexpr double kMergedParts = 32;  // of a pixel: the grid for the ends of merged lines
// Half of the line width from which on the nearest edge is found for all pixels.
constexpr double kLeastHalfOfNearest = 2;
// Dash patterns that repeat within fewer pixels look like a tint.
constexpr double kLeastPeriod = 1.0 / 8;
constexpr double kLeastRate = 1.0 / 16;  // of the growth of a dashed line
constexpr int kBlock = 4;                // columns drawn at the same time
constexpr std::size_t kMostBandPixels = std::size_t{1} << 20;
// From this value on, it makes no difference what several lines cover together.
constexpr std::uint8_t kNearlyFull = 240;

// Adjacent pixels, using the vector extensions of g++ and clang.
using Floats __attribute__((vector_size(kBlock * sizeof(float)))) = float;
using Ints __attribute__((vector_size(kBlock * sizeof(std::int32_t)))) = std::int32_t;
using Shorts __attribute__((vector_size(kBlock * sizeof(std::int16_t)))) = std::int16_t;
using Bytes __attribute__((vector_size(kBlock))) = std::uint8_t;

constexpr Floats kSteps{0, 1, 2, 3};

std::uint8_t to_value(float share) {
  return static_cast<std::uint8_t>(share * 255 + 0.5f);
}

struct Columns {
  int begin;
  int end;

  bool is_empty() const { return begin == end; }
};

/// The columns whose centres are between two positions, within a picture.
Columns columns_between(double min, double max, int width) {
  const double first = std::min(std::max(min - 0.5, 0.0), static_cast<double>(width));
  const double last = std::min(std::max(max - 0.5, -1.0), static_cast<double>(width - 1));
  const int begin = static_cast<int>(first) + (first > static_cast<int>(first) ? 1 : 0);
  const int end = last < 0 ? 0 : static_cast<int>(last) + 1;
  return {begin, std::max(begin, end)};
}

/// Solves from <= factor * x + offset <= to for x.
struct Slab {
  double inverse = 0;  // of the factor; 0 if that is 0
  double from = 0;
  double to = 0;

  Slab(double factor, double slab_from, double slab_to)
      : inverse(std::abs(factor) < 1e-12 ? 0 : 1 / factor), from(slab_from), to(slab_to) {}

  void narrow(double offset, double& min, double& max) const {
    if (inverse == 0) {
      if (offset < from || offset > to) max = min - 1;
      return;
    }
    const double a = (from - offset) * inverse;
    const double b = (to - offset) * inverse;
    min = std::max(min, std::min(a, b));
    max = std::min(max, std::max(a, b));
  }
};

int rows_of_band(int width) {
  return std::max(1, static_cast<int>(kMostBandPixels / static_cast<std::size_t>(width)));
}

/// Identifies a place, except for a probability of 2^-64 for each pair of places.
std::uint64_t number_of(const PicturePlace& place) {
  const auto x = std::bit_cast<std::uint64_t>(place.x);
  const auto y = std::bit_cast<std::uint64_t>(place.y);
  const std::uint64_t mixed = (x ^ (x >> 29)) * 0xbf58476d1ce4e5b9u + y;
  return (mixed ^ (mixed >> 32)) * 0x94d049bb133111ebu;
}

}  // namespace

bool Stroke::is_dashed() const {
  for (std::size_t i = 1; i < dashes.size(); i += 2) {
    if (dashes[i] > 0) return true;
  }
  return false;
}

double Stroke::ink_of_ring(double extent) const {
  return extent < kFullExtent * width ? extent / (kFullExtent * width) : 1;
}

double Stroke::reach(double scale) const {
  const double half = width * scale / 2;
  return (join == LineJoin::miter ? kMiterLimit * half : half) + 0.5;
}

std::uint64_t Stroke::most_values(std::uint64_t edges, const View& view, double scale) const {
  const double pixels = static_cast<double>(view.width) * view.height;
  // A line as long as it is wide, and a join at each end.
  const auto around_edges = [edges](double half) {
    return static_cast<double>(edges) * 3 * (2 * half + 1) * (2 * half + 1);
  };
  const double half = width * scale / 2;
  const double nearest = 2 * static_cast<double>(Stroker::kCrowd) * pixels;
  const double most = std::max(nearest, around_edges(kLeastHalfOfNearest));
  return static_cast<std::uint64_t>(std::min(around_edges(half), most));
}

Stroker::Line Stroker::Line::turned() const {
  return {to, from, -dx, -dy, length, along + length * rate, -rate, ink};
}

Stroker::Line Stroker::Line::between(PicturePlace new_from, PicturePlace new_to) const {
  const double x = new_to.x - new_from.x;
  const double y = new_to.y - new_from.y;
  const double new_length = std::sqrt(x * x + y * y);
  return {new_from, new_to, x / new_length, y / new_length, new_length, along, rate, ink};
}

// A line's width and dashes, in pixels of one picture.
class Stroker::Pen {
 public:
  Pen(const Stroke& stroke, double scale, const std::vector<Line>& lines, Canvas& canvas,
      SharedPixels& shared, std::vector<std::uint8_t>& directions)
      : half_(stroke.width * scale / 2),
        most_(std::min(1.0f, static_cast<float>(2 * half_))),
        join_(stroke.join),
        lines_(lines),
        canvas_(canvas),
        shared_(shared),
        directions_(directions),
        band_{0, canvas.height()} {
    if (!stroke.is_dashed()) return;
    for (std::size_t i = 0; i + 1 < stroke.dashes.size(); i += 2) {
      const Dash dash{period_, stroke.dashes[i] * scale};
      dashes_.push_back(dash);
      dashes_of_blocks_.push_back(
          {in_block(static_cast<float>(dash.begin)), in_block(static_cast<float>(dash.length))});
      period_ += (stroke.dashes[i] + stroke.dashes[i + 1]) * scale;
      inked_ += stroke.dashes[i] * scale;
    }
    period_of_blocks_ = in_block(static_cast<float>(period_));
    periods_per_pixel_ = in_block(static_cast<float>(1 / period_));
    inked_of_blocks_ = in_block(static_cast<float>(inked_));
  }

  double half() const { return half_; }
  double reach() const { return half_ + 0.5; }
  bool has_round_ends() const { return join_ == LineJoin::round; }
  std::uint64_t values() const { return values_; }
  // What is drawn from now on is cut to these rows.
  void begin_band(Rows band) { band_ = band; }

  // With round ends, so that lines that meet need no join.
  void draw_round_line(std::uint32_t number) {
    const Line& line = lines_[number];
    const auto [west, east] = std::minmax(line.from.x, line.to.x);
    const auto [north, south] = std::minmax(line.from.y, line.to.y);
    const Rows rows = rows_between(north - reach(), south + reach());
    const Columns columns = columns_between(west - reach(), east + reach(), canvas_.width());
    if (rows.begin >= rows.end || columns.is_empty()) return;
    note_direction(number);
    const RoundLine round(number, *this);
    if (columns.end - columns.begin <= 2 * kBlock) {
      const Blocks blocks(columns, canvas_);
      for (int row = rows.begin; row < rows.end; ++row) draw_round_row(round, row, blocks);
      return;
    }
    const Slab near(line.dy, -reach(), reach());
    for (int row = rows.begin; row < rows.end; ++row) {
      double min = columns.begin - line.from.x;
      double max = columns.end - line.from.x;
      near.narrow(-(row + 0.5 - line.from.y) * line.dx, min, max);
      if (min > max) continue;
      const Columns near_columns =
          columns_between(min + line.from.x, max + line.from.x, canvas_.width());
      if (!near_columns.is_empty()) draw_round_row(round, row, Blocks(near_columns, canvas_));
    }
  }

  // The ends are cut off at right angles.
  void draw_line(std::uint32_t number) {
    const Line& line = lines_[number];
    const double top = std::min(line.from.y, line.to.y) - reach();
    const double bottom = std::max(line.from.y, line.to.y) + reach();
    const Rows rows = rows_between(top, bottom);
    note_direction(number);
    const Slab beside(line.dx, -kOverlap, line.length + kOverlap);
    const Slab near(line.dy, -reach(), reach());
    for (int row = rows.begin; row < rows.end; ++row) {
      const double y = row + 0.5 - line.from.y;
      double min = -line.from.x;
      double max = canvas_.width() - line.from.x;
      beside.narrow(y * line.dy, min, max);
      near.narrow(-y * line.dx, min, max);
      if (min <= max) draw_row(number, row, y, min + line.from.x, max + line.from.x);
    }
  }

  // A round dot at the beginning of a line to which nothing or too much is joined.
  void draw_dot(const Line& line) {
    const float ink = line.ink * dash_share(line, 0);
    for_each_pixel_around(line.from, reach(), [&](double x, double y) {
      return ink * across(static_cast<float>(std::sqrt(x * x + y * y)));
    });
  }

  // Between `in`, which ends there, and `out`, which begins there.
  void draw_join(const Line& in, const Line& out) {
    const double cosine = std::clamp(in.dx * out.dx + in.dy * out.dy, -1.0, 1.0);
    const double opening = std::abs(in.dx * out.dy - in.dy * out.dx) * reach();
    if (cosine > 0 && opening < kOverlap) return;
    const double half_cosine = std::sqrt((1 + cosine) / 2);  // of half the turn
    const LineJoin join =
        join_ == LineJoin::miter && half_cosine * kMiterLimit < 1 ? LineJoin::bevel : join_;
    const double radius = join == LineJoin::miter ? half_ / half_cosine + 0.5 : reach();
    const float ink = std::max(in.ink, out.ink) * dash_share(out, 0);
    for_each_pixel_around(out.from, radius, [&](double x, double y) {
      const bool is_beside_a_line = x * in.dx + y * in.dy < 0 || x * out.dx + y * out.dy > 0;
      if (is_beside_a_line) return 0.0f;
      return ink * across(static_cast<float>(distance(join, in, out, half_cosine, x, y)));
    });
  }

  // The share of a pixel at that distance from the middle of the line that is covered by the line;
  // at most the width of a line thinner than a pixel.
  float across(float distance) const {
    return std::min(std::max(static_cast<float>(reach()) - distance, 0.0f), most_);
  }

  // The share of a pixel, at that distance along the line, that is covered by dashes.
  float dash_share(const Line& line, double distance) const {
    if (dashes_.empty()) return 1;
    if (period_ < kLeastPeriod) return static_cast<float>(inked_ / period_);
    const double along = line.along + distance * line.rate;
    const double half_pixel = half_pixel_along(line);
    return static_cast<float>((inked_up_to(along + half_pixel) - inked_up_to(along - half_pixel)) /
                              (2 * half_pixel));
  }

 private:
  struct Dash {
    double begin;
    double length;
  };
  struct DashOfBlocks {
    Floats begin;
    Floats length;
  };

  static Floats in_block(float number) { return Floats{} + number; }

  Rows rows_between(double min, double max) const {
    const Columns rows = columns_between(min, max, canvas_.height());
    return {std::max(rows.begin, band_.begin), std::min(rows.end, band_.end)};
  }
  std::size_t place_of(int row, int column) const {
    return static_cast<std::size_t>(row - band_.begin) * static_cast<std::size_t>(canvas_.width()) +
           static_cast<std::size_t>(column);
  }

  static double half_pixel_along(const Line& line) {
    return std::max(std::abs(line.rate), kLeastRate) / 2;
  }

  // The total length of dashes from the beginning of the outline up to a position along it.
  double inked_up_to(double along) const {
    const double periods = std::floor(along / period_);
    const double rest = along - periods * period_;
    double inked = periods * inked_;
    for (const Dash& dash : dashes_)
      inked += std::min(std::max(rest - dash.begin, 0.0), dash.length);
    return inked;
  }

  // The distance of a nearby place from a vertex, as defined by the join.
  double distance(LineJoin join, const Line& in, const Line& out, double half_cosine, double x,
                  double y) const {
    if (join == LineJoin::miter) {
      return std::max(std::abs(x * in.dy - y * in.dx), std::abs(x * out.dy - y * out.dx));
    }
    const double bisector_x = in.dx - out.dx;
    const double bisector_y = in.dy - out.dy;
    const double length = std::sqrt(bisector_x * bisector_x + bisector_y * bisector_y);
    if (length == 0) return std::sqrt(x * x + y * y);
    return (x * bisector_x + y * bisector_y) / length + half_ * (1 - half_cosine);
  }

  // A line with round ends, with values that are the same for all blocks of pixels.
  struct RoundLine {
    RoundLine(std::uint32_t of, const Pen& pen)
        : number(of),
          line(pen.lines_[of]),
          steps_along(kSteps * static_cast<float>(line.dx)),
          steps_off(kSteps * static_cast<float>(line.dy)),
          reach(in_block(static_cast<float>(pen.reach()))),
          most(in_block(pen.most_)),
          ink_255(in_block(line.ink * 255)),
          rate(in_block(static_cast<float>(line.rate))),
          half_pixel(in_block(static_cast<float>(half_pixel_along(line)))) {}

    std::uint32_t number;
    const Line& line;
    Floats steps_along;
    Floats steps_off;
    Floats reach;
    Floats most;
    Floats ink_255;
    // For dashes.
    Floats rate;
    Floats half_pixel;
  };
  // How far pixels of a block are before the line and behind it; negative if they are not.
  struct Beyond {
    Floats before;
    Floats behind;
  };

  // The columns to draw, at least one. Pixels away from the line get 0, so whole blocks can be
  // drawn, wherever they begin; the last block may also write beyond the columns.
  struct Blocks {
    Blocks(Columns of, const Canvas& canvas)
        : columns(of),
          last(std::max(canvas.width() - kBlock, 0)),
          touched(canvas.touched(std::min(of.begin, last),
                                 std::min(of.end + kBlock, canvas.width()))) {}

    Columns columns;
    int last;  // last column where a block may begin
    std::uint64_t touched;
  };

  void draw_round_row(const RoundLine& round, int row, const Blocks& blocks) {
    const Columns columns = blocks.columns;
    values_ += static_cast<std::uint64_t>(columns.end - columns.begin);
    const Line& line = round.line;
    const double y = row + 0.5 - line.from.y;
    const double along_of_row = y * line.dy;
    const double beside_of_row = y * line.dx;
    std::uint8_t* const out = canvas_.row(row, blocks.touched);
    for (int block = columns.begin; block < columns.end; block += kBlock) {
      const int begin = std::min(block, blocks.last);
      const double x = begin + 0.5 - line.from.x;
      // The position of the first pixel along the line.
      const double along = x * line.dx + along_of_row;
      const Beyond beyond{static_cast<float>(-along) - round.steps_along,
                          static_cast<float>(along - line.length) + round.steps_along};
      Floats values = values_of_block(round, beyond, beside_of_row - x * line.dy);
      if (are_none(values)) continue;
      if (!dashes_.empty()) values *= dash_shares(round, along, beyond);
      constexpr Floats kNone{};
      Ints may_share{};
      if (dashes_.empty()) may_share = (beyond.before <= kNone) & (beyond.behind <= kNone);
      cover(values, may_share, round.number, row, begin, out + begin);
    }
  }

  // For adjacent pixels, the first of which has that distance from the line; up to 255.
  static Floats values_of_block(const RoundLine& round, const Beyond& beyond, double beside) {
    constexpr Floats kNone{};
    const Floats outside = beyond.before > beyond.behind ? beyond.before : beyond.behind;
    const Floats from_end = outside > kNone ? outside : kNone;
    const Floats off = static_cast<float>(beside) - round.steps_off;
    const Floats covered = round.reach - root_of(off * off + from_end * from_end);
    const Floats share = covered > kNone ? covered : kNone;
    return round.ink_255 * (share < round.most ? share : round.most);
  }

  // For values that are not negative, or masks.
  template <typename Block>
  static bool are_none(const Block& values) {
    std::uint64_t bits[2];
    static_assert(sizeof bits == sizeof values);
    std::memcpy(bits, &values, sizeof values);
    return (bits[0] | bits[1]) == 0;
  }

  static Floats root_of(Floats squares) {
    Floats roots;
    for (int i = 0; i < kBlock; ++i) roots[i] = std::sqrt(squares[i]);
    return roots;
  }

  // The same as dash_share(), for adjacent pixels, the first of which is at that position along the
  // line.
  Floats dash_shares(const RoundLine& round, double along, const Beyond& beyond) const {
    constexpr Floats kNone{};
    if (period_ < kLeastPeriod) return kNone + static_cast<float>(inked_ / period_);
    // Counted from the period that contains the first pixel, numbers stay small.
    const double place = round.line.along + along * round.line.rate;
    const double first = place - std::floor(place / period_) * period_;
    const Floats on_line = round.steps_along + (beyond.before > kNone ? beyond.before : kNone) -
                           (beyond.behind > kNone ? beyond.behind : kNone);
    const Floats places = static_cast<float>(first) + on_line * round.rate;
    return (inked_up_to(places + round.half_pixel) - inked_up_to(places - round.half_pixel)) /
           (2.0f * round.half_pixel);
  }

  Floats inked_up_to(Floats along) const {
    const Floats quotient = along * periods_per_pixel_;
    const Floats towards_zero =
        __builtin_convertvector(__builtin_convertvector(quotient, Ints), Floats);
    const Floats periods = towards_zero > quotient ? towards_zero - 1.0f : towards_zero;
    const Floats rest = along - periods * period_of_blocks_;
    Floats inked = periods * inked_of_blocks_;
    for (const DashOfBlocks& dash : dashes_of_blocks_) {
      const Floats begun = rest - dash.begin;
      const Floats part = begun > Floats{} ? begun : Floats{};
      inked += part < dash.length ? part : dash.length;
    }
    return inked;
  }

  // Adjacent pixels of a row, from a column on, and which of them may be shared with other lines:
  // those beside the line, not beyond its ends, as the next line of an outline covers those. Dashes
  // are not shared.
  void cover(Floats values, Ints may_share, std::uint32_t number, int row, int column,
             std::uint8_t* out) {
    const auto rounded = __builtin_convertvector(values + 0.5f, Ints);
    const auto narrow = __builtin_convertvector(rounded, Shorts);
    const auto bytes = __builtin_convertvector(narrow, Bytes);
    if (canvas_.width() < kBlock) {
      for (int i = 0; i < canvas_.width(); ++i) {
        cover(bytes[i], may_share[i] != 0, number, row, column + i, out[i]);
      }
      return;
    }
    Bytes before{};
    std::memcpy(&before, out, sizeof before);
    const Bytes greater = bytes > before ? bytes : before;
    std::memcpy(out, &greater, sizeof greater);
    const Ints is_covered = may_share & (rounded > 0);
    if (are_none(is_covered)) return;
    std::uint32_t* const known = shared_.known() + place_of(row, column);
    Ints numbers{};
    std::memcpy(&numbers, known, sizeof numbers);
    const Ints is_first = is_covered & (numbers == 0);
    numbers |= is_first & static_cast<std::int32_t>(number + 1);
    std::memcpy(known, &numbers, sizeof numbers);
    const Ints is_another = is_covered & ~is_first;
    if (are_none(is_another)) return;
    for (int i = 0; i < kBlock; ++i) {
      if (is_another[i] != 0) share(number, row, column + i, out[i]);
    }
  }

  // The same for one pixel.
  void cover(std::uint8_t value, bool may_share, std::uint32_t number, int row, int column,
             std::uint8_t& out) {
    out = std::max(out, value);
    if (value == 0 || !may_share) return;
    std::uint32_t& known = shared_.known()[place_of(row, column)];
    if (known == 0) {
      known = number + 1;
    } else {
      share(number, row, column, out);
    }
  }

  // A pixel that another line covers already.
  void share(std::uint32_t number, int row, int column, std::uint8_t value) {
    if (value >= kNearlyFull) return;
    const double x = column + 0.5;
    const double y = row + 0.5;
    shared_.add(
        place_of(row, column), number + 1,
        [&](std::uint32_t known) { return samples(known - 1, x, y); },
        [&](std::uint32_t known) { return to_value(lines_[known - 1].ink); });
  }

  void note_direction(std::uint32_t number) {
    const Line& line = lines_[number];
    directions_[number] = static_cast<std::uint8_t>(HalfPlanes::direction_of(line.dx, line.dy));
  }

  std::uint64_t samples(std::uint32_t number, double x, double y) const {
    const Line& line = lines_[number];
    const SampledLine sampled{static_cast<float>(line.from.x - x),
                              static_cast<float>(line.from.y - y),
                              static_cast<float>(line.dx),
                              static_cast<float>(line.dy),
                              directions_[number],
                              static_cast<float>(line.length),
                              static_cast<float>(half_),
                              has_round_ends()};
    return sampled.samples(half_planes_);
  }

  void draw_row(std::uint32_t number, int row, double y, double west, double east) {
    const Line& line = lines_[number];
    const Columns columns = columns_between(west, east, canvas_.width());
    values_ += static_cast<std::uint64_t>(columns.end - columns.begin);
    if (columns.is_empty()) return;
    std::uint8_t* out = canvas_.row(row, columns.begin, columns.end);
    const double x = columns.begin + 0.5 - line.from.x;
    const auto offset = static_cast<float>(x * line.dy - y * line.dx);
    const auto step = static_cast<float>(line.dy);
    for (int column = columns.begin; column < columns.end; ++column) {
      const int i = column - columns.begin;
      float share = line.ink * across(std::abs(offset + static_cast<float>(i) * step));
      if (!dashes_.empty()) share *= dash_share(line, (x + i) * line.dx + y * line.dy);
      cover(to_value(share), dashes_.empty(), number, row, column, out[column]);
    }
  }

  template <typename ShareAt>
  void for_each_pixel_around(PicturePlace centre, double radius, const ShareAt& share_at) {
    const Rows rows = rows_between(centre.y - radius, centre.y + radius);
    const Columns columns = columns_between(centre.x - radius, centre.x + radius, canvas_.width());
    if (rows.begin >= rows.end || columns.is_empty()) return;
    values_ += static_cast<std::uint64_t>(rows.end - rows.begin) *
               static_cast<std::uint64_t>(columns.end - columns.begin);
    for (int row = rows.begin; row < rows.end; ++row) {
      std::uint8_t* out = canvas_.row(row, columns.begin, columns.end);
      for (int column = columns.begin; column < columns.end; ++column) {
        const float share = share_at(column + 0.5 - centre.x, row + 0.5 - centre.y);
        out[column] = std::max(out[column], to_value(share));
      }
    }
  }

  const double half_;
  const float most_;  // maximum coverage of a pixel by the line
  const LineJoin join_;
  std::vector<Dash> dashes_;  // of one period; empty: no gaps
  double period_ = 0;
  double inked_ = 0;  // total length of dashes in a period
  // The same for blocks of pixels.
  std::vector<DashOfBlocks> dashes_of_blocks_;
  Floats period_of_blocks_{};
  Floats periods_per_pixel_{};
  Floats inked_of_blocks_{};
  const std::vector<Line>& lines_;
  Canvas& canvas_;
  SharedPixels& shared_;
  std::vector<std::uint8_t>& directions_;  // of lines, numbers of HalfPlanes
  const HalfPlanes& half_planes_ = HalfPlanes::table();
  Rows band_;
  std::uint64_t values_ = 0;  // computed so far
};

void Stroker::begin(const View& view, double scale) {
  view_ = view;
  scale_ = scale;
  canvas_.begin(view.width, view.height);
  lines_.clear();
  ends_.clear();
  vertices_ = 0;
  length_of_lines_ = 0;
}

void Stroker::finish(Mask& mask) {
  canvas_.finish(mask);
}

void Stroker::draw(const Stroke& stroke, const Cancellation* cancellation) {
  Pen pen(stroke, scale_, lines_, canvas_, shared_, directions_);
  const double most = static_cast<double>(kCrowd) * view_.width * view_.height;
  const bool is_crowded = most_values_of_lines(pen) > most && values_of_lines(pen) > most;
  // Drawn one by one, lines with round ends may be in any order.
  if (is_crowded || !pen.has_round_ends()) sort_lines();
  if (is_crowded) merge_lines();
  if (cancellation != nullptr) cancellation->check();
  if (is_crowded && pen.half() >= kLeastHalfOfNearest && values_of_lines(pen) > most) {
    draw_nearest(pen, cancellation);
  } else {
    draw_each(pen, cancellation);
  }
}

void Stroker::add(std::span<const Point> vertices, std::span<const OutlineEdge> edges) {
  const double columns_per_cell = 1 / view_.cells_per_pixel;
  const double rows_per_cell = 1 / view_.cells_per_row();
  const auto place_of = [&](std::uint32_t vertex) {
    const Point p = vertices[vertex];
    return PicturePlace{
        static_cast<double>(p.x - view_.origin_x) * columns_per_cell,
        static_cast<double>(p.y - view_.origin_y) * rows_per_cell - view_.first_row};
  };
  for (const OutlineEdge& edge : edges) {
    const Line line{
        {}, {}, 0, 0, 0, edge.along * columns_per_cell, edge.rate, static_cast<float>(edge.ink)};
    lines_.push_back(line.between(place_of(edge.from), place_of(edge.to)));
    if (view_.stretch != 1) {  // `along` is in cells, whose number per pixel varies here
      const Point from = vertices[edge.from];
      const Point to = vertices[edge.to];
      const double cells =
          std::hypot(static_cast<double>(to.x) - from.x, static_cast<double>(to.y) - from.y);
      lines_.back().rate *= cells * columns_per_cell / lines_.back().length;
    }
    ends_.push_back({vertices_ + edge.from, vertices_ + edge.to});
    length_of_lines_ += lines_.back().length;
  }
  vertices_ += vertices.size();
}

void Stroker::sort_lines() {
  std::vector<std::uint32_t> order(lines_.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [this](std::uint32_t i) {
    const Line& line = lines_[i];
    return std::tuple(line.from.y, line.from.x, line.to.y, line.to.x, line.ink, line.along,
                      line.rate);
  });
  std::vector<Line> lines;
  std::vector<Ends> ends;
  for (const std::uint32_t i : order) {
    lines.push_back(lines_[i]);
    ends.push_back(ends_[i]);
  }
  lines_.swap(lines);
  ends_.swap(ends);
}

// At least as many as values_of_lines().
double Stroker::most_values_of_lines(const Pen& pen) const {
  const double across = 2 * pen.reach();
  return across * (length_of_lines_ + across * static_cast<double>(lines_.size()));
}

// About as many as draw_each() would compute.
double Stroker::values_of_lines(const Pen& pen) const {
  const double across = 2 * pen.reach();
  const double longest = static_cast<double>(view_.width) + view_.height;
  double values = 0;
  for (const Line& line : lines_) {
    const auto [west, east] = std::minmax(line.from.x, line.to.x);
    const auto [north, south] = std::minmax(line.from.y, line.to.y);
    const bool is_seen = east > -pen.reach() && west < view_.width + pen.reach() &&
                         south > -pen.reach() && north < view_.height + pen.reach();
    // Along the line, and around its beginning.
    if (is_seen) values += across * (std::min(line.length, longest) + across);
  }
  return values;
}

// Snaps the ends to a grid, which is not visible. Lines without length are removed, and among equal
// lines only the first one with the most ink is kept.
void Stroker::merge_lines() {
  const auto moved = [](PicturePlace place) {
    // Adding 0 removes negative zeros, whose bits are different.
    return PicturePlace{std::round(place.x * kMergedParts) / kMergedParts + 0.0,
                        std::round(place.y * kMergedParts) / kMergedParts + 0.0};
  };
  // The key of a line, the order among equal lines, and the line.
  std::vector<std::tuple<std::uint64_t, float, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    lines_[i] = line.between(moved(line.from), moved(line.to));
    ends_[i] = {number_of(line.from), number_of(line.to)};
    if (ends_[i].from != ends_[i].to) {
      order.emplace_back(ends_[i].from + ends_[i].to, -line.ink, i);
    }
  }
  std::ranges::sort(order);
  const auto is_same = [](const auto& a, const auto& b) {
    return std::get<0>(a) == std::get<0>(b);
  };
  order.erase(std::unique(order.begin(), order.end(), is_same), order.end());
  const auto line_of = [](const auto& item) { return std::get<2>(item); };
  std::ranges::sort(order, {}, line_of);
  for (std::size_t i = 0; i < order.size(); ++i) {
    lines_[i] = lines_[line_of(order[i])];
    ends_[i] = ends_[line_of(order[i])];
  }
  lines_.resize(order.size());
  ends_.resize(order.size());
}

// In bands of rows, to bound memory.
void Stroker::draw_each(Pen& pen, const Cancellation* cancellation) {
  CancellationCheck check(cancellation, 64);
  directions_.resize(lines_.size());
  const int most_rows = std::min(rows_of_band(canvas_.width()), canvas_.height());
  for (int first = 0; first < canvas_.height(); first += most_rows) {
    const Rows band{first, std::min(first + most_rows, canvas_.height())};
    shared_.begin(static_cast<std::size_t>(most_rows) * static_cast<std::size_t>(canvas_.width()));
    pen.begin_band(band);
    draw_band(pen, check);
    darken_shared(band);
  }
  values_ = pen.values();
}

void Stroker::draw_band(Pen& pen, CancellationCheck& check) {
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    check();
    if (pen.has_round_ends()) {
      pen.draw_round_line(i);
    } else {
      pen.draw_line(i);
    }
  }
  if (!pen.has_round_ends()) join_lines(pen, check);
}

// Applies what several lines cover together.
void Stroker::darken_shared(Rows band) {
  const auto width = static_cast<std::size_t>(canvas_.width());
  shared_.for_each([&](std::size_t place, std::uint8_t value) {
    const int column = static_cast<int>(place % width);
    std::uint8_t& out =
        canvas_.row(band.begin + static_cast<int>(place / width), column, column + 1)[column];
    if (out < kNearlyFull) out = std::max(out, value);
  });
  for (int row = band.begin; row < band.end; ++row) {
    canvas_.for_each_written(row, [&](std::size_t begin, std::size_t end) {
      const std::size_t first = static_cast<std::size_t>(row - band.begin) * width;
      shared_.forget(first + begin, first + end);
    });
  }
  shared_.finish();
}

void Stroker::join_lines(Pen& pen, CancellationCheck& check) {
  meet_.assign(std::bit_ceil(3 * lines_.size() + 1), Meeting());
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    check();
    meet(ends_[i].from, i, false, pen);
    meet(ends_[i].to, i, true, pen);
  }
  for (const Meeting& meeting : meet_) {
    if (meeting.count != 1) continue;
    check();
    pen.draw_dot(leaving(meeting.line, meeting.is_end));
  }
}

// Two lines that meet are joined; where more than two meet, rings touch.
void Stroker::meet(std::uint64_t place, std::uint32_t line, bool is_end, Pen& pen) {
  std::size_t i = (place * 0x9e3779b97f4a7c15u) >> 32 & (meet_.size() - 1);
  while (meet_[i].count > 0 && meet_[i].place != place) i = (i + 1) & (meet_.size() - 1);
  Meeting& meeting = meet_[i];
  if (meeting.count < kMostMet) ++meeting.count;
  if (meeting.count == 1) {
    meeting = {place, line, 1, is_end};
    return;
  }
  const Line second = leaving(line, is_end);
  if (meeting.count == 2) {
    pen.draw_join(leaving(meeting.line, meeting.is_end).turned(), second);
  } else {
    pen.draw_dot(second);
  }
}

// The line, directed away from its end or from its beginning.
Stroker::Line Stroker::leaving(std::uint32_t line, bool is_end) const {
  return is_end ? lines_[line].turned() : lines_[line];
}

// In bands of rows, to bound memory; in each band, lines with more ink come first. So a pixel shows
// the line that gives it the most ink, as if the lines were drawn one by one.
void Stroker::draw_nearest(const Pen& pen, const Cancellation* cancellation) {
  values_ = 0;
  CancellationCheck check(cancellation, 1024);
  const std::vector<std::uint32_t> order = by_ink();
  const int most_rows = rows_of_band(canvas_.width());
  for (int first = 0; first < canvas_.height(); first += most_rows) {
    const int rows = std::min(most_rows, canvas_.height() - first);
    field_.begin(canvas_.width(), rows, pen.reach());
    for (std::size_t i = 0; i < order.size();) {
      const std::uint8_t ink = to_value(lines_[order[i]].ink);
      for (; i < order.size() && to_value(lines_[order[i]].ink) == ink; ++i) {
        check();
        const Line& line = lines_[order[i]];
        const auto share_at = [&](double part) { return pen.dash_share(line, part * line.length); };
        field_.add({line.from.x, line.from.y - first}, {line.to.x, line.to.y - first}, share_at);
      }
      const float share_of_ink = static_cast<float>(ink) / 255;
      field_.spread(cancellation, [&](int column, int row, OutlineField::Nearest nearest) {
        std::uint8_t& out = canvas_.row(first + row, column, column + 1)[column];
        const float share = share_of_ink * nearest.share * pen.across(nearest.distance);
        out = std::max(out, to_value(share));
      });
    }
    values_ += field_.steps();
  }
}

// The lines that have any ink, in order of decreasing ink.
std::vector<std::uint32_t> Stroker::by_ink() const {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < lines_.size(); ++i) {
    if (to_value(lines_[i].ink) > 0) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [this](std::uint32_t i) { return to_value(lines_[i].ink); });
  return order;
}

}  // namespace trapeze
