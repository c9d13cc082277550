// Values of style parameters, including the language of filters, colours, dashes and classes: the
// text of an accepted value parses to the same value, and filters treat both in the same way.
//
// Input: a byte that selects the parameter, then the text.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/layer/feature_table.h"
#include "server/styles/filter.h"
#include "server/styles/style_parameters.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::require;

const FeatureTable& features() {
  static const FeatureTable features = [] {
    FeatureTable table({{"name", FieldType::text},
                        {"n", FieldType::integer},
                        {"x", FieldType::real},
                        {"a b\"c", FieldType::text}});
    const std::array<std::string_view, 4> names = {"", "O'Hara", "K\xc3\xb6ln_%", "\xff\xfe"};
    for (std::int64_t i = 0; i < 8; ++i) {
      const Value name = i == 7 ? Value() : Value(names[static_cast<std::size_t>(i) % 4]);
      const Value number = i % 3 == 0 ? Value() : Value((i - 4) << (8 * i));
      table.append(i, std::vector<Value>{name, number, static_cast<double>(i) / 3, name});
    }
    return table;
  }();
  return features;
}

using SharedFilter = std::shared_ptr<const Filter>;

void check_same(const SharedFilter& filter, const SharedFilter& again) {
  const auto bound = BoundFilter::bind(filter, features());
  const auto bound_again = BoundFilter::bind(again, features());
  require(static_cast<bool>(bound) == static_cast<bool>(bound_again),
          "a filter fits, but not its own text");
  if (!bound) {
    require(bound.problem().status == 400 && !bound.problem().takes.empty(),
            "a filter is refused without words");
    return;
  }
  for (std::uint32_t row = 0; row < features().size(); ++row) {
    require(bound->passes(row) == bound_again->passes(row),
            "a filter and its own text do not let the same pass");
  }
}

void check_filter(const SharedFilter& filter) {
  require(filter->text().size() <= kMaxFilterLength, "a filter has a text that is too long");
  const auto again = Filter::parse(filter->text());
  require(again.index() == 0, "the text of a filter is no filter");
  check_same(filter, std::get<0>(again));
  // No row passes both a filter and its negation.
  const auto negated = Filter::parse("NOT (" + filter->text() + ")");
  if (negated.index() != 0) return;  // nested too deep, or too long
  const auto bound = BoundFilter::bind(filter, features());
  const auto bound_negated = BoundFilter::bind(std::get<0>(negated), features());
  require(static_cast<bool>(bound) == static_cast<bool>(bound_negated),
          "a filter fits, but not its negation");
  if (!bound) return;
  for (std::uint32_t row = 0; row < features().size(); ++row) {
    require(!bound->passes(row) || !bound_negated->passes(row),
            "a filter and its negation let the same pass");
  }
}

void check(const StyleParameter& parameter, std::string_view text) {
  const auto value = parse_parameter(parameter, text);
  if (!value) {
    require(!describe_values(parameter).empty(), "a value is refused without words");
    return;
  }
  const std::string formatted = format_value(*value);
  const auto again = parse_parameter(parameter, formatted);
  require(again.has_value(), "the text of a value is refused");
  require(format_value(*again) == formatted, "the text of a value has another text");
  if (const auto* filter = std::get_if<std::shared_ptr<const Filter>>(&*value)) {
    check_filter(*filter);
  } else {
    require(*again == *value, "the text of a value is another value");
  }
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto parameters = trapeze::style_parameters();
  trapeze::check(parameters[data[0] % parameters.size()],
                 trapeze::fuzzing::text_of(data + 1, size - 1));
  return 0;
}
