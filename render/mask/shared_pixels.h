// The share of a pixel that several lines cover together, from 64 sample points of the pixel.
//
// Each line is a mask of the points that it covers; the lines together cover the union. The masks
// of half-planes are looked up in a table, by direction and distance, and those of lines are
// intersections of half-planes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trapeze {

/// Half-planes as masks of the sample points of a pixel, one bit per point. The points are evenly
/// distributed, and no two of them have the same x or the same y.
class HalfPlanes {
 public:
  static constexpr unsigned kDirections = 256;
  static constexpr unsigned kRightAngle = kDirections / 4;

  /// Built by the first call. Thread-safe.
  static const HalfPlanes& table();
  /// The number of the direction of a vector that is not 0: 0 is along x, kRightAngle along y.
  static unsigned direction_of(double dx, double dy);

  /// The points p, relative to the centre of the pixel, with p * d <= offset (pixels), where d is
  /// the unit vector of that direction, modulo a full turn.
  std::uint64_t within(unsigned direction, float offset) const {
    constexpr auto kZero = static_cast<float>(kMostOffset);
    const float step = offset * kSteps + (kZero + 0.5f);
    const int index = static_cast<int>(std::min(std::max(step, 0.0f), 2 * kZero));
    return masks_[(direction % kDirections) * kOffsets + static_cast<std::size_t>(index)];
  }

 private:
  static constexpr int kSteps = 32;       // per pixel
  static constexpr int kMostOffset = 23;  // in steps: half a diagonal, rounded up
  static constexpr std::size_t kOffsets = 2 * kMostOffset + 1;

  HalfPlanes();

  std::vector<std::uint64_t> masks_;  // by direction and offset
};

/// A line for which masks are computed: a segment with a width, in pixels.
struct SampledLine {
  // One end, relative to the centre of the pixel.
  float x;
  float y;
  // The unit vector towards the other end, and its number.
  float dx;
  float dy;
  unsigned direction;
  float length;
  float half;           // of the width
  bool has_round_ends;  // otherwise they are cut off at right angles

  /// The points of the pixel that the line covers.
  std::uint64_t samples(const HalfPlanes& half_planes) const;

 private:
  std::uint64_t end_samples(const HalfPlanes& half_planes, float along) const;
};

// Cheap where pixels are away from both ends, as most of them are.
inline std::uint64_t SampledLine::samples(const HalfPlanes& half_planes) const {
  constexpr float kReach = 0.75f;  // a little more than half a diagonal of a pixel
  const float along = -x * dx - y * dy;
  const float beside = x * dy - y * dx;
  const unsigned across = direction + HalfPlanes::kRightAngle;
  const std::uint64_t samples =
      half_planes.within(across, half - beside) & ~half_planes.within(across, -half - beside);
  if (along > kReach && length - along > kReach) return samples;
  return samples & end_samples(half_planes, along);
}

/// Records for the pixels of a picture which lines cover them, and what lines cover together. Use
/// it for one picture after the other: the cost depends only on the pixels that are covered.
class SharedPixels {
 public:
  /// Starts a picture of that many pixels, without lines. An unfinished picture is discarded.
  void begin(std::size_t pixels);

  /// What is known of each pixel of the picture, by place: 0, or the number of the only line so
  /// far, or a reference to a shared pixel. Lines have numbers from 1 to kMostLines.
  std::uint32_t* known() { return known_.data(); }
  static constexpr std::uint32_t kMostLines = 0x7fffffff;

  /// Adds a line to the pixel at a place of which a line is known already. samples_of(number) and
  /// ink_of(number) return the points that a line covers there, and its ink, of 255.
  template <typename SamplesOf, typename InkOf>
  void add(std::size_t place, std::uint32_t number, const SamplesOf& samples_of,
           const InkOf& ink_of);

  /// Calls act(place, value) for each pixel of which several lines cover more than any of them
  /// does: what they cover together, with the least of their inks, of 255. The order in which lines
  /// were added makes no difference.
  template <typename Act>
  void for_each(const Act& act) const;
  /// Removes the lines of the pixels at some places.
  void forget(std::size_t begin, std::size_t end);
  /// Finishes the picture. Precondition: the lines of all pixels have been removed.
  void finish();

 private:
  struct Shared {
    std::uint64_t samples;
    std::uint32_t place;
    std::uint8_t ink;   // the least of the lines
    std::uint8_t most;  // points that one line covers
  };
  static constexpr std::uint32_t kIsShared = 0x80000000;
  static constexpr std::uint64_t kAllSamples = ~std::uint64_t{0};

  static std::uint8_t value_of(const Shared& pixel);

  std::vector<std::uint32_t> known_;
  std::vector<Shared> shared_;
  bool is_clean_ = true;
};

template <typename SamplesOf, typename InkOf>
void SharedPixels::add(std::size_t place, std::uint32_t number, const SamplesOf& samples_of,
                       const InkOf& ink_of) {
  std::uint32_t& known = known_[place];
  if ((known & kIsShared) == 0) {
    const std::uint64_t samples = samples_of(known);
    shared_.push_back({samples, static_cast<std::uint32_t>(place), ink_of(known),
                       static_cast<std::uint8_t>(std::popcount(samples))});
    known = kIsShared | static_cast<std::uint32_t>(shared_.size() - 1);
  }
  Shared& pixel = shared_[known & ~kIsShared];
  pixel.ink = std::min(pixel.ink, ink_of(number));
  if (pixel.samples == kAllSamples) return;
  const std::uint64_t samples = samples_of(number);
  pixel.samples |= samples;
  pixel.most = std::max(pixel.most, static_cast<std::uint8_t>(std::popcount(samples)));
}

template <typename Act>
void SharedPixels::for_each(const Act& act) const {
  for (const Shared& pixel : shared_) {
    if (std::popcount(pixel.samples) > pixel.most) act(std::size_t{pixel.place}, value_of(pixel));
  }
}

}  // namespace trapeze
