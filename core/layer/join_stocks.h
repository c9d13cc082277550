// Makes a layer of what its builders hold, and of what is taken over from an earlier one. Private
// to LayerBuilder.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/layer/earlier_layer.h"
#include "core/layer/feature_table.h"
#include "core/layer/layer.h"
#include "core/layer/layer_options.h"
#include "core/layer/stock.h"

namespace trapeze {

/// The layer does not depend on which stock holds what, nor on what of it is taken over from
/// `earlier`, which is null if nothing is, nor on the number of threads. Calls `progress`, if there
/// is one, with the share of the time that has gone. Throws std::length_error if there are more of
/// anything than 32 bits count.
std::unique_ptr<Layer> join_stocks(std::vector<Stock> stocks, const EarlierLayer* earlier,
                                   const LayerOptions& options, FeatureTable features,
                                   const std::function<void(double)>& progress, unsigned threads);

}  // namespace trapeze
