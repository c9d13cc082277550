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
#include "core/grid/rings.h"
#include "core/grid/work_share.h"
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
  /// Tells `share`, if there is one, how far it is with what it adds; it must outlive the builder.
  explicit LayerBuilder(const LayerOptions& options = {}, WorkShare* share = nullptr);
  ~LayerBuilder();
  LayerBuilder(LayerBuilder&&) noexcept;
  LayerBuilder& operator=(LayerBuilder&&) noexcept;

  /// Builds the graph of feature `row` from its rings, whatever their state: duplicates, spikes and
  /// collapsed rings are dropped, crossings and touches noded on the grid, inside is even-odd.
  /// `rings` is used as scratch memory. Never throws for bad geometry: see the outcome.
  BuildOutcome add(std::uint32_t row, Rings& rings);

  /// Builds one graph of those features of a group that can live in one, see assemble(): the
  /// others, and none of these, are to be added by themselves. `rows` are in ascending order; the
  /// rings are clean. On up to `threads` threads.
  Assembly add_coverage(std::span<const std::uint32_t> rows, std::span<const Rings* const> features,
                        unsigned threads = 1);

  /// The tolerance (cells) from which on what was added last is not simplified any further, since
  /// that would take too long; none as a rule. See HistoryRecorder::record().
  std::optional<double> most_tolerance() const;

  /// Joins what the builders hold into one layer; the builders are empty afterwards. All were made
  /// with the same options. Calls `progress`, if there is one, with the share of the time that has
  /// gone. Throws std::length_error if there are more of anything than 32 bits count; so do add()
  /// and add_coverage().
  static std::unique_ptr<Layer> join(std::vector<LayerBuilder>& builders, FeatureTable features,
                                     const std::function<void(double)>& progress = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
