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
  std::string layer = {};  // the only layer, or table, that is read; empty: all of the source
  /// A condition on features in SQL, as GDAL knows it; of a database, as the database does. It is
  /// written by the operator and never comes from a request. Empty: all features.
  std::string where = {};
  std::optional<std::vector<std::string>> attributes = {};  // those that are kept; unset: all
  /// Features of the only layer, each once: no others are read, and in this order. Unset: all.
  std::optional<std::vector<std::int64_t>> ids = {};

  friend bool operator==(const SourceSelection&, const SourceSelection&) = default;

  bool is_all() const { return layer.empty() && where.empty() && !attributes && !ids; }
};

enum class SelectionPart { layer, where, attributes };

/// Something selected that a source does not have.
struct SelectionProblem {
  SelectionPart part = SelectionPart::layer;
  std::size_t index = 0;  // of attributes: which of them
  std::string what;       // without the name of the source
};

/// A source lacks what is selected of it.
class SelectionError : public std::runtime_error {
 public:
  /// What it says names the source and has all problems, of which there is at least one.
  SelectionError(const std::string& source, std::vector<SelectionProblem> problems);

  const std::vector<SelectionProblem>& problems() const { return problems_; }

 private:
  std::vector<SelectionProblem> problems_;
};

}  // namespace trapeze
