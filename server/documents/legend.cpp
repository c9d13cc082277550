#include "server/documents/legend.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "render/mask/stroke.h"
#include "render/picture/compose.h"
#include "render/picture/debug_marks.h"
#include "render/picture/pattern.h"
#include "render/picture/png.h"
#include "render/text/fonts.h"
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
  Stroke stroke;
  Pattern pattern;
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
  LayerLegend legend{config.name, config.title, style.stroke, style.pattern, style.opacity, {}};
  const std::vector<std::string> labels = labels_of(style.classing, config.title);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    legend.entries.push_back({labels[i], style.paints[i]});
  }
  return legend;
}

Result<std::vector<LayerLegend>> legend_of(const std::vector<std::string>& layers,
                                           const DocumentRequest& request) {
  const auto query = request.style_for(layers);
  if (!query) return query.problem();
  std::vector<LayerLegend> legend;
  for (auto name = layers.rbegin(); name != layers.rend(); ++name) {
    const auto position = request.dataset.find(*name);
    if (!position) return unknown_layer(*name, request.dataset);
    const ServedLayer& served = request.dataset.layers()[*position];
    const auto complete = complete_style(*query, served.config);
    if (!complete) return complete.problem();
    const auto style = layer_style(*complete, served, *position);
    if (!style) return style.problem();
    legend.push_back(legend_of_layer(served.config, *style));
  }
  return legend;
}

Json entry_json(const LegendEntry& entry, const LayerLegend& layer) {
  Json json = {{"label", entry.label},
               {"fill", css_colour(entry.paint.fill)},
               {"fill-opacity", entry.paint.fill.a / 255.0 * layer.opacity}};
  if (layer.stroke.width > 0) {
    json["stroke"] = css_colour(entry.paint.stroke);
    json["stroke-opacity"] = entry.paint.stroke.a / 255.0 * layer.opacity;
    json["stroke-width"] = layer.stroke.width;
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
constexpr double kMaxSwatchStroke = 4;
constexpr int kMaxLabelWidth = 320;
constexpr int kTextSize = 12;
constexpr int kBaseLine =
    12;  // of text below the top of its row, so that capitals are in the middle
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

/// A polygon drawn as the map does it: in a picture of its own, on paper.
class Swatch {
 public:
  explicit Swatch(int scale)
      : scale_(scale),
        view_{kGridMin, kGridMin, kCellsPerPixel, kSwatchWidth * scale, kSwatchHeight * scale} {}

  /// The result lasts until the next call.
  const Picture& draw(const ClassPaint& paint, const LayerLegend& layer) {
    // Wider outlines would leave nothing of the fill.
    Stroke stroke = layer.stroke;
    stroke.width = std::min(stroke.width, kMaxSwatchStroke);
    const double inset = scale_ * stroke.width / 2;
    fill_rectangle(inset);
    PaintedClass fill{&fill_, paint.fill};
    PaintedClass line{&line_, paint.stroke};
    PaintedLayer painted{{&fill, 1}, nullptr, layer.pattern.colour, {}, layer.opacity};
    if (layer.pattern.kind != PatternKind::none) {
      pattern_.place(layer.pattern, view_, scale_);
      painted.pattern = &pattern_;
    }
    if (layer.stroke.width > 0) {
      draw_outline(stroke, inset);
      painted.lines = {&line, 1};
    }
    composer_.compose({&painted, 1}, view_.width, view_.height, kPaper, Quality::exact, runs_);
    picture_ = to_pixels(runs_);
    if (layer.stroke.width == 0) draw_frame();
    return picture_;
  }

 private:
  static constexpr double kCellsPerPixel = 1024;

  void fill_rectangle(double inset) {
    const auto level_of = [inset](int place, int length) {
      return std::max(0.0, std::min(place + 1.0, length - inset) - std::max<double>(place, inset));
    };
    fill_.begin(view_.width, view_.height);
    for (int y = 0; y < view_.height; ++y) {
      for (int x = 0; x < view_.width; ++x) {
        const double share = level_of(x, view_.width) * level_of(y, view_.height);
        fill_.append(static_cast<std::size_t>(x) + 1, static_cast<std::uint8_t>(share * 255 + 0.5));
      }
      fill_.end_row();
    }
  }

  void draw_outline(const Stroke& stroke, double inset) {
    const auto cell = [](double pixels) {
      return static_cast<std::int32_t>(kGridMin + std::lround(pixels * kCellsPerPixel));
    };
    const std::int32_t west = cell(inset);
    const std::int32_t north = cell(inset);
    const std::int32_t east = cell(view_.width - inset);
    const std::int32_t south = cell(view_.height - inset);
    const std::array<Point, 4> corners{Point{west, north}, Point{east, north}, Point{east, south},
                                       Point{west, south}};
    const double width = east - west;
    const double height = south - north;
    const std::array<OutlineEdge, 4> edges{OutlineEdge{0, 1, 0}, OutlineEdge{1, 2, width},
                                           OutlineEdge{2, 3, width + height},
                                           OutlineEdge{3, 0, 2 * width + height}};
    stroker_.begin(view_, scale_);
    stroker_.draw(corners, edges, stroke);
    stroker_.finish(line_);
  }

  // Without an outline, pale colours would not stand out from the paper.
  void draw_frame() {
    for (int y = 0; y < view_.height; ++y) {
      for (int x = 0; x < view_.width; ++x) {
        const bool is_inside =
            x >= scale_ && x < view_.width - scale_ && y >= scale_ && y < view_.height - scale_;
        if (!is_inside) pixel(x, y) = kFrame;
      }
    }
  }

  Rgba& pixel(int x, int y) {
    return picture_.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) +
                           static_cast<std::size_t>(x)];
  }

  int scale_;
  View view_;
  Mask fill_;
  PlacedPattern pattern_;
  Mask line_;
  Stroker stroker_;
  Composer composer_;
  RunPicture runs_;
  Picture picture_;
};

