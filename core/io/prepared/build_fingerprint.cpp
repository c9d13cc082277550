#include "core/io/prepared/build_fingerprint.h"

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/borders/gap_closing.h"
#include "core/grid/web_mercator.h"
#include "core/io/file/checksum.h"
#include "core/labels/label_anchors.h"
#include "core/layer/layer_arrays.h"
#include "core/layer/layer_builder.h"
#include "core/sweep/clean_rings.h"

namespace trapeze {
namespace {

// Must be incremented when different polygons or attributes are read from the same source, when the
// same content gets another revision, or when a change affects only layers that are unlike the
// probe, such as those with much dust.
constexpr std::uint64_t kReadingVersion = 11;

constexpr int kShapes = 12;
constexpr int kVertices = 9;

/// The same on every machine, unlike the distributions of the standard library.
class Random {
 public:
  /// From -range up to, but not including, range.
  std::int32_t next(std::int32_t range) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::int32_t>((state_ >> 33) % (2u * static_cast<std::uint32_t>(range))) -
           range;
  }

 private:
  std::uint64_t state_ = 1;
};

/// Rings of any kind, from a few cells to a thousand kilometres, most of which cross themselves, so
/// that operators, noding, blocked vertices, holes and dust are all involved.
void draw_shape(Random& random, int shape, Rings& rings) {
  const std::int32_t size = 4 << (2 * shape);
  const Point middle{random.next(1 << 20), random.next(1 << 20)};
  for (int vertex = 0; vertex < kVertices; ++vertex) {
    rings.points.push_back({middle.x + random.next(size), middle.y + random.next(size)});
  }
  rings.close_ring();
}

/// The same kind of rings as features of one coverage: borders between all of them, junctions, and
/// small regions of all sizes that will be removed.
void add_coverage(Random& random, double gap, FeatureTable& features, LayerBuilder& builder) {
  std::vector<Rings> rings(kShapes);
  std::vector<std::uint32_t> rows;
  std::vector<Rings*> pointers;
  for (int shape = 0; shape < kShapes; ++shape) {
    Rings& drawn = rings[static_cast<std::size_t>(shape)];
    draw_shape(random, shape, drawn);
    clean_rings(drawn);
    rows.push_back(features.append(kShapes + shape, {}));
    pointers.push_back(&drawn);
  }
  if (gap > 0) close_gaps(pointers, gap);
  builder.add_coverage(rows, std::vector<const Rings*>(pointers.begin(), pointers.end()));
}

std::unique_ptr<Layer> build_probe(LayerOptions options) {
  options.coverage = CoverageMode::on;
  FeatureTable features(std::vector<Field>{});
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  Random random;
  Rings rings;
  for (int shape = 0; shape < kShapes; ++shape) {
    rings.clear();
    draw_shape(random, shape, rings);
    builders.front().add(features.append(shape, {}), rings);
  }
  add_coverage(random, options.close_gaps, features, builders.front());
  return LayerBuilder::join(builders, std::move(features));
}

/// Where places of the world lie on the grid.
std::array<std::int64_t, 4> probe_projection() {
  const GridPosition place = grid_from_lonlat({114.06, 22.54});
  const GridPosition metres = grid_from_metres(1'000'000, -1'000'000);
  return {std::llround(place.x), std::llround(place.y), std::llround(metres.x),
          std::llround(metres.y)};
}

}  // namespace

std::uint64_t build_fingerprint(const LayerOptions& options) {
  const std::unique_ptr<Layer> layer = build_probe(options);
  const LayerArrays a = arrays_of(*layer);
  const std::array<std::int64_t, 4> projected = probe_projection();
  const LabelAnchors anchors(*layer, LabelParts::all);
  const std::array<std::uint64_t, 22> parts = {
      kReadingVersion,
      checksum_of(a.vertices),
      checksum_of(a.edges),
      checksum_of(a.trapezoids),
      checksum_of(a.lifespans),
      checksum_of(a.feature_of),
      checksum_of(a.outline.loop_sizes),
      checksum_of(a.outline.milestones),
      checksum_of(a.outline.milestone_levels),
      checksum_of(a.polygon_index),
      checksum_of(a.horizontal_edge_index),
      checksum_of(a.mote_index),
      checksum_of(a.merged_mote_index),
      checksum_of(a.grains),
      checksum_of(a.overlaps),
      checksum_of(a.outline_points),
      checksum_of(a.units.features),
      checksum_of(a.units.groups),
      checksum_of(a.units.members),
      checksum_of(a.units.overlaps),
      checksum_of(anchors.all()),
      checksum_of(std::span<const std::int64_t>(projected))};
  return checksum_of(std::span<const std::uint64_t>(parts));
}

}  // namespace trapeze
