// Parses the values of options. All functions throw UsageError for an invalid value: it says what
// the option accepts, and suggests what may have been meant.
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

/// The command line requests something that no run of the program can do.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Refuses the value of an option that accepts one of a few words: names, or file name extensions.
[[noreturn]] void throw_wrong_word(const std::string& option, const std::string& given,
                                   std::span<const std::string_view> words);
/// The value of a word in the table.
template <typename Value, std::size_t count>
Value word_or_throw(const std::string& option, const std::string& given,
                    const NameTable<Value, count>& names) {
  if (const auto value = names.find(given)) return *value;
  throw_wrong_word(option, given, names.names());
}
/// "a, b or c".
std::string listed(std::span<const std::string_view> words);

/// An integer within the bounds, inclusive.
int integer_or_throw(const std::string& option, const std::string& text, int min, int max);
/// A number within the bounds, inclusive.
double number_or_throw(const std::string& option, const std::string& text, double min, double max);

/// Refuses the name of an output file whose extension is not one of the formats for polygons.
void check_polygon_ending(const std::string& option, const std::string& output);

/// A number of features or a share of them.
SkipLimit skip_limit_or_throw(const std::string& option, const std::string& text);

/// How polygons that share borders are treated.
struct CoverageArguments {
  /// A name from kCoverageNames; empty: as the file was prepared, or the default.
  std::string mode;
  std::optional<double> close_gaps;  // metres; unset: as the file was prepared, or 0
  std::optional<double> merge;       // pixels; unset: as the file was prepared, or 0
  std::string merge_by;              // attribute; empty: as the file was prepared, or none
};
/// Nothing if the name is empty, so that the file determines it. Refuses closing gaps and merging
/// to blocks without a coverage.
std::optional<CoverageMode> coverage_or_throw(const CoverageArguments& arguments);
/// Sets the options for a source.
void apply(const CoverageArguments& arguments, LayerOptions& options);
/// The same for a file, which may be a prepared one.
void apply(const CoverageArguments& arguments, OpenOptions& options);
/// Options that were not given stay as the layer has them.
void apply(const CoverageArguments& arguments, LayerConfig& layer);

/// A style for these layers, in the format of a URL query; it may name styles and tables of the
/// configuration.
StyleQuery style_or_throw(const std::string& query, const std::vector<std::string>& layers,
                          const Config& config = {});
/// Reports a problem with a style as a sentence for the command line.
[[noreturn]] void throw_wrong_style(const Problem& problem);

/// The reference system whose grid a prepared file is for, according to its name: "EPSG:2056" for
/// "land.EPSG-2056.trapeze", see prepared_on_grid(). Empty if the name contains none, or if the
/// file is not a prepared one.
std::string grid_in_name(const std::string& file);

/// Creates a layer for each file, named after it; names must be unique. A file prepared for another
/// grid belongs to the layer of the one for Web Mercator, if that is listed as well.
std::vector<LayerConfig> layers_or_throw(const std::vector<std::string>& files);

}  // namespace trapeze
