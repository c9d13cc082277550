#include "server/styles/filter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <compare>
#include <optional>

#include "server/base/url.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 9> kKeywords = {"AND",  "OR", "NOT",  "IN",  "BETWEEN",
                                                       "LIKE", "IS", "NULL", "TRUE"};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_letter(char c) {
  // UTF-8 bytes beyond ASCII also count as letters of names.
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 32);
  }
  return result;
}

bool is_keyword(std::string_view word) {
  const std::string name = upper(word);
  return name == "FALSE" || std::ranges::find(kKeywords, name) != kKeywords.end();
}

enum class TokenKind { end, word, name, text, number, symbol };

struct Token {
  TokenKind kind = TokenKind::end;
  std::string text;  // unquoted; keywords are in upper case
  std::size_t position = 0;
};

/// Aborts the parsing; caught where it starts.
struct ParseError {
  std::string what;
};

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Token next() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    const std::size_t begin = at_;
    if (at_ == text_.size()) return {TokenKind::end, {}, begin};
    const char c = text_[at_];
    if (c == '\'') return {TokenKind::text, quoted('\''), begin};
    if (c == '"') return {TokenKind::name, quoted('"'), begin};
    if (is_letter(c)) return word();
    const bool is_signed = (c == '-' || c == '+') && at_ + 1 < text_.size();
    const char digit = is_signed ? text_[at_ + 1] : c;
    if (is_digit(digit) || digit == '.') return number();
    return symbol();
  }

 private:
  /// A quote inside is doubled.
  std::string quoted(char quote) {
    const std::size_t begin = at_++;
    std::string content;
    while (at_ < text_.size()) {
      const char c = text_[at_++];
      if (has_control_character({&c, 1})) {
        throw ParseError{fmt::format("at byte {} there is a control character", at_)};
      }
      if (c != quote) {
        content += c;
      } else if (at_ < text_.size() && text_[at_] == quote) {
        content += quote;
        ++at_;
      } else {
        return content;
      }
    }
    throw ParseError{fmt::format("the quote at byte {} is not closed", begin + 1)};
  }

  Token word() {
    const std::size_t begin = at_;
    const auto is_part = [](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == ':'; };
    while (at_ < text_.size() && is_part(text_[at_])) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (is_keyword(word)) return {TokenKind::word, upper(word), begin};
    return {TokenKind::name, std::string(word), begin};
  }

  Token number() {
    const std::size_t begin = at_;
    const auto is_part = [&](char c) {
      const char before = at_ > begin ? text_[at_ - 1] : '\0';
      return is_digit(c) || c == '.' || is_letter(c) ||
             ((c == '-' || c == '+') && (at_ == begin || before == 'e' || before == 'E'));
    };
    while (at_ < text_.size() && is_part(text_[at_])) ++at_;
    return {TokenKind::number, std::string(text_.substr(begin, at_ - begin)), begin};
  }

  Token symbol() {
    const std::size_t begin = at_;
    for (const std::string_view two : {"<=", ">=", "<>"}) {
      if (text_.substr(at_, 2) == two) {
        at_ += 2;
        return {TokenKind::symbol, std::string(two), begin};
      }
    }
    return {TokenKind::symbol, std::string(1, text_[at_++]), begin};
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::optional<FilterLiteral> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* end = text.data() + text.size();
  std::int64_t integer = 0;
  const auto [integer_end, integer_error] = std::from_chars(text.data(), end, integer);
  if (integer_error == std::errc() && integer_end == end) return integer;
  double real = 0;
  const auto [real_end, real_error] = std::from_chars(text.data(), end, real);
  if (real_error != std::errc() || real_end != end || !std::isfinite(real)) return std::nullopt;
  // A number with an integral value is an integer, however it is written.
  constexpr double kTooLarge = 9223372036854775808.0;  // 2^63
  if (real >= -kTooLarge && real < kTooLarge && real == std::trunc(real)) {
    return static_cast<std::int64_t>(real);
  }
  return real;
}

// ---- from a node to its text

