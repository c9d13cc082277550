// A condition on the attributes of features, written in a subset of CQL2 text: comparisons, IN,
// BETWEEN, LIKE, IS NULL, AND, OR, NOT and parentheses over properties, strings, numbers, TRUE and
// FALSE.
//
// Text from a request becomes a Filter, whatever the data; a Filter becomes a BoundFilter for the
// fields of one layer. Null is neither true nor false, as in SQL: a feature passes only where the
// condition is true.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/layer/feature_table.h"
#include "server/base/result.h"
#include "server/styles/like_pattern.h"
#include "server/values/attributes.h"

namespace trapeze {

constexpr std::size_t kMaxFilterLength = 1024;  // bytes
constexpr std::size_t kMaxFilterDepth = 32;     // of parentheses and NOT
constexpr std::size_t kMaxFilterTerms = 256;    // literals

using FilterLiteral = std::variant<std::int64_t, double, std::string>;

enum class FilterOperator : std::uint8_t {
  all,      // of the operands
  any,      // of the operands
  negated,  // the operand
  equal,    // the property to the literal, here and below
  unequal,
  less,
  less_equal,
  greater,
  greater_equal,
  in,       // one of the literals
  between,  // the two literals, both included
  like,     // the literal, in which % stands for anything and _ for any one character
  is_null,
};

struct FilterNode {
  FilterOperator op = FilterOperator::all;
  std::vector<FilterNode> operands;  // in the order of their text, each once
  std::string property;
  std::vector<FilterLiteral> literals;
};

/// Thread-safety: immutable.
class Filter {
 public:
  /// What is wrong, for a sentence: "at byte 12 a literal is missing".
  struct Mistake {
    std::string what;
  };
  static std::variant<std::shared_ptr<const Filter>, Mistake> parse(std::string_view text);

  const FilterNode& root() const { return root_; }
  /// Equal for filters that differ only in spaces, case of keywords, parentheses, and the order of
  /// what AND, OR and IN join. Is itself a text of the filter.
  const std::string& text() const { return text_; }

 private:
  explicit Filter(FilterNode root);

  FilterNode root_;
  std::string text_;
};

/// A filter whose properties are attributes of features, or values joined to them. Refers to the
/// features, which must outlive it.
class BoundFilter {
 public:
  /// The problem, 400, names a property that there is not, with those there are, or one that is
  /// compared with what it cannot be.
  static Result<BoundFilter> bind(std::shared_ptr<const Filter> filter, Attributes attributes);

  /// The same over another table that has the same fields, without joined values.
  BoundFilter over(const FeatureTable& features) const {
    BoundFilter other = *this;
    other.attributes_ = Attributes(features);
    return other;
  }

  bool passes(std::uint32_t row) const;
  /// That of the filter.
  const std::string& text() const { return filter_->text(); }

 private:
  enum class Truth : std::uint8_t { no, unknown, yes };

  struct Node {
    const FilterNode* source = nullptr;
    int field = -1;
    std::optional<LikePattern> pattern = {};  // of LIKE
    std::vector<Node> operands;
  };

  BoundFilter(std::shared_ptr<const Filter> filter, Attributes attributes, Node root)
      : filter_(std::move(filter)), attributes_(std::move(attributes)), root_(std::move(root)) {}

  static Result<Node> bind_node(const FilterNode& node, const Attributes& attributes);
  Truth evaluate(const Node& node, std::uint32_t row) const;
  Truth evaluate_all(const Node& node, std::uint32_t row) const;
  Truth evaluate_any(const Node& node, std::uint32_t row) const;

  std::shared_ptr<const Filter> filter_;  // in which the nodes are
  Attributes attributes_;
  Node root_;
};

/// The text in single quotes; a quote in it is written twice.
std::string single_quoted(std::string_view text);

/// The problem of a parameter that names a property which the layer has not.
Problem unknown_property(std::string_view parameter, const std::string& property,
                         const Attributes& attributes);

}  // namespace trapeze
