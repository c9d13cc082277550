// The values of an attribute of a layer and their distribution, for choosing colour classes.
#pragma once

#include <cstddef>

#include "server/base/result.h"
#include "server/documents/document.h"

namespace trapeze {

constexpr std::size_t kMaxValues = 100;      // in one answer, the most frequent
constexpr std::size_t kMaxValueBytes = 256;  // longer texts are left out
constexpr std::size_t kQuantileSteps = 256;  // between the least and the greatest value

/// /values/{layer}/{attribute}?bbox=: the values of the features that a request with the same style
/// draws and that touch the box. "values" are the most frequent ones with their counts, with ties
/// in ascending order; "quantiles", for numbers, are ascending, from the least to the greatest.
Result<Document> values_document(const DocumentRequest& request);

}  // namespace trapeze
