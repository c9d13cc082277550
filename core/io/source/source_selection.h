// The part of a source that is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace trapeze {

struct SourceSelection {
  std::string layer = {};  // the only layer, or table, to read; empty: all layers of the source
  /// A condition on features in SQL as GDAL supports it or, for a database, in the SQL of the
  /// database. It is written by the operator and never comes from a request. Empty: all features.
  std::string where = {};
  std::optional<std::vector<std::string>> attributes = {};  // attributes to keep; unset: all
  /// Ids of features of the only layer, each once: only these are read, in this order. Unset: all.
  std::optional<std::vector<std::int64_t>> ids = {};

  friend bool operator==(const SourceSelection&, const SourceSelection&) = default;

  bool is_all() const { return layer.empty() && where.empty() && !attributes && !ids; }
};

enum class SelectionPart { layer, where, attributes };

/// Something selected that a source does not have.
struct SelectionProblem {
  SelectionPart part = SelectionPart::layer;
  std::size_t index = 0;  // for attributes: which of them
  std::string what;       // without the name of the source
};

/// A source lacks selected content.
class SelectionError : public std::runtime_error {
 public:
  /// The message names the source and lists all problems, of which there is at least one.
  SelectionError(const std::string& source, std::vector<SelectionProblem> problems);

  const std::vector<SelectionProblem>& problems() const { return problems_; }

 private:
  std::vector<SelectionProblem> problems_;
};

}  // namespace trapeze