void copy_into(const Picture& part, int left, int top, Picture& picture) {
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      picture.pixels[static_cast<std::size_t>(top + y) * static_cast<std::size_t>(picture.width) +
                     static_cast<std::size_t>(left + x)] = part.at(x, y);
    }
  }
}

/// In pixels at scale 1.
int height_of(const std::vector<LegendRow>& rows) {
  return static_cast<int>(rows.size()) * kRowHeight + 2 * kMargin;
}

/// Labels as wide as there is room, by row.
std::vector<std::string> fitted_labels(const std::vector<LegendRow>& rows, const Fonts& fonts) {
  std::vector<std::string> labels;
  labels.reserve(rows.size());
  for (const LegendRow& row : rows) {
    labels.push_back(fonts.fitted(row.label, kTextSize, kMaxLabelWidth));
  }
  return labels;
}

LegendSize size_of(const std::vector<LegendRow>& rows, const std::vector<std::string>& labels,
                   const Fonts& fonts) {
  int width = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int label = fonts.width_of(labels[i], kTextSize);
    width = std::max(width, left_of_label(rows[i]) + label + kMargin);
  }
  return {width, height_of(rows)};
}

Picture blank_legend(LegendSize size, int scale) {
  Picture picture;
  picture.width = size.width * scale;
  picture.height = size.height * scale;
  picture.pixels.assign(
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), kPaper);
  return picture;
}

Picture draw_legend(const std::vector<LegendRow>& rows, const Fonts& fonts, int scale) {
  const std::vector<std::string> labels = fitted_labels(rows, fonts);
  Picture picture = blank_legend(size_of(rows, labels, fonts), scale);
  Swatch swatch(scale);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LegendRow& row = rows[i];
    const int top = kMargin + static_cast<int>(i) * kRowHeight;
    if (row.entry != nullptr) {
      copy_into(swatch.draw(row.entry->paint, *row.layer), kMargin * scale,
                (top + (kRowHeight - kSwatchHeight) / 2) * scale, picture);
    }
    fonts.draw(labels[i], left_of_label(row) * scale, (top + kBaseLine) * scale,
               {kTextSize * scale, kInk}, picture);
  }
  return picture;
}

Result<Document> legend_as_json(std::string_view file, const DocumentRequest& request) {
  file.remove_suffix(kJson.size());
  const auto layers = parse_layer_list(file);
  if (!layers) return layers.problem();
  const auto legend = legend_of(*layers, request);
  if (!legend) return legend.problem();
  return Document{"application/json", legend_json(*legend)};
}

Result<Document> legend_as_png(std::string_view file, const DocumentRequest& request) {
  const auto name = parse_picture_name(file);
  if (!name) return name.problem();
  if (name->format != TileFormat::png) {
    return Problem{400, "Legends are pictures in PNG, or JSON."};
  }
  const auto layers = parse_layer_list(name->stem);
  if (!layers) return layers.problem();
  const auto legend = legend_of(*layers, request);
  if (!legend) return legend.problem();
  const std::vector<LegendRow> rows = rows_of(*legend);
  const int scale = name->scale;
  if (height_of(rows) * scale > kMaxHeight) {
    return Problem{400,
                   fmt::format("A legend is at most {} pixels high: name fewer layers or classes, "
                               "or ask for .json.",
                               kMaxHeight)};
  }
  return Document{"image/png",
                  PngEncoder().encode(to_runs(draw_legend(rows, request.fonts, scale)))};
}

}  // namespace

Result<LegendSize> legend_size(const std::string& layer, const DocumentRequest& request) {
  const auto legend = legend_of({layer}, request);
  if (!legend) return legend.problem();
  const std::vector<LegendRow> rows = rows_of(*legend);
  return size_of(rows, fitted_labels(rows, request.fonts), request.fonts);
}

Result<Document> legend_document(const DocumentRequest& request) {
  if (request.path.size() == 2) {
    const std::string& file = request.path[1];
    if (file.ends_with(kJson)) return legend_as_json(file, request);
    if (file.ends_with(".png")) return legend_as_png(file, request);
  }
  return Problem{404, fmt::format("There is nothing here. Legends are at {}.", kPattern)};
}

}  // namespace trapeze
