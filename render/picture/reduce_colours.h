// Fewer colours, at a loss that nobody can see, so that a palette holds them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/name_table.h"
#include "render/picture/channels.h"
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

/// Lets colours of mixed origin that are close to each other become one, none by more than
/// kMostChange: each becomes the middle of its cell in a lattice, and so the same in neighbouring
/// tiles. Where more than kPaletteColours are left by that, it becomes another colour of the
/// picture, or the middle of a box around colours of the picture. What is opaque remains so.
///
/// Thread-safety: one thread at a time.
class ColourReducer {
 public:
  /// `most_change` is from 0 to kMostChange. What is opaque remains so, runs that become equal are
  /// joined, and colours that no pixel has are left out. The sum of the changes of all channels of
  /// all pixels.
  std::uint64_t reduce(RunPicture& picture, int most_change);

 private:
  class Box;
  class Neighbourhood;
  class NewColours;

  void count_pixels(const RunPicture& picture);
  void keep_all_but_mixed(const RunPicture& picture, NewColours& made);
  void put_into_lattice(const RunPicture& picture, int most_change);
  bool may_be_gathered(const RunPicture& picture) const;
  bool gather(const RunPicture& picture, int most_change);
  std::uint32_t nearest(const Neighbourhood& kept, const Channels& channels, int most_change) const;
  std::uint64_t change() const;
  void apply(RunPicture& picture) const;

  std::vector<Channels> channels_;      // by colour
  std::vector<std::uint32_t> pixels_;   // by colour: how many have it
  std::vector<std::uint32_t> becomes_;  // by colour: index of a new one
  std::vector<Rgba> colours_;           // the new ones
  std::vector<Channels> new_channels_;  // of the new ones
};

}  // namespace trapeze
