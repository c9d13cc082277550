#include "server/cli/option_values.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>

#include "core/io/file/prepared_file.h"
#include "core/io/source/target_grid.h"
#include "server/base/nearest_name.h"
#include "server/base/url.h"
#include "server/config/load_config.h"
#include "server/styles/style_book.h"

namespace trapeze {
namespace {

/// Nothing if the text is not exactly one number. Infinity and NaN are not accepted.
template <typename Number>
std::optional<Number> number_in(const std::string& text, Number min, Number max) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  if (!is_number || !(number >= min && number <= max)) return std::nullopt;
  return number;
}

bool is_target_grid(const std::string& name) {
  try {
    find_target_grid(name);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// "land.trapeze" for "land.EPSG-2056.trapeze".
std::string without_grid(const std::string& file) {
  const std::filesystem::path path(file);
  return (path.parent_path() / path.stem().stem()).string() + path.extension().string();
}

[[noreturn]] void throw_wrong_number(const std::string& option, const std::string& takes,
                                     const std::string& given) {
  throw UsageError(fmt::format("{} takes {}, got \"{}\"", option, takes, given));
}

}  // namespace

void throw_wrong_word(const std::string& option, const std::string& given,
                      std::span<const std::string_view> words) {
  throw UsageError(fmt::format("{} takes {}, got \"{}\"{}", option, listed(words), given,
                               did_you_mean(given, {words.begin(), words.end()})));
}

std::string listed(std::span<const std::string_view> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text.append(i == 0 ? "" : i + 1 == words.size() ? " or " : ", ").append(words[i]);
  }
  return text;
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

void check_polygon_ending(const std::string& option, const std::string& output) {
  const std::vector<std::string> endings = {".fgb", ".gpkg", ".geojson"};
  const std::string ending = in_lower_case(std::filesystem::path(output).extension().string());
  if (std::ranges::find(endings, ending) != endings.end()) return;
  throw UsageError(
      fmt::format("{} takes a name that ends in .fgb (FlatGeobuf), .gpkg (GeoPackage) or .geojson "
                  "(GeoJSON), got \"{}\"{}",
                  option, output, did_you_mean(ending, endings)));
}

SkipLimit skip_limit_or_throw(const std::string& option, const std::string& text) {
  const auto limit = SkipLimit::parse(text);
  if (!limit) {
    throw UsageError(fmt::format("{} takes {}, got \"{}\"", option, SkipLimit::kTakes, text));
  }
  return *limit;
}

std::optional<CoverageMode> coverage_or_throw(const CoverageArguments& arguments) {
  std::optional<CoverageMode> coverage;
  if (!arguments.mode.empty()) {
    coverage = word_or_throw("--coverage", arguments.mode, kCoverageNames);
  }
  if (arguments.close_gaps.value_or(0) > 0 && coverage == CoverageMode::off) {
    throw UsageError("--close-gaps needs --coverage auto or on");
  }
  if (arguments.merge.value_or(0) > 0 && coverage == CoverageMode::off) {
    throw UsageError("--merge needs --coverage auto or on");
  }
  return coverage;
}

namespace {

void check_classes(const std::string& merge_by, std::optional<double> merge) {
  if (!merge_by.empty() && merge.value_or(0) == 0) throw UsageError("--merge-by needs --merge");
}

}  // namespace

void apply(const CoverageArguments& arguments, LayerOptions& options) {
  check_classes(arguments.merge_by, arguments.merge);
  options.coverage = coverage_or_throw(arguments).value_or(kUsualCoverage);
  options.close_gaps = arguments.close_gaps.value_or(0);
  options.merge = arguments.merge.value_or(0);
  options.merge_by = arguments.merge_by;
}

void apply(const CoverageArguments& arguments, LayerConfig& layer) {
  const std::optional<CoverageMode> coverage = coverage_or_throw(arguments);
  if (coverage) layer.coverage = coverage;
  if (arguments.close_gaps) layer.close_gaps = arguments.close_gaps;
  if (arguments.merge) layer.merge = arguments.merge;
  if (arguments.merge_by.empty()) return;
  check_classes(arguments.merge_by, layer.merge);
  layer.merge_by = arguments.merge_by;
}

void apply(const CoverageArguments& arguments, OpenOptions& options) {
  options.coverage = coverage_or_throw(arguments);
  options.close_gaps = arguments.close_gaps;
  options.merge = arguments.merge;
  check_classes(arguments.merge_by, arguments.merge);
  options.merge_by = arguments.merge_by;
}

StyleQuery style_or_throw(const std::string& query, const std::vector<std::string>& layers,
                          const Config& config) {
  const auto parameters = decode_query(query);
  if (!parameters) throw UsageError("--style takes a query string such as fill=red");
  std::vector<std::string> fonts;
  for (const auto& [name, files] : config.fonts) fonts.push_back(name);
  const auto style = StyleBook(config.styles, 0, nullptr, std::move(fonts)).read(*parameters);
  if (!style) throw_wrong_style(style.problem());
  auto of_layers = style->style_for(layers);
  if (!of_layers) throw_wrong_style(of_layers.problem());
  return *std::move(of_layers);
}

void throw_wrong_style(const Problem& problem) {
  throw UsageError("--style: " +
                   (problem.value.empty()
                        ? problem.detail
                        : fmt::format("{} Given was \"{}\".", problem.detail, problem.value)));
}

std::string grid_in_name(const std::string& file) {
  std::string word = std::filesystem::path(file).stem().extension().string();
  const std::size_t dash = word.find('-');
  if (dash == std::string::npos || !is_prepared_file(file)) return {};
  word[dash] = ':';
  const std::string name = word.substr(1);
  return is_target_grid(name) ? name : "";
}

std::vector<LayerConfig> layers_or_throw(const std::vector<std::string>& files) {
  std::vector<std::string> on_mercator;
  std::map<std::string, std::vector<std::string>> grids;  // by the file for Web Mercator
  for (const std::string& file : files) {
    const std::string grid = grid_in_name(file);
    const std::string whole = grid.empty() ? "" : without_grid(file);
    if (whole.empty() || std::ranges::find(files, whole) == files.end()) {
      on_mercator.push_back(file);
    } else {
      grids[whole].push_back(grid);
    }
  }
  try {
    std::vector<LayerConfig> layers = layers_of_files(on_mercator);
    for (LayerConfig& layer : layers) {
      const auto more = grids.find(layer.file);
      if (more == grids.end()) continue;
      layer.crs.emplace_back(kBuiltCrs);
      layer.crs.insert(layer.crs.end(), more->second.begin(), more->second.end());
    }
    return layers;
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
}

}  // namespace trapeze
