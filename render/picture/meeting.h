// How two layers share a pixel of which both cover a part.
#pragma once

#include <algorithm>
#include <cstdint>

namespace trapeze {

/// How the classes of a layer lie in a pixel in relation to what the layers below it cover there,
/// where both cover a part of it.
struct Meeting {
  static constexpr std::int8_t kSideBySide = -126;  // they share as little area as they can
  static constexpr std::int8_t kNested = 126;       // they share as much area as they can

  std::uint32_t pixel = 0;   // row * width + column
  std::int8_t relation = 0;  // between these two; 0: as much as chance has it
  // How much of what neither of them covers lies between the two, and is covered by none only
  // because their borders were simplified, in 255ths: there the lower one goes on below the upper.
  std::uint8_t gap = 0;

  friend bool operator==(const Meeting&, const Meeting&) = default;
};

/// Parts of a pixel, from 0 to 1.
template <typename Number>
struct MeetingShares {
  Number covered = 0;  // by the lower one, and what it goes on below the upper one
  Number common = 0;   // by both
};

/// Of two layers that meet in a pixel, each of which covers so much of it, from 0 to 1.
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

/// How much of a pixel the two cover together.
inline double covered_by(double below, double above, const Meeting& meeting) {
  const auto [covered, common] = shares_of(below, above, meeting);
  return above + covered - common;
}

}  // namespace trapeze
