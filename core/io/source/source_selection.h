// The part of a source that is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace trapeze {

struct SourceSelection {
  std::string layer = {};  // the only layer, or table, that is read; empty: all of the source
  /// A condition on features in SQL, as GDAL knows it; of a database, as the database does. It is
  /// written by the operator and never comes from a request. Empty: all features.
  std::string where = {};
  std::optional<std::vector<std::string>> attributes = {};  // those that are kept; unset: all

  friend bool operator==(const SourceSelection&, const SourceSelection&) = default;

  bool is_all() const { return layer.empty() && where.empty() && !attributes; }
};

}  // namespace trapeze
