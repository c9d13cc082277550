#include "server/documents/attribute_values.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/base/json_text.h"
#include "server/data/dataset.h"
#include "server/data/layer_summary.h"
#include "server/documents/place_text.h"
#include "server/tiles/layer_style.h"
#include "server/values/attributes.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 1> kValuesParameters = {"bbox"};
constexpr std::string_view kValuesPattern = "/values/{layer}/{attribute}";

/// Without any, all counts.
using Boxes = std::vector<Box>;

Result<Boxes> boxes_of(const DocumentRequest& request) {
  const std::string* text = request.find("bbox");
  if (text == nullptr) return Boxes();
  Boxes boxes = parse_boxes(*text);
  if (!boxes.empty()) return boxes;
  const std::string takes =
      "west, south, east and north in degrees, separated by commas; west may be greater than "
      "east, across the antimeridian";
  return Problem{400, fmt::format("The parameter bbox takes {}.", takes), "bbox", *text, takes};
}

/// Whether they intersect, or nearly so at a corner of the box.
bool meets(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Box& box) {
  const double top = std::max(mesh.vertices[trapezoid.top].y, box.min_y);
  const double bottom = std::min(mesh.vertices[trapezoid.bottom].y, box.max_y);
  if (top > bottom) return false;
  const EdgeLine left(mesh, trapezoid.left);
  const EdgeLine right(mesh, trapezoid.right);
  return std::min(left.x_at(top), left.x_at(bottom)) <= box.max_x &&
         std::max(right.x_at(top), right.x_at(bottom)) >= box.min_x;
}

/// By row: whether the feature touches one of the boxes.
std::vector<bool> rows_in(const Layer& layer, const Boxes& boxes) {
  std::vector<bool> rows(layer.features().size());
  std::vector<TrapezoidRange> ranges;
  for (const Box& box : boxes) {
    layer.select({box, 0, kLastLevel, SmallPolygons::drop}, ranges);
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      const std::uint32_t row = layer.feature_of(i);
      if (row == Layer::kNoFeature || rows[row]) return;
      rows[row] = meets(layer.mesh(), layer.mesh().trapezoids[i], box);
    });
  }
  return rows;
}

bool holds(const Box& outer, const Box& inner) {
  return outer.min_x <= inner.min_x && outer.min_y <= inner.min_y && outer.max_x >= inner.max_x &&
         outer.max_y >= inner.max_y;
}

/// How often each value occurs, and how many features have none.
struct Counts {
  std::unordered_map<Value, std::size_t> by_value;
  std::size_t features = 0;
  std::size_t missing = 0;

  void add(const Value& value) {
    ++features;
    if (std::holds_alternative<std::monostate>(value)) {
      ++missing;
    } else {
      ++by_value[value];
    }
  }
};

using Counted = std::pair<Value, std::size_t>;

std::vector<Counted> ascending(const Counts& counts) {
  std::vector<Counted> sorted(counts.by_value.begin(), counts.by_value.end());
  std::ranges::sort(sorted, {}, &Counted::first);
  return sorted;
}

Json commonest_json(std::vector<Counted> values) {
  std::erase_if(values, [](const Counted& counted) {
    const auto* text = std::get_if<std::string_view>(&counted.first);
    return text != nullptr && text->size() > kMaxValueBytes;
  });
  std::ranges::stable_sort(values, std::ranges::greater(), &Counted::second);
  values.resize(std::min(values.size(), kMaxValues));
  Json json = Json::array();
  for (const auto& [value, count] : values) {
    json.push_back({{"value", to_json(value)}, {"count", count}});
  }
  return json;
}

/// `values` are ascending.
Json quantiles_json(const std::vector<Counted>& values, std::size_t count) {
  Json json = Json::array();
  if (count == 0) return json;
  const std::size_t steps = std::min(kQuantileSteps, count - 1);
  std::size_t before = 0;  // number of features with lesser values
  auto value = values.begin();
  for (std::size_t step = 0; step <= steps; ++step) {
    const std::size_t rank = steps == 0 ? 0 : step * (count - 1) / steps;
    while (before + value->second <= rank) before += (value++)->second;
    json.push_back(to_json(value->first));
  }
  return json;
}

void count_values(const Layer& layer, const LayerStyle& style, int field, const Boxes& boxes,
                  Counts& counts) {
  const auto holds_all = [&](const Box& box) { return holds(box, layer.bounds()); };
  const bool is_part = !boxes.empty() && std::ranges::none_of(boxes, holds_all);
  const std::vector<bool> rows = is_part ? rows_in(layer, boxes) : std::vector<bool>();
  const Classing classing = style.classing.over(layer.features());
  const FeatureClassifier classifier(classing, layer.features());
  const Attributes attributes(layer.features());
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    if (layer.is_removed(row) || (is_part && !rows[row])) continue;
    if (classifier.class_of(row) == kNotDrawn) continue;
    counts.add(attributes.value(row, field));
  }
}

/// Counts the values of the features that are drawn; the problem is one of the style, or a part of
/// the layer that cannot be opened.
Result<Counts> count_values(const ServedLayer& served, std::size_t position, int field,
                            const StyleQuery& asked, const Boxes& boxes) {
  const auto query = complete_style(asked, served.config);
  if (!query) return query.problem();
  const auto style = layer_style(*query, served, position);
  if (!style) return style.problem();
  Counts counts;
  if (served.parts == nullptr) {
    count_values(*served.layer, *style, field, boxes, counts);
    return counts;
  }
  for (const auto& part : served.parts->parts()) {
    const auto is_in_part = [&](const Box& box) { return box.intersects(part->summary().bounds); };
    if (!boxes.empty() && std::ranges::none_of(boxes, is_in_part)) continue;
    const auto layer = part->layer();  // kept alive by the part; texts are views of it
    if (layer == nullptr) return damaged_layer(served);
    count_values(*layer, *style, field, boxes, counts);
  }
  return counts;
}

Json values_json(const Counts& counts, FieldType type) {
  const std::vector<Counted> values = ascending(counts);
  Json json;
  json["features"] = counts.features;
  json["missing"] = counts.missing;
  json["distinct"] = values.size();
  json["values"] = commonest_json(values);
  if (type != FieldType::text) {
    json["quantiles"] = quantiles_json(values, counts.features - counts.missing);
  }
  return json;
}

Problem unknown_attribute(const std::string& name, const std::string& layer) {
  return {404, fmt::format("The layer {} has no attribute {}.", layer, name)};
}

}  // namespace

Result<Document> values_document(const DocumentRequest& request) {
  if (request.path.size() != 3) {
    return Problem{404, fmt::format("There is nothing here. Values are at {}.", kValuesPattern)};
  }
  const std::vector<std::string> names = {request.path[1]};
  const auto position = request.dataset.find(names.front());
  if (!position) return unknown_layer(names.front(), request.dataset);
  const ServedLayer& served = request.dataset.layers()[*position];
  if (!served.is_whole()) return damaged_layer(served);
  const FeatureTable& features = served.layer->features();
  const int field = features.field_index(request.path[2]);
  if (field < 0) return unknown_attribute(request.path[2], names.front());
  const auto boxes = boxes_of(request);
  if (!boxes) return boxes.problem();
  const auto style = request.style_for(names, kValuesParameters);
  if (!style) return style.problem();
  const auto counts = count_values(served, *position, field, *style, *boxes);
  if (!counts) return counts.problem();
  return Document{
      "application/json",
      to_text(values_json(*counts, features.fields()[static_cast<std::size_t>(field)].type))};
}

}  // namespace trapeze
