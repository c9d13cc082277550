#include "core/feature_table.h"
