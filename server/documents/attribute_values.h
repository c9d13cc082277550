// Which values an attribute of a layer has, and how they are spread: what classes of colours are
// chosen by.
#pragma once

#include <cstddef>

#include "server/base/result.h"
#include "server/documents/document.h"

namespace trapeze {

constexpr std::size_t kMaxValues = 100;      // in one answer, the commonest
constexpr std::size_t kMaxValueBytes = 256;  // longer texts are left out
constexpr std::size_t kQuantileSteps = 256;  // from the least value to the greatest

/// /values/{layer}/{attribute}?bbox=: the values of the features that a request in the same style
/// draws, and that touch the box. "values" are the commonest with their counts, those of equal
/// counts in ascending order; "quantiles", of numbers, are ascending, from the least to the
/// greatest.
Result<Document> values_document(const DocumentRequest& request);

}  // namespace trapeze
