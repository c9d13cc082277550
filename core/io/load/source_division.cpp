#include "core/io/load/source_division.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/borders/box_ties.h"
#include "core/borders/merge_plan.h"
#include "core/grid/digest.h"
#include "core/grid/disjoint_sets.h"
#include "core/grid/hilbert.h"
#include "core/grid/item_count.h"
#include "core/grid/ring_box.h"
#include "core/grid/web_mercator.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_name.h"
#include "core/io/source/source_ring_reader.h"

namespace trapeze {
namespace {

constexpr std::size_t kFeaturesBetweenShows = 4096;

/// Measures of the features of a source, in its order.
struct Measures {
  std::vector<std::uint32_t> vertices;  // by feature; 0 if it is not drawn
  std::vector<std::uint32_t> places;    // by feature: along the Hilbert curve
  std::vector<Box> boxes;
  std::vector<std::uint32_t> owners;  // by box: the feature
  std::uint64_t fingerprint = 0;
};

std::uint64_t word_of(std::int32_t x, std::int32_t y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32 | static_cast<std::uint32_t>(y);
}

/// Widened so that the boxes of two features that gap closing may connect intersect.
Box widened_for_gaps(const Box& box, double metres) {
  if (metres == 0) return box;
  // The map scale grows towards the poles.
  const double y =
      std::max(std::abs(static_cast<double>(box.min_y)), std::abs(static_cast<double>(box.max_y)));
  const auto cells = static_cast<std::int64_t>(std::ceil(cells_from_ground(metres, y))) + 1;
  const auto cell = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, kGridMin, kGridMax));
  };
  return {cell(box.min_x - cells), cell(box.min_y - cells), cell(box.max_x + cells),
          cell(box.max_y + cells)};
}

class Measuring {
 public:
  Measuring(FeatureSource& source, const LayerOptions& options)
      : source_(source), options_(options), reader_(source) {}

  Measures measure(const std::function<void(double)>& progress) {
    SourceFeature next;
    while (source_.next(next)) {
      require_countable(measures_.vertices.size() + 1, "features that can be divided");
      measures_.vertices.push_back(0);
      measures_.places.push_back(0);
      measure(next);
      if (progress && measures_.vertices.size() % kFeaturesBetweenShows == 0) {
        progress(source_.progress());
      }
    }
    measures_.fingerprint = digester_.digest().low;
    return std::move(measures_);
  }

 private:
  void measure(SourceFeature& next) {
    digester_.add(static_cast<std::uint64_t>(next.feature->GetFID()));
    if (next.layer == nullptr) return;
    const OGRGeometry* geometry = next.feature->GetGeomFieldRef(next.layer->geometry_field);
    if (geometry == nullptr || !has_polygons(*geometry)) return;
    const FeatureRings& feature = reader_.read(*geometry, next.layer_index);
    if (!feature.failure.empty() || feature.rings.empty()) return;
    const auto owner = static_cast<std::uint32_t>(measures_.vertices.size() - 1);
    measures_.vertices.back() = static_cast<std::uint32_t>(feature.rings.points.size());
    const Box all = box_of(feature.rings.points);
    measures_.places.back() =
        hilbert({static_cast<std::int32_t>((std::int64_t{all.min_x} + all.max_x) / 2),
                 static_cast<std::int32_t>((std::int64_t{all.min_y} + all.max_y) / 2)});
    digester_.add(word_of(all.min_x, all.min_y));
    digester_.add(word_of(all.max_x, all.max_y));
    digester_.add(feature.rings.points.size());
    // With coverage on, features are grouped by their whole bounding boxes.
    if (options_.coverage == CoverageMode::on) return add(all, owner);
    const std::size_t first = measures_.boxes.size();
    for (std::size_t r = 0; r < feature.rings.size(); ++r) {
      const Box box = widened(box_of(feature.rings[r]));
      // A hole usually follows its shell.
      const bool is_within = measures_.boxes.size() > first && holds(measures_.boxes.back(), box);
      if (!is_within) add_as_is(box, owner);
    }
  }

  void add(const Box& box, std::uint32_t owner) { add_as_is(widened(box), owner); }
  /// Widened so that it intersects those of others that may affect it.
  Box widened(const Box& box) const {
    return options_.merge > 0 ? widened_for_blocks(box)
                              : widened_for_gaps(box, options_.close_gaps);
  }
  void add_as_is(const Box& box, std::uint32_t owner) {
    require_countable(measures_.boxes.size() + 1, "rings that can be divided");
    measures_.boxes.push_back(box);
    measures_.owners.push_back(owner);
  }

  FeatureSource& source_;
  const LayerOptions& options_;
  SourceRingReader reader_;
  Measures measures_;
  Digester digester_;
};

/// Connected features, represented by the first of them.
struct Group {
  std::uint32_t place = 0;  // of the first one
  std::uint32_t first = 0;
  std::uint64_t vertices = 0;
};

/// The groups that have vertices, in order along the curve.
std::vector<Group> groups_of(const Measures& measures, DisjointSets& sets) {
  std::vector<std::uint64_t> vertices(sets.size());
  for (std::uint32_t i = 0; i < sets.size(); ++i) vertices[sets.find(i)] += measures.vertices[i];
  std::vector<Group> groups;
  for (std::uint32_t i = 0; i < sets.size(); ++i) {
    if (vertices[i] > 0) groups.push_back({measures.places[i], i, vertices[i]});
  }
  std::ranges::sort(groups, {},
                    [](const Group& group) { return std::pair(group.place, group.first); });
  return groups;
}

}  // namespace

std::shared_ptr<const SourceDivision> SourceDivision::of(
    const std::string& path, const SourceSelection& selection, const LayerOptions& options,
    std::uint32_t count, const std::function<void(double)>& progress) {
  Measures measures;
  try {
    FeatureSource source(path, selection);
    measures = Measuring(source, options).measure(progress);
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(path) + ": " + error.what());
  }
  std::shared_ptr<SourceDivision> division(new SourceDivision());
  DisjointSets sets(measures.vertices.size());
  tie_meeting(measures.boxes, measures.owners, sets);
  measures.boxes = {};
  measures.owners = {};

  const std::vector<Group> groups = groups_of(measures, sets);
  std::uint64_t all = 0;
  for (const Group& group : groups) all += group.vertices;
  division->parts_.resize(count);
  division->part_of_.assign(measures.vertices.size(), 0);
  std::uint64_t before = 0;
  for (const Group& group : groups) {
    // The part that contains the middle of the group's vertices.
    const auto part = static_cast<std::uint64_t>(static_cast<Int128>(before + group.vertices / 2) *
                                                 count / std::max<std::uint64_t>(all, 1));
    division->part_of_[group.first] =
        static_cast<std::uint16_t>(std::min<std::uint64_t>(part, count - 1));
    before += group.vertices;
    division->largest_group_ = std::max(division->largest_group_, group.vertices);
  }
  for (std::uint32_t i = 0; i < measures.vertices.size(); ++i) {
    if (measures.vertices[i] == 0) continue;
    division->part_of_[i] = division->part_of_[sets.find(i)];
    Part& part = division->parts_[division->part_of_[i]];
    ++part.features;
    part.vertices += measures.vertices[i];
  }
  Digester digester;
  digester.add(measures.fingerprint);
  digester.add(count);
  digester.add(static_cast<std::uint64_t>(options.coverage));
  for (const Part& part : division->parts_) digester.add(part.features);
  division->fingerprint_ = digester.digest().low;
  return division;
}

}  // namespace trapeze
