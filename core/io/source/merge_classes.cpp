#include "core/io/source/merge_classes.h"

#include <bit>
#include <cstddef>
#include <string_view>
#include <variant>
#include <vector>

#include "core/grid/digest.h"

namespace trapeze {
namespace {

/// The names of attributes in words; only the first ones if there are many.
std::string names_of(const FeatureSource& source) {
  constexpr std::size_t kMostNames = 32;
  AttributeReader all;
  for (const SourceLayer& layer : source.layers()) all.add_layer(*layer.layer->GetLayerDefn());
  const std::vector<Field>& fields = all.fields();
  if (fields.empty()) return "none";
  std::string names;
  for (std::size_t i = 0; i < fields.size() && i < kMostNames; ++i) {
    names += (i == 0 ? "" : ", ") + fields[i].name;
  }
  if (fields.size() > kMostNames) {
    names += " and " + std::to_string(fields.size() - kMostNames) + " more";
  }
  return names;
}

std::uint64_t digest_of(const Value& value) {
  Digester digester;
  digester.add(value.index());
  if (const auto* number = std::get_if<std::int64_t>(&value)) {
    digester.add(static_cast<std::uint64_t>(*number));
  } else if (const auto* real = std::get_if<double>(&value)) {
    digester.add(std::bit_cast<std::uint64_t>(*real == 0 ? 0.0 : *real));  // -0 equals 0
  } else if (const auto* text = std::get_if<std::string_view>(&value)) {
    for (const char c : *text) digester.add(static_cast<unsigned char>(c));
  }
  return digester.digest().low;
}

}  // namespace

MergeClasses::MergeClasses(const FeatureSource& source, const std::string& attribute)
    : has_classes_(!attribute.empty()), attribute_(std::vector{attribute}) {
  if (!has_classes_) return;
  for (const SourceLayer& layer : source.layers()) {
    attribute_.add_layer(*layer.layer->GetLayerDefn());
  }
  if (!attribute_.missing().empty()) {
    throw SourceError("has no attribute \"" + attribute +
                      "\" to merge by; it has: " + names_of(source));
  }
}

std::uint64_t MergeClasses::class_of(const SourceFeature& feature) {
  if (!has_classes_ || feature.layer == nullptr) return 0;
  return digest_of(attribute_.read(*feature.feature, feature.layer_index).front());
}

}  // namespace trapeze
