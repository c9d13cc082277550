// What of a source is taken.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace trapeze {

struct SourceSelection {
  std::string layer = {};  // the only layer, or table, that is read; empty: all of the source
  /// A condition on features in SQL, as GDAL knows it; of a database, as the database does. It is
  /// for the operator to write, never for those who ask for tiles. Empty: all features.
  std::string where = {};
  std::optional<std::vector<std::string>> attributes = {};  // those that are kept; unset: all

  bool is_all() const { return layer.empty() && where.empty() && !attributes; }
};

}  // namespace trapeze
