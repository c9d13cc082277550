#include "core/io/load_layer.h"
