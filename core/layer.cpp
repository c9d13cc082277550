#include "core/layer.h"
