#include "server/documents/identify.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/layer/features_at.h"
#include "render/mask/mask.h"
#include "server/base/json_text.h"
#include "server/data/layer_summary.h"
#include "server/tiles/layer_style.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 1> kOwnParameters = {"z"};
constexpr std::string_view kPattern = "/identify/{layers}/{lon},{lat}";

struct IdentifyRequest {
  std::vector<std::string> layers;  // bottom first
  Point place;
  std::optional<double> zoom;
  StyleQuery style;
};

std::optional<double> parse_number(std::string_view text, double min, double max) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(number >= min && number <= max)) return std::nullopt;  // written so that NaN fails
  return number;
}

/// The cell that holds the place; of those on the edge of the world the last.
Point cell_of(LonLat place) {
  const auto to_cell = [](double position) {
    return static_cast<std::int32_t>(
        std::clamp<double>(std::floor(position), kGridMin, kGridMax - 1));
  };
  const GridPosition position = grid_from_lonlat(place);
  return {to_cell(position.x), to_cell(position.y)};
}

Result<Point> parse_place(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) {
    const std::string_view view = text;
    const auto lon = parse_number(view.substr(0, comma), -180, 180);
    const auto lat = parse_number(view.substr(comma + 1), -kMaxLatitude, kMaxLatitude);
    if (lon && lat) return cell_of({*lon, *lat});
  }
  const std::string takes = fmt::format(
      "longitude and latitude in degrees: -180 to 180, -{0:.5f} to {0:.5f}", kMaxLatitude);
  return Problem{400, fmt::format("The path ends with {}: {}.", takes, kPattern), "lon,lat", text,
                 takes};
}

Result<std::optional<double>> parse_zoom(const DocumentRequest& request) {
  const std::string* text = request.find("z");
  if (text == nullptr) return std::optional<double>();
  if (const auto zoom = parse_number(*text, 0, kMaxZoom)) return zoom;
  const std::string takes = fmt::format("a number from 0 to {}", kMaxZoom);
  return Problem{400, fmt::format("The parameter z takes {}.", takes), "z", *text, takes};
}

Result<IdentifyRequest> parse_request(const DocumentRequest& request) {
  if (request.path.size() != 3) {
    return Problem{404, fmt::format("There is nothing here. Features are at {}.", kPattern)};
  }
  auto layers = parse_layer_list(request.path[1]);
  if (!layers) return std::move(layers).problem();
  auto place = parse_place(request.path[2]);
  if (!place) return std::move(place).problem();
  auto zoom = parse_zoom(request);
  if (!zoom) return std::move(zoom).problem();
  IdentifyRequest parsed{*std::move(layers), *place, *zoom, {}};
  auto style = request.style_for(parsed.layers, kOwnParameters);
  if (!style) return std::move(style).problem();
  parsed.style = *std::move(style);
  return parsed;
}

Level level_of(const IdentifyRequest& request, const StyleQuery& style, const std::string& layer) {
  if (!request.zoom) return 0;
  const double cells_per_pixel =
      static_cast<double>(kGridSize) / std::exp2(*request.zoom) / kTilePixels;
  return nearest_level(tolerance_in_pixels(style, layer) * cells_per_pixel);
}

bool is_drawn(const IdentifyRequest& request, const LayerConfig& config) {
  return !request.zoom ||
         (*request.zoom >= config.min_zoom && std::floor(*request.zoom) <= config.max_zoom);
}

GeographicBounds bounds_of_feature(const Layer& layer, std::uint32_t row) {
  Rings outline;
  layer.append_outline(row, outline);
  Box box;
  for (const Point p : outline.points) box.include(p);
  return bounds_in_degrees(box);
}

/// Of a text in JSON, quotes left out; what is no UTF-8 may become somewhat longer.
std::size_t json_size(std::string_view text) {
  std::size_t size = text.size();
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20) size += 5;  // \u001f
    if (c == '"' || c == '\\') ++size;
  }
  return size;
}

