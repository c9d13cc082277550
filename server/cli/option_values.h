// What the values of options mean. All functions throw UsageError for a value that an option does
// not take: it says what the option takes, and what may have been meant.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/borders/coverage_options.h"
#include "core/grid/name_table.h"
#include "core/io/prepared/open_layer.h"
#include "core/layer/layer_options.h"
#include "server/base/problem.h"
#include "server/config/config.h"
#include "server/styles/style_parameters.h"

namespace trapeze {

/// The command line asks for what no run of the program can do.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Refuses the value of an option that takes one of a few words: names, or endings of files.
[[noreturn]] void throw_wrong_word(const std::string& option, const std::string& given,
                                   std::span<const std::string_view> words);
/// What a word of the table stands for.
template <typename Value, std::size_t count>
Value word_or_throw(const std::string& option, const std::string& given,
                    const NameTable<Value, count>& names) {
  if (const auto value = names.find(given)) return *value;
  throw_wrong_word(option, given, names.names());
}
/// "a, b or c".
std::string listed(std::span<const std::string_view> words);

/// A whole number within the bounds, both included.
int integer_or_throw(const std::string& option, const std::string& text, int min, int max);
/// A number within the bounds, both included.
double number_or_throw(const std::string& option, const std::string& text, double min, double max);

/// Refuses the name of an output that is in none of the formats that polygons are written in.
void check_polygon_ending(const std::string& option, const std::string& output);

/// A number of features or a share of them.
SkipLimit skip_limit_or_throw(const std::string& option, const std::string& text);

/// What is done about polygons that share borders.
struct CoverageArguments {
  /// A name of kCoverageNames; empty: as the file was prepared, or the default.
  std::string mode;
  std::optional<double> close_gaps;  // metres; unset: as the file was prepared, or 0
  std::optional<double> merge;       // pixels; unset: as the file was prepared, or 0
  std::string merge_by;              // attribute; empty: as the file was prepared, or none
};
/// None if the name is empty, which leaves it to the file. Gaps are not closed without a coverage,
/// and nothing becomes a block.
std::optional<CoverageMode> coverage_or_throw(const CoverageArguments& arguments);
/// Sets what is to become of a source.
void apply(const CoverageArguments& arguments, LayerOptions& options);
/// The same of a file, which may be a prepared one.
void apply(const CoverageArguments& arguments, OpenOptions& options);
/// What is not said stays as the layer has it.
void apply(const CoverageArguments& arguments, LayerConfig& layer);

/// A style for these layers, written as in the query of a URL; it may name what the configuration
/// has.
StyleQuery style_or_throw(const std::string& query, const std::vector<std::string>& layers,
                          const Config& config = {});
/// A problem with a style as a sentence for the command line.
[[noreturn]] void throw_wrong_style(const Problem& problem);

/// The system whose grid a prepared file is for, as its name says: "EPSG:2056" of
/// "land.EPSG-2056.trapeze", see prepared_on_grid(). Empty if it says none, or the file is no
/// prepared one.
std::string grid_in_name(const std::string& file);

/// A layer of each file, named after it, each name once. A file that was prepared for another grid
/// belongs to the layer of the one for Web Mercator, if that is named as well.
std::vector<LayerConfig> layers_or_throw(const std::vector<std::string>& files);

}  // namespace trapeze
