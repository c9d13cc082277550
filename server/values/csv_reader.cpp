#include "server/values/csv_reader.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace trapeze {

char find_delimiter(std::string_view text) {
  bool is_quoted = false;
  bool has_semicolon = false;
  text.remove_prefix(std::min(text.find_first_not_of("\r\n"), text.size()));  // as next() does
  for (const char c : text) {
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    if (c == '\n' || c == '\r') break;
    if (c == '\t') return c;
    has_semicolon = has_semicolon || c == ';';
  }
  return has_semicolon ? ';' : ',';
}

Result<bool> CsvReader::next() {
  while (!text_.empty() && (text_.front() == '\n' || text_.front() == '\r')) {
    if (text_.front() == '\n') ++next_line_;
    text_.remove_prefix(1);
  }
  count_ = 0;
  line_ = next_line_;
  if (text_.empty()) return false;
  while (true) {
    std::string* field = new_field();
    if (field == nullptr) {
      return malformed(fmt::format("has more than {} fields", kMaxFields));
    }
    if (text_.starts_with('"')) {
      if (!read_quoted(*field)) return malformed("has a quote that is not closed");
    } else {
      std::size_t end =
          0;  // a loop, because find_first_of() is several times slower for single characters
      while (end < text_.size() && !ends_field(text_[end])) ++end;
      field->assign(text_.substr(0, end));
      text_.remove_prefix(end);
    }
    if (text_.empty()) return true;
    const char end = text_.front();
    text_.remove_prefix(1);
    if (end == '\n') ++next_line_;
    if (end == '\n') return true;
    if (end == '\r') {
      if (text_.starts_with('\n')) {
        text_.remove_prefix(1);
        ++next_line_;
      }
      return true;
    }
    if (end != delimiter_) return malformed("has something after the quote that closes a field");
  }
}

/// Null if there are too many.
std::string* CsvReader::new_field() {
  if (count_ == kMaxFields) return nullptr;
  if (count_ == fields_.size()) fields_.emplace_back();
  return &fields_[count_++];
}

/// Reads from the opening quote to after the closing one; a quote inside is doubled.
bool CsvReader::read_quoted(std::string& field) {
  field.clear();
  text_.remove_prefix(1);
  while (true) {
    const std::size_t quote = text_.find('"');
    if (quote == std::string_view::npos) return false;
    const std::string_view part = text_.substr(0, quote);
    field += part;
    next_line_ += static_cast<std::size_t>(std::ranges::count(part, '\n'));
    text_.remove_prefix(quote + 1);
    if (!text_.starts_with('"')) return true;
    field += '"';
    text_.remove_prefix(1);
  }
}

Problem CsvReader::malformed(std::string_view what) const {
  return {400, fmt::format("Line {} of the table {}.", line_, what)};
}

}  // namespace trapeze
