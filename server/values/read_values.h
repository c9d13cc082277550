// Reads tables of keys and values from CSV and JSON. All input is untrusted.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/values/value_table.h"

namespace trapeze {

enum class TableFormat : std::uint8_t { csv, json };

/// Determined by the Content-Type of a request, or by the beginning of the body if the header is
/// not informative, as curl's is not. The problem, 415, is a type that cannot contain a table.
Result<TableFormat> table_format(std::string_view content_type, std::string_view body);

struct ReadValuesOptions {
  /// The names of the columns; empty: the first two, of which the first is the key.
  ValueNames columns = {};
  std::size_t max_rows = 100'000;
};

/// Reads a table in UTF-8, with or without a byte order mark.
///
/// CSV has a line of names, followed by one row per line; see CsvReader. JSON is an array of
/// objects with the columns as members, an array of arrays of a key and a value, or one object
/// whose members are keys with values. The problem, 400 or 413, says what is wrong, and where.
Result<ValueTable> read_values(std::string_view text, TableFormat format,
                               const ReadValuesOptions& options);

}  // namespace trapeze
