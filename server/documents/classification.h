// The numbers that came out where a style parts values into classes, and how a table fits a layer:
// for documents.
//
// Thread-safety: any thread.
#pragma once

#include "server/base/json_text.h"
#include "server/tiles/layer_style.h"

namespace trapeze {

/// By which attribute and rule, the breaks, how many values there are, and of joined ones which
/// keys match nothing. Null of a style that neither parts numbers nor joins any.
Json classification_json(const LayerStyle& style);

}  // namespace trapeze
