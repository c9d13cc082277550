#include "core/layer/layer_builder.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/adapt/history_recorder.h"
#include "core/layer/join_stocks.h"
#include "core/layer/stock.h"

namespace trapeze {
namespace {

// Fractions of the building time until the graph exists, measured on countries and land use.
constexpr double kGraphShare = 0.25;     // of a single feature
constexpr double kAssemblyShare = 0.45;  // of features that share borders

/// Notes every pair of features that share a face, once for each of the two, however many faces
/// they share.
void note_shared(const FaceFeatures& rows, std::vector<FeatureOverlap>& shared) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const std::vector<std::uint32_t>& features : rows.shared()) {
    for (std::size_t upper = 1; upper < features.size(); ++upper) {
      for (std::size_t lower = 0; lower < upper; ++lower) {
        pairs.emplace_back(features[lower], features[upper]);
      }
    }
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [lower, upper] : pairs) {
    shared.push_back(FeatureOverlap::in_common(lower, upper));
    shared.push_back(FeatureOverlap::in_common(upper, lower));
  }
}

std::uint32_t stored_count(std::size_t count) {
  return static_cast<std::uint32_t>(count);  // known to be countable
}

FeatureUnit unit_of(const Digest& digest, std::uint32_t row, const BuildOutcome& outcome,
                    std::optional<double> most_tolerance) {
  return {digest,
          StoredTolerance(most_tolerance),
          row,
          stored_count(outcome.vertices),
          stored_count(outcome.collapsed_rings),
          outcome.noded};
}

BuildOutcome outcome_of(const FeatureUnit& unit, std::size_t rings) {
  BuildOutcome outcome;
  outcome.built = true;
  outcome.noded = unit.is_noded != 0;
  outcome.rings = rings;
  outcome.collapsed_rings = unit.collapsed_rings;
  outcome.vertices = unit.vertices;
  return outcome;
}

void add_group(std::span<const Digest> digests, std::span<const std::uint32_t> rows,
               const Assembly& assembly, std::optional<double> most_tolerance, BuiltUnits& units) {
  const CoverageOutcome& outcome = assembly.outcome;
  const std::size_t first = units.members.size();
  for (std::size_t i = 0; i < rows.size(); ++i) units.members.push_back({digests[i], rows[i], 0});
  for (const std::uint32_t i : assembly.apart) units.members[first + i].is_apart = 1;
  for (const Overlap& overlap : outcome.overlaps) {
    units.overlaps.push_back({overlap.lower, overlap.upper,
                              std::bit_cast<std::uint64_t>(overlap.area),
                              std::bit_cast<std::uint64_t>(outcome.areas[overlap.lower])});
  }
  units.groups.push_back({digest_of(digests), StoredTolerance(most_tolerance),
                          stored_count(units.members.size()), stored_count(units.overlaps.size()),
                          stored_count(outcome.vertices), stored_count(outcome.shared_edges),
                          stored_count(outcome.junctions), stored_count(outcome.gaps),
                          stored_count(outcome.filled), outcome.noded, outcome.is_crowded});
}

Assembly assembly_of(const BuiltUnitsView& units, std::uint32_t number) {
  const GroupUnit& unit = units.groups[number];
  const std::span<const GroupMember> members = units.members_of(number);
  Assembly assembly;
  for (std::uint32_t i = 0; i < members.size(); ++i) {
    (members[i].is_apart != 0 ? assembly.apart : assembly.together).push_back(i);
  }
  CoverageOutcome& outcome = assembly.outcome;
  outcome.built = !assembly.together.empty();
  outcome.noded = unit.is_noded != 0;
  outcome.vertices = unit.vertices;
  outcome.shared_edges = unit.shared_edges;
  outcome.junctions = unit.junctions;
  outcome.gaps = unit.gaps;
  outcome.filled = unit.filled;
  outcome.apart = assembly.apart;
  outcome.is_crowded = unit.is_crowded != 0;
  outcome.areas.resize(members.size());
  for (const GroupOverlap& overlap : units.overlaps_of(number)) {
    if (std::max(overlap.lower, overlap.upper) >= members.size()) continue;  // of a damaged file
    outcome.overlaps.push_back({overlap.lower, overlap.upper, std::bit_cast<double>(overlap.area)});
    outcome.areas[overlap.lower] = std::bit_cast<double>(overlap.lower_area);
  }
  return assembly;
}

}  // namespace

struct LayerBuilder::State {
  LayerOptions options;
  Stock stock;
  GraphBuilder graph_builder;
  CoverageBuilder coverage_builder;
  TrapezoidalGraph graph;
  HistoryRecorder recorder;
  std::optional<double> most_tolerance;
  WorkShare* share = nullptr;
  EarlierLayer* earlier = nullptr;

  void begin_part(std::uint32_t row) {
    const History& history = stock.history;
    stock.parts.push_back({row, history.vertices.size(), history.edges.size(),
                           history.milestones.size(), history.trapezoids.size(),
                           history.horizontal_edges.size(), history.grains.size()});
  }

  void add_outline(std::uint32_t row, const Rings& rings) {
    const std::size_t begin = stock.outline_rings.size();
    for (std::size_t r = 0; r < rings.size(); ++r) stock.outline_rings.add(rings[r]);
    stock.outlines.push_back({row, begin, stock.outline_rings.size()});
  }