/// About the bytes of the attributes in the answer.
std::size_t size_of_properties(const FeatureTable& features, std::uint32_t row) {
  constexpr std::size_t kAroundValue = 32;  // indent, quotes, a number
  std::size_t size = 0;
  for (std::size_t field = 0; field < features.fields().size(); ++field) {
    size += kAroundValue + json_size(features.fields()[field].name);
    const Value value = features.value(row, static_cast<int>(field));
    if (const auto* text = std::get_if<std::string_view>(&value)) size += json_size(*text);
  }
  return size;
}

Json properties_json(const FeatureTable& features, std::uint32_t row) {
  Json properties = Json::object();
  for (std::size_t field = 0; field < features.fields().size(); ++field) {
    properties[features.fields()[field].name] =
        to_json(features.value(row, static_cast<int>(field)));
  }
  return properties;
}

/// The features of an answer.
class IdentifiedFeatures {
 public:
  void add(const ServedLayer& served, std::uint32_t row) {
    if (++matched_ > kMaxIdentified) return;
    const std::size_t size = size_of_properties(served.layer->features(), row);
    const bool is_too_much = size > bytes_left_;
    if (is_too_much) {
      ++left_out_;
    } else {
      bytes_left_ -= size;
    }
    features_.push_back(feature_json(served, row, !is_too_much));
  }

  Json take_json() {
    Json json;
    json["type"] = "FeatureCollection";
    json["numberMatched"] = matched_;
    json["numberReturned"] = features_.size();
    if (left_out_ > 0) json["propertiesLeftOut"] = left_out_;
    json["features"] = std::move(features_);
    return json;
  }

 private:
  static Json feature_json(const ServedLayer& served, std::uint32_t row, bool has_properties);

  Json features_ = Json::array();
  std::size_t matched_ = 0;
  std::size_t left_out_ = 0;
  std::size_t bytes_left_ = kMaxIdentifiedBytes;
};

Json IdentifiedFeatures::feature_json(const ServedLayer& served, std::uint32_t row,
                                      bool has_properties) {
  const FeatureTable& features = served.layer->features();
  Json json;
  json["type"] = "Feature";
  json["id"] = features.id(row);
  json["layer"] = served.config.name;
  json["bbox"] = bounds_of_feature(*served.layer, row);
  json["geometry"] = nullptr;
  json["properties"] = has_properties ? properties_json(features, row) : Json();
  return json;
}

/// The rows of the features that are found, or what is wrong with the style.
Result<std::vector<std::uint32_t>> find_rows(const IdentifyRequest& request,
                                             const ServedLayer& served, std::size_t position) {
  const auto query = complete_style(request.style, served.config);
  if (!query) return query.problem();
  const auto style = layer_style(*query, served, position);
  if (!style) return style.problem();
  if (!is_drawn(request, served.config)) return std::vector<std::uint32_t>();
  auto rows =
      features_at(*served.layer, request.place, level_of(request, *query, served.config.name));
  const FeatureClassifier classifier(style->classing, served.layer->features());
  std::erase_if(rows, [&](std::uint32_t row) { return classifier.class_of(row) == kNotDrawn; });
  return rows;
}

}  // namespace

Result<Document> identify_document(const DocumentRequest& request) {
  const auto parsed = parse_request(request);
  if (!parsed) return parsed.problem();
  const auto& identify = *parsed;
  IdentifiedFeatures features;
  for (auto name = identify.layers.rbegin(); name != identify.layers.rend(); ++name) {
    const auto position = request.dataset.find(*name);
    if (!position) return unknown_layer(*name, request.dataset);
    const ServedLayer& served = request.dataset.layers()[*position];
    if (!served.is_whole()) return damaged_layer(served);
    const auto rows = find_rows(identify, served, *position);
    if (!rows) return rows.problem();
    for (const std::uint32_t row : *rows) features.add(served, row);
  }
  return Document{"application/geo+json", to_text(features.take_json())};
}

}  // namespace trapeze
