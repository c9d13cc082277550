#include "render/picture/compose.h"

#include <cstddef>
#include <cstdint>

namespace trapeze {
namespace {

// With more colours than this, along edges and in the lattice, the more expensive method cannot fit
// them into a palette either, so it is not tried.
constexpr std::size_t kMostToGather = 2 * kPaletteColours;

}  // namespace

void Composer::compose(std::span<const PaintedLayer> layers, int width, int height, Rgba background,
                       Quality quality, RunPicture& picture) {
  parts_.assign(layers, width, height);
  finder_.find(parts_, mixtures_);
  mixture_colours_.begin(parts_, mixtures_, background);
  picture.width = width;
  picture.height = height;
  if (quality == Quality::exact) {
    colour(0, 0);
    write(picture);
    return;
  }
  const double most = most_change_of(picture.pixel_count());
  reduce_within(most, [&](int change) {
    const double along_edges = mixture_colours_.change_along_edges(change);
    return along_edges > most ? along_edges : along_edges + colour(change, change);
  });
  write(picture);
  const std::size_t colours = picture.colours.size();
  if (colours <= kPaletteColours || colours > kMostToGather) return;
  // Steps along edges use much of a palette: colours that are close to each other in this picture
  // may need less.
  const bool is_within = colour(0, kMostChange) <= most;
  if (is_within && reducer_.colours().size() <= kPaletteColours) write(picture);
}

// Computes the colours; returns the sum of the changes of all channels of all pixels that are not
// on an edge.
double Composer::colour(int along_edges, int of_others) {
  mixture_colours_.colour(along_edges);
  return static_cast<double>(reducer_.reduce(mixture_colours_.colours(), mixture_colours_.origins(),
                                             mixtures_.pixels, of_others));
}

void Composer::write(RunPicture& picture) {
  recolour(mixtures_.runs, mixtures_.row_end, reducer_.becomes(), picture);
  picture.colours = reducer_.colours();
  picture.origins = reducer_.origins();
}

}  // namespace trapeze