  BuildOutcome take_over(std::uint32_t number, const Digest& digest, std::uint32_t row,
                         const Rings& rings) {
    FeatureUnit unit = earlier->units().features[number];
    const TakenRow taken{unit.row, row, row};
    if (earlier->has_double(number)) {
      stock.doubles.push_back({digest, taken});
    } else {
      stock.taken.push_back(taken);
    }
    unit.row = row;
    stock.units.features.push_back(unit);
    most_tolerance = unit.most_tolerance.get();
    return outcome_of(unit, rings.size());
  }

  Assembly take_over_group(std::uint32_t number, std::span<const Digest> digests,
                           std::span<const std::uint32_t> rows) {
    Assembly assembly = assembly_of(earlier->units(), number);
    const std::span<const GroupMember> members = earlier->units().members_of(number);
    for (const std::uint32_t i : assembly.together) {
      stock.taken.push_back({members[i].row, rows[i], rows[assembly.together.front()]});
    }
    most_tolerance = earlier->units().groups[number].most_tolerance.get();
    add_group(digests, rows, assembly, most_tolerance, stock.units);
    return assembly;
  }

  void build_group(std::span<const std::uint32_t> rows, const Assembly& assembly,
                   unsigned threads) {
    begin_part(rows[assembly.together.front()]);
    const FaceFeatures faces = assembly.outcome.faces.named(rows);
    note_shared(faces, stock.shared);
    const std::vector<Rings> outlines = rings_of_features(graph, assembly.outcome.faces);
    for (const std::uint32_t i : assembly.together) add_outline(rows[i], outlines[i]);
    if (share != nullptr) share->enter(kAssemblyShare, 1);
    most_tolerance = recorder.record(graph, faces, options, stock.history, share, threads,
                                     assembly.outcome.plan ? &*assembly.outcome.plan : nullptr);
  }
};

LayerBuilder::LayerBuilder(const LayerOptions& options, WorkShare* share, EarlierLayer* earlier)
    : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->share = share;
  state_->earlier = earlier;
}
LayerBuilder::~LayerBuilder() = default;
LayerBuilder::LayerBuilder(LayerBuilder&&) noexcept = default;
LayerBuilder& LayerBuilder::operator=(LayerBuilder&&) noexcept = default;

std::optional<double> LayerBuilder::most_tolerance() const {
  return state_->most_tolerance;
}

std::size_t LayerBuilder::taken_over() const {
  return state_->stock.taken.size() + state_->stock.doubles.size();
}

BuildOutcome LayerBuilder::add(std::uint32_t row, Rings& rings, unsigned threads) {
  State& state = *state_;
  const Digest digest = digest_of(rings);
  if (state.earlier != nullptr) {
    if (const auto unit = state.earlier->claim_feature(digest)) {
      return state.take_over(*unit, digest, row, rings);
    }
  }
  BuildOutcome outcome = state.graph_builder.build(rings, state.graph, threads);
  if (!outcome.built) return outcome;
  if (state.share != nullptr) state.share->enter(kGraphShare, 1);
  state.begin_part(row);
  state.add_outline(row, rings_of(state.graph));
  state.most_tolerance = state.recorder.record(state.graph, FaceFeatures({row}), state.options,
                                               state.stock.history, state.share, threads);
  state.stock.units.features.push_back(unit_of(digest, row, outcome, state.most_tolerance));
  return outcome;
}

Assembly LayerBuilder::add_coverage(std::span<const std::uint32_t> rows,
                                    std::span<const Rings* const> features, unsigned threads,
                                    std::span<const std::uint64_t> classes) {
  State& state = *state_;
  std::vector<Digest> digests;
  digests.reserve(features.size());
  for (const Rings* rings : features) digests.push_back(digest_of(*rings));
  for (std::size_t i = 0; i < classes.size(); ++i) digests[i] = digest_of(digests[i], classes[i]);
  if (state.earlier != nullptr) {
    if (const auto unit = state.earlier->claim_group(digest_of(digests), rows.size())) {
      return state.take_over_group(*unit, digests, rows);
    }
  }
  if (state.share != nullptr) state.share->enter(0, kAssemblyShare);
  Assembly assembly =
      assemble(features, state.options.coverage, state.options.close_gaps, state.coverage_builder,
               state.graph, state.share, threads, state.options.merging(classes));
  state.most_tolerance.reset();
  if (!assembly.together.empty()) state.build_group(rows, assembly, threads);
  add_group(digests, rows, assembly, state.most_tolerance, state.stock.units);
  // Its failure is to be reported again, so nothing is taken over for it. But it has to be known
  // that its features share borders, although each is built by itself.
  if (!assembly.outcome.failure.empty()) state.stock.units.groups.back().digest = kOfFailedGroup;
  return assembly;
}

std::unique_ptr<Layer> LayerBuilder::join(std::vector<LayerBuilder>& builders,
                                          FeatureTable features,
                                          const std::function<void(double)>& progress,
                                          unsigned threads) {
  LayerOptions options;
  const EarlierLayer* earlier = nullptr;
  if (!builders.empty()) {
    options = builders.front().state_->options;
    earlier = builders.front().state_->earlier;
  }
  std::vector<Stock> stocks;
  for (LayerBuilder& builder : builders) {
    stocks.push_back(std::move(builder.state_->stock));
    builder = LayerBuilder(builder.state_->options);  // frees the memory used for building
  }
  return join_stocks(std::move(stocks), earlier, options, std::move(features), progress, threads);
}

}  // namespace trapeze
