// The classes of the features of a source when only features of the same class become one block.
//
// For use on the thread of the source.
#pragma once

#include <cstdint>
#include <string>

#include "core/io/source/attribute_reader.h"
#include "core/io/source/feature_source.h"

namespace trapeze {

class MergeClasses {
 public:
  /// Classes by the values of an attribute; empty: all features are of one class. Throws
  /// SourceError if no layer of the source has the attribute.
  MergeClasses(const FeatureSource& source, const std::string& attribute);

  /// Equal for equal values, in this source and in any other; features without a value are of one
  /// class. The geometry of the feature may have been removed.
  std::uint64_t class_of(const SourceFeature& feature);

 private:
  bool has_classes_;
  AttributeReader attribute_;
};

}  // namespace trapeze
