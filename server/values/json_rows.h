// Reads a table of keys and values from JSON, row by row, without building the document in memory.
#pragma once

#include <cstddef>
#include <string_view>

#include "server/base/result.h"
#include "server/values/value_table.h"

namespace trapeze {

/// See read_values().
Result<ValueTable> read_json_rows(std::string_view text, const ValueNames& columns,
                                  std::size_t max_rows);

}  // namespace trapeze
