// Records of comma-separated values (RFC 4180), also with semicolons or tabs, as spreadsheets write
// and copy them.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace trapeze {

/// What parts the fields: a tab if the first line has one outside of quotes, else a semicolon if it
/// has one, else a comma.
char find_delimiter(std::string_view text);

class CsvReader {
 public:
  /// `text` outlives the reader.
  CsvReader(std::string_view text, char delimiter) : text_(text), delimiter_(delimiter) {}

  /// Reads the next record that is no empty line; false if there is none. The problem, 400, is a
  /// quote that is not closed or stands where none may, or more than kMaxFields.
  Result<bool> next();

  /// Of the record that was read, without quotes; until the next one is.
  std::span<const std::string> fields() const { return {fields_.data(), count_}; }
  /// The line on which it begins, from 1.
  std::size_t line() const { return line_; }

  static constexpr std::size_t kMaxFields = 1000;  // of one record

 private:
  bool ends_field(char c) const { return c == delimiter_ || c == '\n' || c == '\r'; }
  std::string* new_field();
  bool read_quoted(std::string& field);
  Problem malformed(std::string_view what) const;

  std::string_view text_;  // what is left
  char delimiter_;
  std::vector<std::string> fields_;  // kept for their memory
  std::size_t count_ = 0;
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
};

}  // namespace trapeze