std::string text_of_literal(const FilterLiteral& literal) {
  if (const auto* integer = std::get_if<std::int64_t>(&literal)) return fmt::format("{}", *integer);
  if (const auto* real = std::get_if<double>(&literal)) return fmt::format("{}", *real);
  return single_quoted(std::get<std::string>(literal));
}

std::string text_of_name(const std::string& name) {
  const bool is_plain = !name.empty() && is_letter(name.front()) && !is_keyword(name) &&
                        std::ranges::all_of(name, [](char c) {
                          return is_letter(c) || is_digit(c) || c == '.' || c == ':';
                        });
  if (is_plain) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string_view symbol_of(FilterOperator op) {
  switch (op) {
    case FilterOperator::equal:
      return "=";
    case FilterOperator::unequal:
      return "<>";
    case FilterOperator::less:
      return "<";
    case FilterOperator::less_equal:
      return "<=";
    case FilterOperator::greater:
      return ">";
    case FilterOperator::greater_equal:
      return ">=";
    case FilterOperator::like:
      return " LIKE ";
    default:
      return "";
  }
}

std::string text_of(const FilterNode& node);

std::string text_of_operands(const FilterNode& node, std::string_view joint) {
  std::string text;
  for (const FilterNode& operand : node.operands) {
    if (!text.empty()) text += joint;
    const bool is_list = operand.op == FilterOperator::all || operand.op == FilterOperator::any;
    text += is_list ? "(" + text_of(operand) + ")" : text_of(operand);
  }
  return text;
}

std::string text_of(const FilterNode& node) {
  switch (node.op) {
    case FilterOperator::all:
      return text_of_operands(node, " AND ");
    case FilterOperator::any:
      return text_of_operands(node, " OR ");
    case FilterOperator::negated:
      return "NOT " + text_of_operands(node, "");
    case FilterOperator::is_null:
      return text_of_name(node.property) + " IS NULL";
    case FilterOperator::between:
      return fmt::format("{} BETWEEN {} AND {}", text_of_name(node.property),
                         text_of_literal(node.literals[0]), text_of_literal(node.literals[1]));
    case FilterOperator::in: {
      std::string list;
      for (const FilterLiteral& literal : node.literals) {
        list += (list.empty() ? "" : ",") + text_of_literal(literal);
      }
      return fmt::format("{} IN ({})", text_of_name(node.property), list);
    }
    default:
      return fmt::format("{}{}{}", text_of_name(node.property), symbol_of(node.op),
                         text_of_literal(node.literals[0]));
  }
}

// ---- from a text to a node

/// Joins nodes with AND or OR: nested nodes of the same kind are merged, then all are sorted
/// without duplicates.
FilterNode joined(FilterOperator op, std::vector<FilterNode> nodes) {
  std::vector<std::pair<std::string, FilterNode>> operands;
  for (FilterNode& node : nodes) {
    if (node.op == op) {
      for (FilterNode& inner : node.operands)
        operands.emplace_back(text_of(inner), std::move(inner));
    } else {
      std::string text = text_of(node);
      operands.emplace_back(std::move(text), std::move(node));
    }
  }
  std::ranges::stable_sort(operands, {}, &std::pair<std::string, FilterNode>::first);
  FilterNode result;
  result.op = op;
  const std::string* last = nullptr;
  for (auto& [text, node] : operands) {
    if (last != nullptr && *last == text) continue;
    last = &text;
    result.operands.push_back(std::move(node));
  }
  if (result.operands.size() == 1) return std::move(result.operands.front());
  return result;
}

FilterNode negation(FilterNode node) {
  if (node.op == FilterOperator::negated) return std::move(node.operands.front());
  FilterNode result;
  result.op = FilterOperator::negated;
  result.operands.push_back(std::move(node));
  return result;
}

/// The operator with its operands swapped.
FilterOperator mirrored(FilterOperator op) {
  switch (op) {
    case FilterOperator::less:
      return FilterOperator::greater;
    case FilterOperator::less_equal:
      return FilterOperator::greater_equal;
    case FilterOperator::greater:
      return FilterOperator::less;
    case FilterOperator::greater_equal:
      return FilterOperator::less_equal;
    default:
      return op;
  }
}

/// Recursive descent, one function for each rule of the grammar. Throws ParseError.
class Parser {
 public:
  explicit Parser(std::string_view text) : lexer_(text) { advance(); }

  FilterNode parse() {
    FilterNode node = disjunction();
    if (token_.kind != TokenKind::end) fail("AND, OR or the end");
    return node;
  }

 private:
  void advance() { token_ = lexer_.next(); }

  [[noreturn]] void fail(std::string_view expected) const {
    if (token_.kind == TokenKind::end) {
      throw ParseError{fmt::format("at its end {} is missing", expected)};
    }
    throw ParseError{fmt::format("at byte {}, expected {}", token_.position + 1, expected)};
  }

  bool is(TokenKind kind, std::string_view text) const {
    return token_.kind == kind && token_.text == text;
  }
  bool take(TokenKind kind, std::string_view text) {
    if (!is(kind, text)) return false;
    advance();
    return true;
  }
  void expect(TokenKind kind, std::string_view text) {
    if (!take(kind, text)) fail(text);
  }

  FilterNode disjunction() {
    std::vector<FilterNode> nodes;
    do {
      nodes.push_back(conjunction());
    } while (take(TokenKind::word, "OR"));
    return joined(FilterOperator::any, std::move(nodes));
  }

  FilterNode conjunction() {
    std::vector<FilterNode> nodes;
    do {
      nodes.push_back(condition());
    } while (take(TokenKind::word, "AND"));
    return joined(FilterOperator::all, std::move(nodes));
  }

  FilterNode condition() {
    if (++depth_ > kMaxFilterDepth) {
      throw ParseError{fmt::format("it is nested more than {} levels deep", kMaxFilterDepth)};
    }
    FilterNode node = take(TokenKind::word, "NOT") ? negation(condition()) : primary();
    --depth_;
    return node;
  }

  FilterNode primary() {
    if (take(TokenKind::symbol, "(")) {
      FilterNode node = disjunction();
      expect(TokenKind::symbol, ")");
      return node;
    }
    if (token_.kind == TokenKind::name) return about_property();
    return about_literal();
  }

  FilterNode about_literal() {
    FilterLiteral value = literal("an attribute, a literal, NOT or (");
    FilterNode node;
    node.op = mirrored(comparison());
    node.literals.push_back(std::move(value));
    node.property = property();
    return node;
  }

  FilterNode about_property() {
    FilterNode node;
    node.property = property();
    if (take(TokenKind::word, "IS")) {
      const bool is_not = take(TokenKind::word, "NOT");
      expect(TokenKind::word, "NULL");
      node.op = FilterOperator::is_null;
      return is_not ? negation(std::move(node)) : node;
    }
    const bool is_not = take(TokenKind::word, "NOT");
    if (take(TokenKind::word, "IN")) {
      read_list(node);
    } else if (take(TokenKind::word, "BETWEEN")) {
      node.op = FilterOperator::between;
      node.literals.push_back(literal("a literal"));
      expect(TokenKind::word, "AND");
      node.literals.push_back(literal("a literal"));
    } else if (take(TokenKind::word, "LIKE")) {
      node.op = FilterOperator::like;
      if (token_.kind != TokenKind::text) fail("a pattern in single quotes");
      node.literals.push_back(literal("a pattern"));
    } else if (is_not) {
      fail("IN, BETWEEN or LIKE");
    } else {
      node.op = comparison();
      node.literals.push_back(literal("a literal"));
    }
    return is_not ? negation(std::move(node)) : node;
  }

  void read_list(FilterNode& node) {
    node.op = FilterOperator::in;
    expect(TokenKind::symbol, "(");
    do {
      node.literals.push_back(literal("a literal"));
    } while (take(TokenKind::symbol, ","));
    expect(TokenKind::symbol, ")");
    std::ranges::sort(node.literals);
    node.literals.erase(std::unique(node.literals.begin(), node.literals.end()),
                        node.literals.end());
  }

  std::string property() {
    if (token_.kind != TokenKind::name) fail("an attribute");
    std::string name = std::move(token_.text);
    advance();
    return name;
  }

  FilterOperator comparison() {
    constexpr std::array kComparisons = {FilterOperator::equal,   FilterOperator::unequal,
                                         FilterOperator::less,    FilterOperator::less_equal,
                                         FilterOperator::greater, FilterOperator::greater_equal};
    for (const FilterOperator op : kComparisons) {
      if (take(TokenKind::symbol, symbol_of(op))) return op;
    }
    fail("=, <>, <, <=, >, >=, IN, BETWEEN, LIKE or IS NULL");
  }

  FilterLiteral literal(std::string_view expected) {
    if (++terms_ > kMaxFilterTerms) {
      throw ParseError{fmt::format("it has more than {} literals", kMaxFilterTerms)};
    }
    FilterLiteral value;
    if (token_.kind == TokenKind::text) {
      value = std::move(token_.text);
    } else if (token_.kind == TokenKind::number) {
      const auto number = parse_number(token_.text);
      if (!number) fail("a number that can be read");
      value = *number;
    } else if (is(TokenKind::word, "TRUE") || is(TokenKind::word, "FALSE")) {
      value = std::int64_t{token_.text == "TRUE"};
    } else {
      fail(expected);
    }
    advance();
    return value;
  }

  Lexer lexer_;
  Token token_;
  std::size_t depth_ = 0;
  std::size_t terms_ = 0;
};

// ---- evaluation

/// Exact even between an integer and a real number: long double represents all values of both.
std::partial_ordering compare(const Value& value, const FilterLiteral& literal) {
  if (const auto* text = std::get_if<std::string_view>(&value)) {
    return *text <=> std::string_view(std::get<std::string>(literal));
  }
  const auto* integer = std::get_if<std::int64_t>(&value);
  const auto* other_integer = std::get_if<std::int64_t>(&literal);
  if (integer != nullptr && other_integer != nullptr) return *integer <=> *other_integer;
  const long double a =
      integer != nullptr ? static_cast<long double>(*integer) : std::get<double>(value);
  const long double b = other_integer != nullptr ? static_cast<long double>(*other_integer)
                                                 : std::get<double>(literal);
  return a <=> b;
}

bool holds(const FilterNode& node, const Value& value) {
  const auto order = [&](std::size_t i) { return compare(value, node.literals[i]); };
  switch (node.op) {
    case FilterOperator::equal:
      return order(0) == 0;
    case FilterOperator::unequal:
      return order(0) != 0;
    case FilterOperator::less:
      return order(0) < 0;
    case FilterOperator::less_equal:
      return order(0) <= 0;
    case FilterOperator::greater:
      return order(0) > 0;
    case FilterOperator::greater_equal:
      return order(0) >= 0;
    case FilterOperator::between:
      return order(0) >= 0 && order(1) <= 0;
    case FilterOperator::in:
      return std::ranges::any_of(node.literals, [&](const FilterLiteral& literal) {
        return compare(value, literal) == 0;
      });
    default:
      return false;
  }
}

bool can_compare(const Field& field, const FilterNode& node) {
  const bool is_text = field.type == FieldType::text;
  if (node.op == FilterOperator::like && !is_text) return false;
  return std::ranges::all_of(node.literals, [is_text](const FilterLiteral& literal) {
    return std::holds_alternative<std::string>(literal) == is_text;
  });
}

}  // namespace

