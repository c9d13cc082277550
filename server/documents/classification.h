// How values were divided into classes, and how a table matches a layer, for documents.
//
// Thread-safety: any thread.
#pragma once

#include "server/base/json_text.h"
#include "server/tiles/layer_style.h"

namespace trapeze {

/// The attribute and the rule, the breaks, the number of values, and for joined values the keys
/// that match nothing. Null for a style that neither classes numbers nor joins values.
Json classification_json(const LayerStyle& style);

}  // namespace trapeze
