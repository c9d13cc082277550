// The relation of two layers in a pixel that both partly cover.
#pragma once

#include <algorithm>
#include <cstdint>

namespace trapeze {

/// The relation of the classes of a layer to the area covered by the layers below it, in a pixel
/// that both partly cover.
struct Meeting {
  static constexpr std::int8_t kSideBySide = -126;  // they overlap as little as possible
  static constexpr std::int8_t kNested = 126;       // they overlap as much as possible

  std::uint32_t pixel = 0;   // row * width + column
  std::int8_t relation = 0;  // between these two; 0: independent, as by chance
  // The share, in 255ths, of the area covered by neither that is a gap between the two, uncovered
  // only because their borders were simplified: there the lower one continues below the upper one.
  std::uint8_t gap = 0;

  friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// Shares of a pixel, from 0 to 1.
template <typename Number>
struct MeetingShares {
  Number covered = 0;  // by the lower one, including its continuation below the upper one
  Number common = 0;   // by both
};

/// For two layers that meet in a pixel, given the share of it that each covers, from 0 to 1.
template <typename Number>
MeetingShares<Number> shares_of(Number below, Number above, const Meeting& meeting) {
  const auto common_of = [&](Number covered) {
    const Number chance = covered * above;
    const Number relation = static_cast<Number>(meeting.relation) / Meeting::kNested;
    if (relation < 0) {
      const Number least = std::max(Number{0}, above + covered - 1);
      return chance + relation * (chance - least);
    }
    return chance + relation * (std::min(above, covered) - chance);
  };
  const Number neither = std::max(Number{0}, 1 - above - below + common_of(below));
  const Number covered = below + neither * static_cast<Number>(meeting.gap) / 255;
  return {covered, common_of(covered)};
}

/// The share of a pixel that the two cover together.
inline double covered_by(double below, double above, const Meeting& meeting) {
  const auto [covered, common] = shares_of(below, above, meeting);
  return above + covered - common;
}

}  // namespace trapeze
