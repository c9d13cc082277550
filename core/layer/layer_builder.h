// From rings to a layer: every feature's polygon is trapezoidated, generalized through all levels,
// and the history of its graph stored for drawing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/borders/coverage_builder.h"
#include "core/borders/coverage_groups.h"
#include "core/grid/rings.h"
#include "core/grid/work_share.h"
#include "core/layer/earlier_layer.h"
#include "core/layer/feature_table.h"
#include "core/layer/layer.h"
#include "core/layer/layer_options.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {

/// Builds the graphs of many features one after another and keeps the result. Use one builder a
/// thread and join them at the end: the joined layer does not depend on which builder got which
/// feature.
class LayerBuilder {
 public:
  /// Tells `share`, if there is one, how far it is with what it adds. What has the same rings as in
  /// `earlier`, if there is one, is taken over from there and not built: the outcomes and the layer
  /// are the same. It was built with equal options by the same program, and is that of all builders
  /// that are joined. Both must outlive the builder, and `earlier` the joining.
  explicit LayerBuilder(const LayerOptions& options = {}, WorkShare* share = nullptr,
                        EarlierLayer* earlier = nullptr);
  ~LayerBuilder();
  LayerBuilder(LayerBuilder&&) noexcept;
  LayerBuilder& operator=(LayerBuilder&&) noexcept;

  /// Builds the graph of feature `row` from its rings, whatever their state: duplicates, spikes and
  /// collapsed rings are dropped, crossings and touches noded on the grid, inside is even-odd.
  /// `rings` is used as scratch memory. Never throws for bad geometry: see the outcome. On up to
  /// `threads` threads, on which nothing depends.
  BuildOutcome add(std::uint32_t row, Rings& rings, unsigned threads = 1);

  /// Builds one graph of those features of a group that can live in one, see assemble(): the
  /// others, and none of these, are to be added by themselves. `rows` are in ascending order; the
  /// rings are clean. On up to `threads` threads. Where the group is taken over, the outcome lacks
  /// the faces, and the areas of features that do not lie under others. `classes` are of what may
  /// become a block, see LayerOptions::merging(); by feature, or empty.
  Assembly add_coverage(std::span<const std::uint32_t> rows, std::span<const Rings* const> features,
                        unsigned threads = 1, std::span<const std::uint64_t> classes = {});

  /// The tolerance (cells) from which on what was added last is not simplified any further, since
  /// that would take too long; none as a rule. See HistoryRecorder::record().
  std::optional<double> most_tolerance() const;

  /// How many features have been taken over.
  std::size_t taken_over() const;

  /// Joins what the builders hold into one layer; the builders are empty afterwards. All were made
  /// with the same options. Calls `progress`, if there is one, with the share of the time that has
  /// gone. On up to `threads` threads, on which nothing depends. Throws std::length_error if there
  /// are more of anything than 32 bits count; so do add() and add_coverage().
  static std::unique_ptr<Layer> join(std::vector<LayerBuilder>& builders, FeatureTable features,
                                     const std::function<void(double)>& progress = {},
                                     unsigned threads = 1);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
