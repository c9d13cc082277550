// The attributes of all layers of a source, joined into one table.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <ogr_feature.h>

#include "core/layer/feature_table.h"

namespace trapeze {

/// Fields are joined by name, in the order in which they first occur. A field that has different
/// types in different layers becomes text. Integers, reals and text are kept as they are; dates
/// become ISO 8601 text, lists JSON, binary data hexadecimal text. Text that is not UTF-8 is
/// interpreted as ISO 8859-1.
class AttributeReader {
 public:
  /// `kept` are the names of the fields to keep; unset: all.
  explicit AttributeReader(std::optional<std::vector<std::string>> kept = {})
      : kept_(std::move(kept)) {}

  /// Adds the fields of the next layer; must precede reading the first row. Layers are numbered
  /// from 0.
  void add_layer(const OGRFeatureDefn& definition);

  const std::vector<Field>& fields() const { return fields_; }
  /// The positions, among the names to be kept, of names that no layer has.
  std::vector<std::size_t> missing() const;

  static constexpr std::size_t kNotKept = static_cast<std::size_t>(-1);
  /// For each field of a layer, its number in fields(), or kNotKept.
  const std::vector<std::size_t>& fields_of(std::size_t layer) const { return field_of_[layer]; }

  /// The values of one feature of a layer, one for each of fields(), null where the layer lacks the
  /// field. They are views of memory of the feature and of this reader, valid until the next call.
  const std::vector<Value>& read(const OGRFeature& feature, std::size_t layer);

 private:
  Value read_value(const OGRFeature& feature, int index, std::size_t field);
  Value keep_text(std::size_t field, std::string text);
  Value utf8_text(std::size_t field, const char* text);

  bool is_kept(const std::string& name) const;

  std::optional<std::vector<std::string>> kept_;
  std::vector<Field> fields_;
  std::unordered_map<std::string, std::size_t> numbers_;  // of fields_, by name
  std::vector<std::vector<std::size_t>> field_of_;        // by layer, then by index in the layer
  std::vector<Value> values_;
  std::vector<std::string> texts_;  // by field: text made for the current row
};

}  // namespace trapeze
