// The named tables of values of the configuration, read from their files.
//
// Thread-safety: any thread.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "server/config/config.h"
#include "server/values/value_book.h"

namespace trapeze {

/// Reads all files. Throws std::runtime_error that names the table and its file if one cannot be
/// read or is not a table.
std::shared_ptr<const NamedTables> read_named_tables(
    const std::map<std::string, ValueTableConfig>& tables);

/// What is wrong with a table, as text; empty if nothing is.
std::string find_table_problem(const ValueTableConfig& table);

}  // namespace trapeze
