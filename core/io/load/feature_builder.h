// Builds the graphs of a layer's features and counts the outcomes.
#pragma once

#include <span>
#include <utility>

#include "core/io/load/feature_pipeline.h"
#include "core/io/load/feature_tally.h"
#include "core/layer/layer_builder.h"

namespace trapeze {

/// One thread at a time. Features built by themselves must arrive in ascending order.
class FeatureBuilder : public FeatureWorker {
 public:
  /// Takes over from `earlier`, if not null; see LayerBuilder.
  FeatureBuilder(const LayerOptions& generalization, EarlierLayer* earlier)
      : builder_(generalization, &share_, earlier) {}

  void build_apart(const FeatureKey& feature, Rings& rings, unsigned threads) override;
  /// Builds one graph of the features, except those that have to be built apart (see assemble()).
  void build_together(std::span<WaitingFeature* const> features, unsigned threads) override;

  const FeatureTally& tally() const { return tally_; }
  std::size_t taken_over() const { return builder_.taken_over(); }
  LayerBuilder take_builder() { return std::move(builder_); }

 private:
  /// Adds a remark if the last unit was not simplified up to the last level.
  void remark_on_detail(const FeatureKey& feature);
  void count(std::span<WaitingFeature* const> features, const Assembly& assembly);

  LayerBuilder builder_;
  FeatureTally tally_;
};

}  // namespace trapeze
