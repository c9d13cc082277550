// Fewer colours, at a loss that nobody can see, so that a palette holds them.
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

/// How close to the exact picture one has to be.
enum class Quality : std::uint8_t { bounded, exact };

inline constexpr NameTable<Quality, 2> kQualityNames({
    {"bounded", Quality::bounded},
    {"exact", Quality::exact},
});

/// By how much a channel of a pixel may change, premultiplied, of 255; and the mean over all
/// channels of all pixels of a picture.
constexpr int kMostChange = 4;
constexpr double kMostMeanChange = 0.5;

/// Of all channels of so many pixels together.
constexpr double most_change_of(std::size_t pixels) {
  return 4 * kMostMeanChange * static_cast<double>(pixels);
}

/// Calls reduce(change), which returns the sum of the changes of all channels of all pixels, with
/// kMostChange first and then with less, until that sum is at most `most`. The last change.
/// Precondition: reduce(0) returns 0.
template <typename Reduce>
int reduce_within(double most, const Reduce& reduce) {
  int change = kMostChange;
  while (true) {
    const auto sum = static_cast<double>(reduce(change));
    if (sum <= most) return change;
    // The mean grows with the most.
    change = std::min(change - 1, static_cast<int>(change * most / sum));
  }
}

/// Lets colours of mixed origin that are close to each other become one, none by more than
/// kMostChange: each becomes the middle of its cell in a lattice, and so the same in neighbouring
/// tiles. Where more than kPaletteColours are left by that, it becomes another colour of the
/// picture, or the middle of a box around colours of the picture. What is opaque remains so.
///
/// Thread-safety: one thread at a time.
class ColourReducer {
 public:
  /// Of colours, how they came about, and how many pixels have each: those that none has are left
  /// out. A colour may come several times; of its origins the first of the enumeration counts.
  /// `most_change` is from 0 to kMostChange. The sum of the changes of all channels of all pixels.
  std::uint64_t reduce(std::span<const Rgba> colours, std::span<const Origin> origins,
                       std::span<const std::uint32_t> pixels, int most_change);

  /// What was found last: the new colours, and by old colour the index of its new one, which is
  /// unspecified if no pixel has it.
  const std::vector<Rgba>& colours() const { return made_.colours(); }
  const std::vector<Origin>& origins() const { return made_.origins(); }
  std::span<const std::uint32_t> becomes() const { return becomes_; }

  /// Of an exact picture, as far as kMostChange and kMostMeanChange allow. Runs that become equal
  /// are joined.
  void reduce(RunPicture& picture);

 private:
  class Box;
  class Neighbourhood;

  // Of the picture at hand.
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
  ColourNumbers kept_;                   // those that remain, each once
  ColourNumbers cells_;                  // of the lattice: their channels, as if they were colours
  std::vector<std::uint32_t> of_cells_;  // by cell: index of a new one
  ColourNumbers others_;                 // those that do not remain, each once
  std::vector<std::uint32_t> pixels_of_others_;
  std::vector<std::uint32_t> numbers_;  // by colour: among the others
  ColourNumbers made_;                  // the new ones
  std::vector<Channels> new_channels_;  // of the new ones
};

}  // namespace trapeze
