// The classes of the features of a source, where only those of one class become one block.
//
// Belongs to the thread of the source.
#pragma once

#include <cstdint>
#include <string>

#include "core/io/source/attribute_reader.h"
#include "core/io/source/feature_source.h"

namespace trapeze {

class MergeClasses {
 public:
  /// By the values of an attribute; empty: all are of one class. Throws SourceError if no layer of
  /// the source has it.
  MergeClasses(const FeatureSource& source, const std::string& attribute);

  /// Equal for equal values, in this source and in any other one; those without a value are of one
  /// class. The feature may have lost its geometry.
  std::uint64_t class_of(const SourceFeature& feature);

 private:
  bool has_classes_;
  AttributeReader attribute_;
};

}  // namespace trapeze
