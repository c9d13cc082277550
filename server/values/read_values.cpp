#include "server/values/read_values.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "server/base/nearest_name.h"
#include "server/base/trimmed.h"
#include "server/values/csv_reader.h"
#include "server/values/json_rows.h"

namespace trapeze {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
constexpr std::size_t kMaxNameBytes = 128;

// The types that browsers, spreadsheets and curl use for CSV, or for anything.
constexpr std::array<std::string_view, 5> kCsvTypes = {
    "text/csv", "application/csv", "text/tab-separated-values", "text/comma-separated-values",
    "application/vnd.ms-excel"};
constexpr std::array<std::string_view, 4> kAnyTypes = {"", "text/plain", "application/octet-stream",
                                                       "application/x-www-form-urlencoded"};

std::string_view without_blanks(std::string_view text) {
  return trimmed(text, " \t\r\n");
}

std::string_view without_mark(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

/// The length of the character at the beginning of `text`; 0 if it is not valid UTF-8.
std::size_t character_length(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  // Overlong forms, surrogates, and code points beyond U+10FFFF.
  if ((first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) >= 0xa0) ||
      (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) >= 0x90)) {
    return 0;
  }
  return length;
}

/// Whether the first 8 bytes are ASCII, as in most of a table.
bool begins_with_ascii(std::string_view text) {
  std::uint64_t word = 0;
  if (text.size() < sizeof word) return false;
  std::memcpy(&word, text.data(), sizeof word);
  return (word & 0x8080808080808080) == 0;
}

/// The position of the first byte that is not valid UTF-8.
std::optional<std::size_t> find_foreign_byte(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    if (begins_with_ascii(text.substr(i))) {
      i += sizeof(std::uint64_t);
      continue;
    }
    const std::size_t length = character_length(text.substr(i));
    if (length == 0) return i;
    i += length;
  }
  return std::nullopt;
}

Problem not_utf8(std::string_view text, std::size_t byte) {
  const auto line = 1 + std::ranges::count(text.substr(0, byte), '\n');
  return {400, fmt::format("Line {} of the table is not UTF-8: save it as \"CSV UTF-8\".", line)};
}

bool is_number(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// Whether the text is a year, as which many tables name a column.
bool is_year(std::string_view text) {
  return text.size() == 4 && text >= "1800" && text <= "2199" && is_number(text);
}

/// The indexes of key and value among the columns.
struct Places {
  std::size_t key = 0;
  std::size_t value = 1;
};

Problem no_such_column(std::string_view parameter, const std::string& name,
                       const std::vector<std::string>& names) {
  constexpr std::size_t kMostNamed = 20;
  std::vector<std::string> known;
  known.reserve(names.size());
  for (const std::string& each : names) known.emplace_back(cut_to_bytes(each, kMaxNameBytes));
  const auto named = std::min(known.size(), kMostNamed);
  const std::string list = fmt::format(
      "{}{}", fmt::join(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(named), ", "),
      named < known.size() ? ", ..." : "");
  return {400,
          fmt::format("The table has no column \"{}\"{}", name, suggestion_or_stop(name, known)),
          std::string(parameter), name, list};
}

Result<Places> find_places(const std::vector<std::string>& names, const ValueNames& wanted) {
  if (names.size() < 2) {
    return Problem{400,
                   "A table needs at least two columns, a key and a value, a header line, and "
                   "commas, semicolons or tabs as separators."};
  }
  const auto find = [&names](const std::string& name) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names.begin());
  };
  Places places;
  if (!wanted.key.empty()) {
    const auto key = find(wanted.key);
    if (!key) return no_such_column("key", wanted.key, names);
    places.key = *key;
  }
  places.value = places.key == 0 ? 1 : 0;
  if (!wanted.value.empty()) {
    const auto value = find(wanted.value);
    if (!value) return no_such_column("value", wanted.value, names);
    places.value = *value;
    if (wanted.key.empty() && places.value == 0) places.key = 1;
  }
  if (places.key == places.value) {
    return Problem{400, "Key and value are the same column.", "value", wanted.value,
                   "another column than key"};
  }
  return places;
}

Result<ValueTable> read_csv(std::string_view text, const ReadValuesOptions& options) {
  const char delimiter = find_delimiter(text);
  CsvReader reader(text, delimiter);
  const auto has_names = reader.next();
  if (!has_names) return has_names.problem();
  if (!*has_names) return Problem{400, "The table is empty."};
  std::vector<std::string> names;
  for (const std::string& name : reader.fields()) {
    names.emplace_back(without_blanks(name));
  }
  const auto places = find_places(names, options.columns);
  if (!places) return places.problem();
  // Otherwise this row would be lost. A year that was asked for names a column.
  const std::string& value_name = names[places->value];
  if (is_number(value_name) && !(value_name == options.columns.value && is_year(value_name))) {
    return Problem{400, fmt::format("The first line must name the columns, but \"{}\" looks like a "
                                    "value: add a header line such as \"key,value\".",
                                    value_name)};
  }
  ValueTableBuilder builder({std::string(cut_to_bytes(names[places->key], kMaxNameBytes)),
                             std::string(cut_to_bytes(names[places->value], kMaxNameBytes))},
                            options.max_rows, delimiter == ';');
  builder.reserve(static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1, text.size());
  while (true) {
    const auto has_record = reader.next();
    if (!has_record) return has_record.problem();
    if (!*has_record) return std::move(builder).finish();
    const auto fields = reader.fields();
    if (fields.size() != names.size()) {
      return Problem{400, fmt::format("Line {} of the table has {} fields, and its first line "
                                      "has {}.",
                                      reader.line(), fields.size(), names.size())};
    }
    if (auto problem = builder.add(fields[places->key], fields[places->value], reader.line())) {
      return std::move(*problem);
    }
  }
}

}  // namespace

Result<TableFormat> table_format(std::string_view content_type, std::string_view body) {
  const std::string type = in_lower_case(without_blanks(
      content_type.substr(0, std::min(content_type.find(';'), content_type.size()))));
  const std::string parameters = in_lower_case(content_type);
  if (const std::size_t charset = parameters.find("charset="); charset != std::string::npos) {
    std::string_view name = std::string_view(parameters).substr(charset + 8);
    name = without_blanks(name.substr(0, name.find(';')));
    if (name.size() > 1 && name.starts_with('"')) name = name.substr(1, name.size() - 2);
    if (name != "utf-8" && name != "utf8" && name != "us-ascii") {
      return Problem{415, "Tables are in UTF-8.", "Content-Type", std::string(content_type),
                     "charset=utf-8"};
    }
  }
  if (std::ranges::find(kCsvTypes, type) != kCsvTypes.end()) return TableFormat::csv;
  if (type == "application/json") return TableFormat::json;
  if (std::ranges::find(kAnyTypes, type) != kAnyTypes.end()) {
    const std::string_view begin = without_blanks(without_mark(body.substr(0, 1024)));
    return begin.starts_with('[') || begin.starts_with('{') ? TableFormat::json : TableFormat::csv;
  }
  return Problem{415, "A table is CSV or JSON.", "Content-Type", std::string(content_type),
                 "text/csv or application/json"};
}

Result<ValueTable> read_values(std::string_view text, TableFormat format,
                               const ReadValuesOptions& options) {
  text = without_mark(text);
  if (const auto byte = find_foreign_byte(text)) return not_utf8(text, *byte);
  if (format == TableFormat::csv) return read_csv(text, options);
  return read_json_rows(text, options.columns, options.max_rows);
}

}  // namespace trapeze