Filter::Filter(FilterNode root) : root_(std::move(root)), text_(text_of(root_)) {}

std::variant<std::shared_ptr<const Filter>, Filter::Mistake> Filter::parse(std::string_view text) {
  if (text.size() > kMaxFilterLength) {
    return Mistake{fmt::format("it is longer than {} bytes", kMaxFilterLength)};
  }
  try {
    const std::shared_ptr<const Filter> filter(new Filter(Parser(text).parse()));
    // The canonical text must be a valid filter, too.
    if (filter->text().size() > kMaxFilterLength) {
      return Mistake{fmt::format("its numbers make it longer than {} bytes", kMaxFilterLength)};
    }
    // It may be nested deeper: AND beside OR has parentheses in it, and NOT is a level of its own.
    Parser(filter->text()).parse();
    return filter;
  } catch (const ParseError& error) {
    return Mistake{error.what};
  }
}

Result<BoundFilter> BoundFilter::bind(std::shared_ptr<const Filter> filter, Attributes attributes) {
  auto root = bind_node(filter->root(), attributes);
  if (!root) return std::move(root).problem();
  return BoundFilter(std::move(filter), std::move(attributes), *std::move(root));
}

Result<BoundFilter::Node> BoundFilter::bind_node(const FilterNode& node,
                                                 const Attributes& attributes) {
  Node bound;
  bound.source = &node;
  for (const FilterNode& operand : node.operands) {
    auto inner = bind_node(operand, attributes);
    if (!inner) return std::move(inner).problem();
    bound.operands.push_back(*std::move(inner));
  }
  if (!node.operands.empty()) return bound;
  bound.field = attributes.field_index(node.property);
  if (bound.field < 0) return unknown_property("filter", node.property, attributes);
  const Field& field = attributes.field(bound.field);
  if (!can_compare(field, node)) {
    const std::string takes = field.type == FieldType::text ? "text in single quotes" : "a number";
    return Problem{400, fmt::format("The attribute {} is compared with {}.", field.name, takes),
                   "filter", text_of(node), takes};
  }
  if (node.op == FilterOperator::like) {
    bound.pattern.emplace(std::get<std::string>(node.literals[0]));
  }
  return bound;
}

