// Documents about tables of values: their contents, and how they match the served layers.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/base/url.h"
#include "server/documents/document.h"
#include "server/values/read_values.h"

namespace trapeze {

/// The parameters of POST /values, or of /values/{table}.
struct TableQuery {
  ValueNames columns;                // of the body; empty: the first two
  std::optional<std::string> layer;  // to join to; unset: all possible layers
  std::string join;                  // key attribute; empty: named like the column
};
/// The problem, 400, is a parameter that is unknown or given twice.
Result<TableQuery> parse_table_query(const std::vector<QueryPair>& query);

/// The table and, for each requested layer, how many rows and features match, with the first keys
/// that do not. The problem is an unknown layer, or a layer without that attribute.
Result<Document> table_document(std::string_view id, const std::shared_ptr<const ValueTable>& table,
                                const TableQuery& query, const Dataset& dataset,
                                const std::string& base_url);

/// /values: the tables of the configuration; /values/{table}: one of them, or a posted one.
Result<Document> value_tables_document(const DocumentRequest& request);

}  // namespace trapeze
