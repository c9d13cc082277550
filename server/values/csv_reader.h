// Reads records of comma-separated values (RFC 4180), also with semicolons or tabs, as spreadsheets
// write and copy them.
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

/// The delimiter of fields: a tab if the first line contains one outside quotes, else a semicolon
/// if it contains one, else a comma.
char find_delimiter(std::string_view text);

class CsvReader {
 public:
  /// `text` must outlive the reader.
  CsvReader(std::string_view text, char delimiter) : text_(text), delimiter_(delimiter) {}

  /// Reads the next record that is not an empty line; false if there is none. The problem, 400, is
  /// a quote that is not closed or is at a wrong place, or more than kMaxFields fields.
  Result<bool> next();

  /// The fields of the current record, without quotes; valid until the next one is read.
  std::span<const std::string> fields() const { return {fields_.data(), count_}; }
  /// The line on which the record begins, from 1.
  std::size_t line() const { return line_; }

  static constexpr std::size_t kMaxFields = 1000;  // per record

 private:
  bool ends_field(char c) const { return c == delimiter_ || c == '\n' || c == '\r'; }
  std::string* new_field();
  bool read_quoted(std::string& field);
  Problem malformed(std::string_view what) const;

  std::string_view text_;  // the rest of the text
  char delimiter_;
  std::vector<std::string> fields_;  // reused to save allocations
  std::size_t count_ = 0;
  std::size_t line_ = 0;
  std::size_t next_line_ = 1;
};

}  // namespace trapeze
