#include "server/cli/option_values.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <limits>

#include "server/base/nearest_name.h"
#include "server/config/load_config.h"

namespace trapeze {
namespace {

/// Nothing if the text is no number, or holds more than one. Infinity and NaN are none.
template <typename Number>
std::optional<Number> number_in(const std::string& text, Number min, Number max) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  if (!is_number || !(number >= min && number <= max)) return std::nullopt;
  return number;
}

/// "a, b or c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  return text;
}

[[noreturn]] void throw_wrong_number(const std::string& option, const std::string& takes,
                                     const std::string& given) {
  throw UsageError(fmt::format("{} takes {}, given was \"{}\"", option, takes, given));
}

}  // namespace

void throw_wrong_word(const std::string& option, const std::string& given,
                      const std::vector<std::string>& words) {
  throw UsageError(fmt::format("{} takes {}, given was \"{}\"{}", option, listed(words), given,
                               did_you_mean(given, words)));
}

int integer_or_throw(const std::string& option, const std::string& text, int min, int max) {
  const auto number = number_in(text, min, max);
  if (!number) {
    throw_wrong_number(option, fmt::format("a whole number from {} to {}", min, max), text);
  }
  return *number;
}

double number_or_throw(const std::string& option, const std::string& text, double min, double max) {
  const auto number = number_in(text, min, max);
  if (number) return *number;
  const bool is_bounded = max < std::numeric_limits<double>::max();
  throw_wrong_number(option,
                     is_bounded ? fmt::format("a number from {} to {}", min, max)
                                : fmt::format("a number that is {} or more", min),
                     text);
}

WeightRule weights_or_throw(const std::string& name) {
  const auto rule = weight_rule_from_name(name);
  if (rule) return *rule;
  throw_wrong_word("--weights", name, {"douglas-peucker", "raised-parents", "effective-area"});
}

std::optional<CoverageMode> coverage_or_throw(const CoverageArguments& arguments) {
  const auto coverage = coverage_from_name(arguments.mode);
  if (!arguments.mode.empty() && !coverage) {
    throw_wrong_word("--coverage", arguments.mode, {"auto", "on", "off"});
  }
  if (arguments.close_gaps.value_or(0) > 0 && coverage == CoverageMode::off) {
    throw UsageError("--close-gaps needs --coverage auto or on");
  }
  return coverage;
}

void apply(const CoverageArguments& arguments, LayerOptions& options) {
  options.coverage = coverage_or_throw(arguments).value_or(kUsualCoverage);
  options.close_gaps = arguments.close_gaps.value_or(0);
}

std::vector<LayerConfig> layers_or_throw(const std::vector<std::string>& files) {
  try {
    return layers_of_files(files);
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
}

}  // namespace trapeze
