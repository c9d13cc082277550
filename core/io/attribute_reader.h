// The attributes of all layers of a source, joined into one table.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <ogr_feature.h>

#include "core/feature_table.h"

namespace trapeze {

/// Fields are joined by name, in the order in which they are met; a field that is of different
/// types in different layers becomes text. Whole numbers, reals and text are kept as they are;
/// dates become ISO 8601 text, lists JSON, binary hexadecimal. Text that is no UTF-8 is taken for
/// ISO 8859-1.
class AttributeReader {
 public:
  /// Adds the fields of the next layer, before the first row is read; layers count from 0.
  void add_layer(const OGRFeatureDefn& definition);

  const std::vector<Field>& fields() const { return fields_; }
  /// For each field of a layer, its number in fields().
  const std::vector<std::size_t>& fields_of(std::size_t layer) const { return field_of_[layer]; }

  /// The values of one feature of a layer, one for each of fields(), null where the layer lacks
  /// the field. They look at memory of the feature and of this reader, until the next call.
  const std::vector<Value>& read(const OGRFeature& feature, std::size_t layer);

 private:
  Value read_value(const OGRFeature& feature, int index, std::size_t field);
  Value keep_text(std::size_t field, std::string text);
  Value utf8_text(std::size_t field, const char* text);

  std::vector<Field> fields_;
  std::vector<std::vector<std::size_t>> field_of_;  // by layer, by index in the layer
  std::vector<Value> values_;
  std::vector<std::string> texts_;  // by field: words that were made for the row at hand
};

}  // namespace trapeze
