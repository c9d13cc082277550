#include "core/layer_builder.h"
