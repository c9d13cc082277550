// From rings to a layer: every feature's polygon is trapezoidated and generalized through all
// levels, and the history of its graph is stored for drawing.
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

/// Builds the graphs of many features one after another and keeps the result. Use one builder per
/// thread and join them at the end: the joined layer does not depend on which builder got which
/// feature.
class LayerBuilder {
 public:
  /// Reports progress to `share`, if given. Content with the same rings as in `earlier`, if given,
  /// is taken over from there and not built; the outcomes and the layer are the same. `earlier`
  /// must have been built with equal options by the same program, and must be the same for all
  /// builders that are joined. Both must outlive the builder, and `earlier` also the joining.
  explicit LayerBuilder(const LayerOptions& options = {}, WorkShare* share = nullptr,
                        EarlierLayer* earlier = nullptr);
  ~LayerBuilder();
  LayerBuilder(LayerBuilder&&) noexcept;
  LayerBuilder& operator=(LayerBuilder&&) noexcept;

  /// Builds the graph of feature `row` from its rings, whatever their state: duplicates, spikes and
  /// collapsed rings are dropped, crossings and touches are noded on the grid, and inside is
  /// even-odd. `rings` is used as scratch memory. Never throws for bad geometry: see the outcome.
  /// Runs on up to `threads` threads; the result does not depend on their number.
  BuildOutcome add(std::uint32_t row, Rings& rings, unsigned threads = 1);

  /// Builds one graph of those features of a group that can share one, see assemble(). The others
  /// must be added separately, and none of these. `rows` are in ascending order; the rings are
  /// clean. Runs on up to `threads` threads. If the group is taken over, the outcome lacks the
  /// faces and the areas of features that are not below others. `classes` are the classes for
  /// merging into blocks, see LayerOptions::merging(); by feature, or empty.
  Assembly add_coverage(std::span<const std::uint32_t> rows, std::span<const Rings* const> features,
                        unsigned threads = 1, std::span<const std::uint64_t> classes = {});

  /// The tolerance (cells) from which on the most recently added unit is not simplified any further
  /// because that would take too long; usually none. See HistoryRecorder::record().
  std::optional<double> most_tolerance() const;

  /// How many features have been taken over.
  std::size_t taken_over() const;

  /// Joins the contents of the builders into one layer; the builders are empty afterwards. All were
  /// made with the same options. Calls `progress`, if given, with the elapsed fraction of the time.
  /// Runs on up to `threads` threads; the result does not depend on their number. Throws
  /// std::length_error if there are more items of any kind than 32 bits can count; so do add() and
  /// add_coverage().
  static std::unique_ptr<Layer> join(std::vector<LayerBuilder>& builders, FeatureTable features,
                                     const std::function<void(double)>& progress = {},
                                     unsigned threads = 1);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze
