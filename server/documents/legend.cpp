#include "server/documents/legend.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

#include "render/picture/png.h"
#include "render/text/bitmap_text.h"
#include "server/base/json_text.h"
#include "server/data/layer_summary.h"
#include "server/tiles/layer_style.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

constexpr std::string_view kPattern = "/legend/{layers}.json or /legend/{layers}[@{1-4}x].png";
constexpr std::string_view kJson = ".json";

struct LegendEntry {
  std::string label;
  ClassPaint paint;
};

struct LayerLegend {
  std::string name;
  std::string title;
  double stroke_width = 0;
  double opacity = 1;
  std::vector<LegendEntry> entries;
};

std::string label_of_value(const std::optional<FilterLiteral>& value) {
  if (!value) return "no value";
  if (const auto* integer = std::get_if<std::int64_t>(&*value)) return fmt::format("{}", *integer);
  if (const auto* real = std::get_if<double>(&*value)) return fmt::format("{}", *real);
  return std::get<std::string>(*value);
}

std::string label_between(const std::vector<double>& breaks, std::size_t i) {
  if (i == 0) return fmt::format("below {}", breaks.front());
  if (i == breaks.size()) return fmt::format("{} and more", breaks.back());
  return fmt::format("{} to {}", breaks[i - 1], breaks[i]);
}

/// By number of class, as LayerStyle::paints.
std::vector<std::string> labels_of(const Classing& classing, const std::string& title) {
  std::vector<std::string> labels;
  for (const auto& value : classing.values) labels.push_back(label_of_value(value));
  if (!classing.breaks.empty()) {
    for (std::size_t i = 0; i <= classing.breaks.size(); ++i) {
      labels.push_back(label_between(classing.breaks, i));
    }
  }
  labels.push_back(labels.empty() ? title : "others");
  if (!classing.highlighted_ids.empty()) labels.emplace_back("highlighted");
  return labels;
}

LayerLegend legend_of_layer(const LayerConfig& config, const LayerStyle& style) {
  LayerLegend legend{config.name, config.title, style.stroke.width, style.opacity, {}};
  const std::vector<std::string> labels = labels_of(style.classing, config.title);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    legend.entries.push_back({labels[i], style.paints[i]});
  }
  return legend;
}

OrProblem<std::vector<LayerLegend>> legend_of(const std::vector<std::string>& layers,
                                              const DocumentRequest& request) {
  const auto query = StyleQuery::parse(request.query, layers);
  if (const auto* problem = std::get_if<Problem>(&query)) return *problem;
  std::vector<LayerLegend> legend;
  for (auto name = layers.rbegin(); name != layers.rend(); ++name) {
    const auto position = request.dataset.find(*name);
    if (!position) return unknown_layer(*name, request.dataset);
    const ServedLayer& served = request.dataset.layers()[*position];
    const auto style = layer_style(std::get<StyleQuery>(query), served, *position);
    if (const auto* problem = std::get_if<Problem>(&style)) return *problem;
    legend.push_back(legend_of_layer(served.config, std::get<LayerStyle>(style)));
  }
  return legend;
}

Json entry_json(const LegendEntry& entry, const LayerLegend& layer) {
  Json json = {{"label", entry.label},
               {"fill", css_colour(entry.paint.fill)},
               {"fill-opacity", entry.paint.fill.a / 255.0 * layer.opacity}};
  if (layer.stroke_width > 0) {
    json["stroke"] = css_colour(entry.paint.stroke);
    json["stroke-opacity"] = entry.paint.stroke.a / 255.0 * layer.opacity;
    json["stroke-width"] = layer.stroke_width;
  }
  return json;
}

std::string legend_json(const std::vector<LayerLegend>& legend) {
  Json layers = Json::array();
  for (const LayerLegend& layer : legend) {
    Json entries = Json::array();
    for (const LegendEntry& entry : layer.entries) entries.push_back(entry_json(entry, layer));
    layers.push_back({{"name", layer.name}, {"title", layer.title}, {"entries", entries}});
  }
  return to_text({{"layers", layers}});
}

// Pixels at scale 1.
constexpr int kMargin = 6;
constexpr int kRowHeight = 16;
constexpr int kSwatchWidth = 20;
constexpr int kSwatchHeight = 12;
constexpr int kSwatchGap = 6;
constexpr int kMaxLabelWidth = 320;
constexpr int kMaxHeight = 8192;  // many layers of many classes are a short request
constexpr Rgba kPaper{255, 255, 255, 255};
constexpr Rgba kInk{0x22, 0x22, 0x22, 255};
constexpr Rgba kFrame{0x88, 0x88, 0x88, 255};

/// A line of the picture: a title, or a swatch with its label.
struct LegendRow {
  std::string_view label;
  const LegendEntry* entry = nullptr;  // null for a title
  const LayerLegend* layer = nullptr;
};

std::vector<LegendRow> rows_of(const std::vector<LayerLegend>& legend) {
  std::vector<LegendRow> rows;
  for (const LayerLegend& layer : legend) {
    // The only entry of a layer is labelled with its title.
    if (layer.entries.size() > 1) rows.push_back({layer.title, nullptr, &layer});
    for (const LegendEntry& entry : layer.entries) rows.push_back({entry.label, &entry, &layer});
  }
  return rows;
}

int left_of_label(const LegendRow& row) {
  return row.entry == nullptr ? kMargin : kMargin + kSwatchWidth + kSwatchGap;
}

Rgba over_paper(Rgba colour) {
  const auto mix = [&](std::uint8_t c) {
    return static_cast<std::uint8_t>((c * colour.a + 255 * (255 - colour.a) + 127) / 255);
  };
  return {mix(colour.r), mix(colour.g), mix(colour.b), 255};
}

void fill_box(Picture& picture, int left, int top, int width, int height, Rgba colour) {
  for (int y = top; y < top + height; ++y) {
    const auto row = picture.pixels.begin() + static_cast<std::ptrdiff_t>(y) * picture.width + left;
    std::fill(row, row + width, colour);
  }
}

void draw_swatch(const LegendRow& row, int top, int scale, Picture& picture) {
  const int left = kMargin * scale;
  const int width = kSwatchWidth * scale;
  const int height = kSwatchHeight * scale;
  const ClassPaint& paint = row.entry->paint;
  const bool is_outlined = row.layer->stroke_width > 0;
  const double opacity = row.layer->opacity;
  fill_box(picture, left, top, width, height,
           is_outlined ? over_paper(with_opacity(paint.stroke, opacity)) : kFrame);
  fill_box(picture, left + scale, top + scale, width - 2 * scale, height - 2 * scale,
           over_paper(with_opacity(paint.fill, opacity)));
}

/// In pixels at scale 1.
int height_of(const std::vector<LegendRow>& rows) {
  return static_cast<int>(rows.size()) * kRowHeight + 2 * kMargin;
}

Picture draw_legend(const std::vector<LegendRow>& rows, int scale) {
  int width = 0;
  for (const LegendRow& row : rows) {
    const int label = std::min(text_width(row.label), kMaxLabelWidth);
    width = std::max(width, left_of_label(row) + label + kMargin);
  }
  Picture picture;
  picture.width = width * scale;
  picture.height = height_of(rows) * scale;
  picture.pixels.assign(
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), kPaper);
  int top = kMargin * scale;
  for (const LegendRow& row : rows) {
    if (row.entry != nullptr) {
      draw_swatch(row, top + (kRowHeight - kSwatchHeight) / 2 * scale, scale, picture);
    }
    draw_text(row.label, left_of_label(row) * scale, top + (kRowHeight - kTextAscent) / 2 * scale,
              scale, kInk, picture);
    top += kRowHeight * scale;
  }
  return picture;
}

OrProblem<Document> legend_as_json(std::string_view file, const DocumentRequest& request) {
  file.remove_suffix(kJson.size());
  const auto layers = parse_layer_list(file);
  if (const auto* problem = std::get_if<Problem>(&layers)) return *problem;
  const auto legend = legend_of(std::get<0>(layers), request);
  if (const auto* problem = std::get_if<Problem>(&legend)) return *problem;
  return Document{"application/json", legend_json(std::get<0>(legend))};
}

OrProblem<Document> legend_as_png(std::string_view file, const DocumentRequest& request) {
  const auto name = parse_picture_name(file);
  if (const auto* problem = std::get_if<Problem>(&name)) return *problem;
  if (std::get<PictureName>(name).format != TileFormat::png) {
    return Problem{400, "Legends are pictures in PNG, or JSON."};
  }
  const auto layers = parse_layer_list(std::get<PictureName>(name).stem);
  if (const auto* problem = std::get_if<Problem>(&layers)) return *problem;
  const auto legend = legend_of(std::get<0>(layers), request);
  if (const auto* problem = std::get_if<Problem>(&legend)) return *problem;
  const std::vector<LegendRow> rows = rows_of(std::get<0>(legend));
  const int scale = std::get<PictureName>(name).scale;
  if (height_of(rows) * scale > kMaxHeight) {
    return Problem{400,
                   fmt::format("A legend is at most {} pixels high: name fewer layers or classes, "
                               "or ask for .json.",
                               kMaxHeight)};
  }
  return Document{"image/png", PngEncoder().encode(draw_legend(rows, scale))};
}

}  // namespace

OrProblem<Document> legend_document(const DocumentRequest& request) {
  if (request.path.size() == 2) {
    const std::string& file = request.path[1];
    if (file.ends_with(kJson)) return legend_as_json(file, request);
    if (file.ends_with(".png")) return legend_as_png(file, request);
  }
  return Problem{404, fmt::format("There is nothing here. Legends are at {}.", kPattern)};
}

}  // namespace trapeze
