// Makes a layer from the contents of its builders and the content taken over from an earlier one.
// Private to LayerBuilder.
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

/// The layer depends neither on how content is distributed over the stocks, nor on how much of it
/// is taken over from `earlier` (null if nothing is), nor on the number of threads. Calls
/// `progress`, if given, with the elapsed fraction of the time. Throws std::length_error if there
/// are more items of any kind than 32 bits can count.
std::unique_ptr<Layer> join_stocks(std::vector<Stock> stocks, const EarlierLayer* earlier,
                                   const LayerOptions& options, FeatureTable features,
                                   const std::function<void(double)>& progress, unsigned threads);

}  // namespace trapeze