bool BoundFilter::passes(std::uint32_t row) const {
  return evaluate(root_, row) == Truth::yes;
}

BoundFilter::Truth BoundFilter::evaluate(const Node& node, std::uint32_t row) const {
  switch (node.source->op) {
    case FilterOperator::all:
      return evaluate_all(node, row);
    case FilterOperator::any:
      return evaluate_any(node, row);
    case FilterOperator::negated: {
      const Truth inner = evaluate(node.operands.front(), row);
      if (inner == Truth::unknown) return inner;
      return inner == Truth::yes ? Truth::no : Truth::yes;
    }
    default:
      break;
  }
  const Value value = attributes_.value(row, node.field);
  const bool is_null = std::holds_alternative<std::monostate>(value);
  if (node.source->op == FilterOperator::is_null) return is_null ? Truth::yes : Truth::no;
  if (is_null) return Truth::unknown;
  const bool is_true = node.pattern ? node.pattern->matches(std::get<std::string_view>(value))
                                    : holds(*node.source, value);
  return is_true ? Truth::yes : Truth::no;
}

BoundFilter::Truth BoundFilter::evaluate_all(const Node& node, std::uint32_t row) const {
  Truth truth = Truth::yes;
  for (const Node& operand : node.operands) {
    truth = std::min(truth, evaluate(operand, row));
    if (truth == Truth::no) break;
  }
  return truth;
}

BoundFilter::Truth BoundFilter::evaluate_any(const Node& node, std::uint32_t row) const {
  Truth truth = Truth::no;
  for (const Node& operand : node.operands) {
    truth = std::max(truth, evaluate(operand, row));
    if (truth == Truth::yes) break;
  }
  return truth;
}

std::string single_quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

Problem unknown_property(std::string_view parameter, const std::string& property,
                         const Attributes& attributes) {
  constexpr std::size_t kMaxNames = 30;
  const FeatureTable& features = attributes.features();
  std::string names;
  for (std::size_t i = 0; i < features.fields().size() && i < kMaxNames; ++i) {
    names += (i == 0 ? "" : ", ") + features.fields()[i].name;
  }
  if (features.fields().size() > kMaxNames) names += ", ... (all are in /catalog)";
  if (attributes.joined() != nullptr) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", kJoinedName);
  }
  if (names.empty()) names = "none: the layer has no attributes";
  return {400, fmt::format("There is no attribute \"{}\" for {}.", property, parameter),
          std::string(parameter), property, names};
}

}  // namespace trapeze
