#include "core/io/source/attribute_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <memory>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_string.h>

namespace trapeze {
namespace {

struct CplFree {
  void operator()(char* text) const { CPLFree(text); }
};
using CplText = std::unique_ptr<char, CplFree>;

FieldType type_of(OGRFieldType type) {
  if (type == OFTInteger || type == OFTInteger64) return FieldType::integer;
  if (type == OFTReal) return FieldType::real;
  return FieldType::text;
}

bool is_utf8(const char* text) {
  return CPLIsUTF8(text, -1) != 0;
}

std::string utf8_from_latin1(const char* text) {
  const CplText recoded(CPLRecode(text, CPL_ENC_ISO8859_1, CPL_ENC_UTF8));
  return recoded.get();
}

/// A Shapefile cuts names and values after a number of bytes, even within a character. Text that is
/// UTF-8 up to there, and not only ASCII, loses what is left of that character; any other text is
/// Latin-1.
std::string utf8_from_other(std::string_view text) {
  const auto byte = [text](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  std::size_t begin = text.size();  // of the last character: its first byte is 11xxxxxx
  while (begin > 0 && (byte(begin - 1) & 0xC0) == 0x80) --begin;
  if (begin > 0 && (byte(begin - 1) & 0xC0) == 0xC0) {
    const std::string whole(text.substr(0, begin - 1));
    const bool is_ascii = std::ranges::all_of(whole, [](unsigned char c) { return c < 0x80; });
    if (!is_ascii && is_utf8(whole.c_str())) return whole;
  }
  return utf8_from_latin1(std::string(text).c_str());
}

template <typename Number>
std::string shortest(Number number) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return std::string(text.data(), end);
}

/// A real as its source displays it. Of single precision, that is the shortest decimal that gives
/// the same number: 0.3, where its double is 0.30000001192092896.
double real_of(const OGRFeature& feature, int index) {
  const double number = feature.GetFieldAsDouble(index);
  const auto single = static_cast<float>(number);
  const bool is_single = feature.GetFieldDefnRef(index)->GetSubType() == OFSTFloat32;
  // GeoPackages may contain more digits than the type of their columns.
  if (!is_single || static_cast<double>(single) != number) return number;
  const std::string text = shortest(single);
  double written = number;
  std::from_chars(text.data(), text.data() + text.size(), written);
  return written;
}

// GDAL counts time zones in quarters of an hour from 100, which is UTC; 0 and 1 mean none.
std::string time_zone(int flag) {
  if (flag < 2) return {};
  if (flag == 100) return "Z";
  const int minutes = std::abs(flag - 100) * 15;
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%c%02d:%02d", flag > 100 ? '+' : '-', minutes / 60,
                minutes % 60);
  return text.data();
}

std::string iso_date(const OGRFeature& feature, int index, OGRFieldType type) {
  int year = 0;
  int month = 0;
  int day = 0;
  int hour = 0;
  int minute = 0;
  float second = 0;
  int zone = 0;
  feature.GetFieldAsDateTime(index, &year, &month, &day, &hour, &minute, &second, &zone);
  std::array<char, 32> date{};
  std::snprintf(date.data(), date.size(), "%04d-%02d-%02d", year, month, day);
  if (type == OFTDate) return date.data();
  // Otherwise rounded to a minute of 60 seconds.
  if (second > 59.999F && second < 60) second = 59.999F;
  std::array<char, 32> time{};
  const bool is_whole_second = second == static_cast<float>(static_cast<int>(second));
  std::snprintf(time.data(), time.size(), is_whole_second ? "%02d:%02d:%02.0f" : "%02d:%02d:%06.3f",
                hour, minute, static_cast<double>(second));
  if (type == OFTTime) return time.data() + time_zone(zone);
  return std::string(date.data()) + "T" + time.data() + time_zone(zone);
}

bool is_list(OGRFieldType type) {
  return type == OFTIntegerList || type == OFTInteger64List || type == OFTRealList ||
         type == OFTStringList;
}

// A value that is not text, formatted without loss.
std::string value_in_words(const OGRFeature& feature, int index, OGRFieldType type) {
  if (type == OFTInteger || type == OFTInteger64) {
    return shortest(feature.GetFieldAsInteger64(index));
  }
  if (type == OFTReal) return shortest(real_of(feature, index));
  if (type == OFTDate || type == OFTTime || type == OFTDateTime) {
    return iso_date(feature, index, type);
  }
  if (is_list(type)) {
    const CplText json(feature.GetFieldAsSerializedJSon(index));
    if (json != nullptr) return json.get();
  }
  return feature.GetFieldAsString(index);
}

}  // namespace

void AttributeReader::add_layer(const OGRFeatureDefn& definition) {
  std::vector<std::size_t>& fields = field_of_.emplace_back();
  for (int i = 0; i < definition.GetFieldCount(); ++i) {
    const OGRFieldDefn& field = *definition.GetFieldDefn(i);
    const char* raw_name = field.GetNameRef();
    const std::string name = is_utf8(raw_name) ? raw_name : utf8_from_other(raw_name);
    if (!is_kept(name)) {
      fields.push_back(kNotKept);
      continue;
    }
    const FieldType type = type_of(field.GetType());
    const auto [known, is_new] = numbers_.try_emplace(name, fields_.size());
    fields.push_back(known->second);
    if (is_new) {
      fields_.push_back({name, type});
    } else if (fields_[known->second].type != type) {
      fields_[known->second].type = FieldType::text;
    }
  }
  values_.resize(fields_.size());
  texts_.resize(fields_.size());
}

bool AttributeReader::is_kept(const std::string& name) const {
  return !kept_ || std::find(kept_->begin(), kept_->end(), name) != kept_->end();
}

std::vector<std::size_t> AttributeReader::missing() const {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; kept_ && i < kept_->size(); ++i) {
    if (!numbers_.contains((*kept_)[i])) missing.push_back(i);
  }
  return missing;
}

const std::vector<Value>& AttributeReader::read(const OGRFeature& feature, std::size_t layer) {
  std::fill(values_.begin(), values_.end(), Value());
  const std::vector<std::size_t>& fields = field_of_[layer];
  const int count = std::min(static_cast<int>(fields.size()), feature.GetFieldCount());
  for (int i = 0; i < count; ++i) {
    if (fields[i] == kNotKept) continue;
    if (feature.IsFieldSetAndNotNull(i)) values_[fields[i]] = read_value(feature, i, fields[i]);
  }
  return values_;
}

Value AttributeReader::read_value(const OGRFeature& feature, int index, std::size_t field) {
  const OGRFieldType type = feature.GetFieldDefnRef(index)->GetType();
  if (fields_[field].type == FieldType::integer) {
    return static_cast<std::int64_t>(feature.GetFieldAsInteger64(index));
  }
  if (fields_[field].type == FieldType::real) return real_of(feature, index);
  if (type == OFTString) return utf8_text(field, feature.GetFieldAsString(index));
  return keep_text(field, value_in_words(feature, index, type));
}

Value AttributeReader::keep_text(std::size_t field, std::string text) {
  texts_[field] = is_utf8(text.c_str()) ? std::move(text) : utf8_from_other(text);
  return std::string_view(texts_[field]);
}

Value AttributeReader::utf8_text(std::size_t field, const char* text) {
  if (is_utf8(text)) return std::string_view(text);
  texts_[field] = utf8_from_other(text);
  return std::string_view(texts_[field]);
}

}  // namespace trapeze
