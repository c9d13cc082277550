#include "server/values/json_rows.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "server/base/json_text.h"
#include "server/base/trimmed.h"

namespace trapeze {
namespace {

/// The form of the rows of a document; all rows of a document have the same form.
enum class Form : std::uint8_t {
  unknown,  // nothing has been read yet
  members,  // {"FRA": 1, "DEU": 2}
  list,     // [ ... ], with no row read yet
  objects,  // [{"A3": "FRA", "area": 1}, ...]
  pairs,    // [["FRA", 1], ...]
};

/// Handles the events of a parser; returning false from any of them ends the parsing.
class RowHandler {
 public:
  RowHandler(ValueNames columns, std::size_t max_rows)
      : columns_(std::move(columns)), max_rows_(max_rows) {}

  bool null() { return take({}); }
  bool boolean(bool value) { return take(value ? "true" : "false"); }
  bool number_integer(std::int64_t value) { return take(fmt::format("{}", value)); }
  bool number_unsigned(std::uint64_t value) { return take(fmt::format("{}", value)); }
  // As written, so that a number with many digits is not rounded.
  bool number_float(double /*value*/, const std::string& text) { return take(text); }
  bool string(std::string& value) { return take(std::move(value)); }
  bool binary(nlohmann::json::binary_t& /*value*/) { return false; }

  bool key(std::string& name) {
    if (depth_ == 1) {
      key_ = std::move(name);  // of a member of the outermost object
      return true;
    }
    name_ = std::move(name);
    return true;
  }

  bool start_object(std::size_t /*size*/) {
    if (depth_ == 0) return begin(Form::members);
    if (depth_ != 1 || !is_row_of(Form::objects)) return nested();
    return begin_row();
  }
  bool end_object() { return end(); }
  bool start_array(std::size_t /*size*/) {
    if (depth_ == 0) return begin(Form::list);
    if (depth_ != 1 || !is_row_of(Form::pairs)) return nested();
    return begin_row();
  }
  bool end_array() { return end(); }

  bool parse_error(std::size_t /*position*/, const std::string& /*last_token*/,
                   const nlohmann::json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 5: syntax error ..."
    std::string_view what = error.what();
    const std::size_t place = what.find("line ");
    const std::size_t bracket = what.find("] ");
    if (place != std::string_view::npos) {
      what = what.substr(place);
    } else if (bracket != std::string_view::npos) {
      what = what.substr(bracket + 2);
    }
    return fail(fmt::format("The body is not JSON: {}.", echoed(std::string(what))));
  }

  Result<ValueTable> finish() && {
    if (problem_) return std::move(*problem_);
    if (!builder_) return Problem{400, "The table is empty."};
    if (form_ == Form::objects && !has_values_) return no_values();
    return std::move(*builder_).finish();
  }

 private:
  bool fail(std::string detail) {
    if (!problem_) problem_ = Problem{400, std::move(detail)};
    return false;
  }
  bool nested() {
    return fail(
        fmt::format("Row {} of the table has nested data: a table is an array of objects with a "
                    "key and a value, an array of pairs, or one object that maps keys to values.",
                    row_ + 1));
  }

  bool begin(Form form) {
    form_ = form;
    ++depth_;
    return true;
  }
  bool is_row_of(Form form) {
    if (form_ == Form::list) form_ = form;
    return form_ == form;
  }
  bool begin_row() {
    ++depth_;
    ++row_;
    members_ = 0;
    key_text_.reset();
    value_text_.reset();
    return true;
  }

  /// A value that is neither array nor object.
  bool take(std::string text) {
    if (depth_ == 0) return fail("A table is an array or an object.");
    if (depth_ == 1) {
      if (form_ != Form::members) return nested();
      ++row_;
      return add(key_, text);
    }
    return form_ == Form::pairs ? take_item(std::move(text)) : take_member(std::move(text));
  }

  bool take_item(std::string text) {
    if (members_ == 2) {
      return fail(fmt::format("Row {} of the table has more than a key and a value.", row_));
    }
    (members_++ == 0 ? key_text_ : value_text_) = std::move(text);
    return true;
  }

  // If the columns have no names, the first members name them: the key in the first row, the value
  // in the first row that has one, since many programs leave out members that are null.
  bool take_member(std::string text) {
    if (columns_.key.empty() && name_ != columns_.value) {
      columns_.key = name_;
    } else if (columns_.value.empty() && name_ != columns_.key) {
      columns_.value = name_;
      if (builder_) builder_->name_values(name_of(columns_.value, "value"));
    }
    const bool is_key = name_ == columns_.key;
    if (!is_key && name_ != columns_.value) return true;
    has_values_ |= !is_key;
    auto& place = is_key ? key_text_ : value_text_;
    if (place) return fail(fmt::format("Row {} of the table has \"{}\" twice.", row_, name_));
    place = std::move(text);
    return true;
  }

  bool end() {
    if (--depth_ == 0) return true;
    if (!key_text_) {
      return fail(form_ == Form::pairs
                      ? fmt::format("Row {} of the table is empty.", row_)
                      : fmt::format("Row {} of the table has no \"{}\".", row_, columns_.key));
    }
    if (!value_text_ && form_ == Form::pairs) {
      return fail(fmt::format("Row {} of the table has a key and no value.", row_));
    }
    // A missing member counts as null.
    return add(*key_text_, value_text_.value_or(std::string()));
  }

  static std::string name_of(const std::string& given, const char* usual) {
    constexpr std::size_t kMaxNameBytes = 128;
    return std::string(given.empty() ? usual : cut_to_bytes(given, kMaxNameBytes));
  }

  /// A table without a single value has most likely a mistyped column.
  Problem no_values() const {
    if (columns_.value.empty()) {
      return {400, fmt::format("No row of the table has a value beside \"{}\".", columns_.key)};
    }
    return {400, fmt::format("No row of the table has \"{}\".", columns_.value), "value",
            columns_.value, "the name of a member of the rows"};
  }

  bool add(std::string_view key, std::string_view value) {
    if (!builder_) {
      builder_.emplace(ValueNames{name_of(columns_.key, "key"), name_of(columns_.value, "value")},
                       max_rows_);
    }
    auto problem = builder_->add(key, value, row_);
    if (problem) problem_ = std::move(problem);
    return !problem_;
  }

  ValueNames columns_;
  const std::size_t max_rows_;
  std::optional<ValueTableBuilder> builder_;  // from the first row on
  std::optional<Problem> problem_;
  Form form_ = Form::unknown;
  int depth_ = 0;
  std::size_t row_ = 0;
  bool has_values_ = false;  // in Form::objects: whether a row had the value, even if null
  // For the row that is being read:
  std::string key_;   // in Form::members
  std::string name_;  // of a member
  int members_ = 0;
  std::optional<std::string> key_text_;
  std::optional<std::string> value_text_;
};

}  // namespace

Result<ValueTable> read_json_rows(std::string_view text, const ValueNames& columns,
                                  std::size_t max_rows) {
  RowHandler handler(columns, max_rows);
  nlohmann::json::sax_parse(text, &handler);
  return std::move(handler).finish();
}

}  // namespace trapeze
