// A condition on the attributes of features, in a subset of CQL2 text: comparisons, IN, BETWEEN,
// LIKE, IS NULL, AND, OR, NOT and parentheses over attributes, strings, numbers, TRUE and FALSE.
//
// Text from a request is parsed into a Filter, independently of the data; a Filter is bound to the
// fields of one layer as a BoundFilter. Null is neither true nor false, as in SQL: a feature passes
// only if the condition is true.
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
  equal,    // attribute and literal, here and below
  unequal,
  less,
  less_equal,
  greater,
  greater_equal,
  in,       // is one of the literals
  between,  // is between the two literals, inclusive
  like,     // matches the literal; % matches anything, _ one character
  is_null,
};

struct FilterNode {
  FilterOperator op = FilterOperator::all;
  std::vector<FilterNode> operands;  // in the order of their text, without duplicates
  std::string property;
  std::vector<FilterLiteral> literals;
};

/// Thread-safety: immutable.
class Filter {
 public:
  /// What is wrong, as part of a sentence: "at byte 12 a literal is missing".
  struct Mistake {
    std::string what;
  };
  static std::variant<std::shared_ptr<const Filter>, Mistake> parse(std::string_view text);

  const FilterNode& root() const { return root_; }
  /// Equal for filters that differ only in spaces, case of keywords, parentheses, and the order of
  /// the operands of AND, OR and IN. Can be parsed as the same filter.
  const std::string& text() const { return text_; }

 private:
  explicit Filter(FilterNode root);

  FilterNode root_;
  std::string text_;
};

/// A filter whose properties are resolved to attributes of features or values joined to them.
/// Refers to the features, which must outlive it.
class BoundFilter {
 public:
  /// The problem, 400, reports a property that does not exist, together with those that do, or a
  /// property that is compared with a value of a wrong type.
  static Result<BoundFilter> bind(std::shared_ptr<const Filter> filter, Attributes attributes);

  /// The same filter for another table with the same fields, without joined values.
  BoundFilter over(const FeatureTable& features) const {
    BoundFilter other = *this;
    other.attributes_ = Attributes(features);
    return other;
  }

  bool passes(std::uint32_t row) const;
  /// The text of the filter.
  const std::string& text() const { return filter_->text(); }

 private:
  enum class Truth : std::uint8_t { no, unknown, yes };

  struct Node {
    const FilterNode* source = nullptr;
    int field = -1;
    std::optional<LikePattern> pattern = {};  // for LIKE
    std::vector<Node> operands;
  };

  BoundFilter(std::shared_ptr<const Filter> filter, Attributes attributes, Node root)
      : filter_(std::move(filter)), attributes_(std::move(attributes)), root_(std::move(root)) {}

  static Result<Node> bind_node(const FilterNode& node, const Attributes& attributes);
  Truth evaluate(const Node& node, std::uint32_t row) const;
  Truth evaluate_all(const Node& node, std::uint32_t row) const;
  Truth evaluate_any(const Node& node, std::uint32_t row) const;

  std::shared_ptr<const Filter> filter_;  // owns the nodes
  Attributes attributes_;
  Node root_;
};

/// The text in single quotes; single quotes in it are doubled.
std::string single_quoted(std::string_view text);

/// The problem of a parameter that names a property which the layer does not have.
Problem unknown_property(std::string_view parameter, const std::string& property,
                         const Attributes& attributes);

}  // namespace trapeze
