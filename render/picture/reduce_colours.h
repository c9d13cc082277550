// Reduces the number of colours, with invisible loss, so that they fit into a palette.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/name_table.h"
#include "render/picture/channels.h"
#include "render/picture/colour_numbers.h"
#include "render/picture/picture.h"

namespace trapeze {

constexpr std::size_t kPaletteColours = 256;

/// The required accuracy compared with the exact picture.
enum class Quality : std::uint8_t { bounded, exact };

inline constexpr NameTable<Quality, 2> kQualityNames({
    {"bounded", Quality::bounded},
    {"exact", Quality::exact},
});

/// The maximum change of a channel of a pixel, premultiplied, of 255; and the maximum of the mean
/// over all channels of all pixels of a picture.
constexpr int kMostChange = 4;
constexpr double kMostMeanChange = 0.5;

/// For the sum over all channels of that many pixels.
constexpr double most_change_of(std::size_t pixels) {
  return 4 * kMostMeanChange * static_cast<double>(pixels);
}

/// Calls reduce(change), which returns the sum of the changes of all channels of all pixels, first
/// with kMostChange and then with smaller values, until that sum is at most `most`. Returns the
/// last `change`. Precondition: reduce(0) returns 0.
template <typename Reduce>
int reduce_within(double most, const Reduce& reduce) {
  int change = kMostChange;
  while (true) {
    const auto sum = static_cast<double>(reduce(change));
    if (sum <= most) return change;
    // The mean grows with the maximum.
    change = std::min(change - 1, static_cast<int>(change * most / sum));
  }
}

/// Merges colours of mixed origin that are close to each other; none changes by more than
/// kMostChange. Each becomes the centre of its cell in a lattice, and therefore the same in
/// neighbouring tiles. If more than kPaletteColours remain, each becomes another colour of the
/// picture, or the centre of a box around colours of the picture. Opaque colours stay opaque.
///
/// Thread-safety: one thread at a time.
class ColourReducer {
 public:
  /// The arguments are colours, their origins, and the number of pixels of each; colours without
  /// pixels are left out. A colour may occur several times; the first of its origins in the
  /// enumeration counts. `most_change` is from 0 to kMostChange. Returns the sum of the changes of
  /// all channels of all pixels.
  std::uint64_t reduce(std::span<const Rgba> colours, std::span<const Origin> origins,
                       std::span<const std::uint32_t> pixels, int most_change);

  /// The last result: the new colours, and for each old colour the index of its new one, which is
  /// unspecified if no pixel has it.
  const std::vector<Rgba>& colours() const { return made_.colours(); }
  const std::vector<Origin>& origins() const { return made_.origins(); }
  std::span<const std::uint32_t> becomes() const { return becomes_; }

  /// Reduces an exact picture as far as kMostChange and kMostMeanChange allow. Runs that become
  /// equal are joined.
  void reduce(RunPicture& picture);

 private:
  class Box;
  class Neighbourhood;

  // The current picture.
  struct Given {
    std::span<const Rgba> colours;
    std::span<const Origin> origins;
    std::span<const std::uint32_t> pixels;
  };

  void begin(const Given& given);
  void put_into_lattice(const Given& given, int most_change);
  bool may_be_gathered() const;
  bool gather(const Given& given, int most_change);
  void number_others(const Given& given);
  std::uint32_t make(Rgba colour, Origin origin);
  std::uint32_t nearest(Neighbourhood& kept, const Channels& channels, int most_change) const;
  std::uint64_t change(const Given& given) const;

  std::vector<Channels> channels_;       // by colour
  std::vector<std::uint32_t> becomes_;   // by colour: index of a new one
  ColourNumbers kept_;                   // colours that remain, without duplicates
  ColourNumbers cells_;                  // of the lattice: their channels, stored as colours
  std::vector<std::uint32_t> of_cells_;  // by cell: index of a new one
  ColourNumbers others_;                 // colours that do not remain, without duplicates
  std::vector<std::uint32_t> pixels_of_others_;
  std::vector<std::uint32_t> numbers_;  // by colour: index among the others
  ColourNumbers made_;                  // the new colours
  std::vector<Channels> new_channels_;  // of the new colours
};

}  // namespace trapeze
