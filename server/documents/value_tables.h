// Tables of values: what a table holds, and how it fits the layers that are served.
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

/// What the query of POST /values, or of /values/{table}, says.
struct TableQuery {
  ValueNames columns;                // of the body; empty: the first two
  std::optional<std::string> layer;  // to be joined; unset: all that can be
  std::string join;                  // the attribute that is the key; empty: called as the column
};
/// The problem, 400, is a parameter that there is not, or is given twice.
Result<TableQuery> parse_table_query(const std::vector<QueryPair>& query);

/// The table, and for each layer that is asked for how many rows and features match, with the first
/// keys that do not. The problem is a layer that there is not, or that has no such attribute.
Result<Document> table_document(std::string_view id, const std::shared_ptr<const ValueTable>& table,
                                const TableQuery& query, const Dataset& dataset,
                                const std::string& base_url);

/// /values: the tables of the configuration; /values/{table}: one of them, or one that was posted.
Result<Document> value_tables_document(const DocumentRequest& request);

}  // namespace trapeze
