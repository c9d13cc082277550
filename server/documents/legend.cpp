#include "server/documents/legend.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "render/mask/stroke.h"
#include "render/picture/compose.h"
#include "render/picture/debug_marks.h"
#include "render/picture/pattern.h"
#include "render/picture/png.h"
#include "render/text/fonts.h"
#include "server/base/json_text.h"
#include "server/data/layer_summary.h"
#include "server/documents/classification.h"
#include "server/tiles/layer_style.h"
#include "server/tiles/tile_request.h"
#include "server/values/number_format.h"

namespace trapeze {
namespace {

constexpr std::string_view kLegendPattern =
    "/legend/{layers}.json or /legend/{layers}[@{1-4}x].png";
constexpr std::string_view kJsonEnding = ".json";

struct LegendEntry {
  std::string label;
  ClassPaint paint;
  std::optional<double> from = {};  // for a class between breaks
  std::optional<double> to = {};
};

struct LayerLegend {
  std::string name;
  std::string title;
  std::string values_title;  // of joined values that colour the layer; empty: none
  LayerStyle style;
  std::vector<LegendEntry> entries;

  /// The text above the entries.
  std::string heading() const {
    return values_title.empty() ? title : fmt::format("{}: {}", title, values_title);
  }
};

/// Writes the labels of the classes of a style.
class ClassLabels {
 public:
  explicit ClassLabels(const LayerStyle& style) : style_(style), format_(style.label_format) {
    const bool has_digits =
        format_ && (format_->digits || format_->type != NumberFormat::Type::fixed);
    if (has_digits || !is_ruled()) return;
    // Breaks computed by a rule have more digits than anyone wants to read.
    const double step = least_step();
    if (!(step > 0) || !std::isfinite(step)) return;
    NumberFormat apart = format_for_step(step);
    if (!tells_apart([&apart](double number) { return formatted(number, apart); })) {
      significant_ = significant_digits();
      return;
    }
    while (*apart.digits > 0 && all_end_with_zero(apart)) --*apart.digits;
    if (!format_) format_ = apart;
    format_->digits = apart.digits;
  }

  /// By class number, as in LayerStyle::paints; classes that are always empty are left out.
  std::vector<LegendEntry> entries(const std::string& title) const {
    const Classing& classing = style_.classing;
    std::vector<LegendEntry> entries;
    for (const auto& value : classing.values) add(entries, of_value(value));
    const std::size_t between = classing.breaks.empty() ? 0 : classing.breaks.size() + 1;
    for (std::size_t i = 0; i < between; ++i) add_between(entries, i);
    const bool has_classes = style_.origin.has_value();
    const bool is_by_value = !classing.values.empty();
    add(entries, !has_classes ? title : is_by_value ? "others" : "no data");
    if (!classing.highlighted_ids.empty()) add(entries, "highlighted");
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i].paint = style_.paints[i];
    // All numbers are equal: there is one class, and none below it.
    if (is_ruled() && between == 2 && least() == greatest()) entries.erase(entries.begin());
    return entries;
  }

 private:
  static void add(std::vector<LegendEntry>& entries, std::string label) {
    entries.push_back({std::move(label), {}});
  }

  void add_between(std::vector<LegendEntry>& entries, std::size_t i) const {
    const std::vector<double>& breaks = style_.classing.breaks;
    LegendEntry entry;
    if (i > 0) entry.from = breaks[i - 1];
    if (i < breaks.size()) entry.to = breaks[i];
    if (is_ruled()) {
      if (!entry.from) entry.from = least();
      if (!entry.to) entry.to = greatest();
    }
    if (!entry.from) {
      entry.label = fmt::format("below {}", with_units(number(*entry.to)));
    } else if (!entry.to) {
      entry.label = fmt::format("{} and more", with_units(number(*entry.from)));
    } else {
      const std::string from = number(*entry.from);
      const std::string to = number(*entry.to);
      entry.label = with_units(from == to ? from : fmt::format("{} to {}", from, to));
    }
    entries.push_back(std::move(entry));
  }

  std::string of_value(const std::optional<FilterLiteral>& value) const {
    if (!value) return "no value";
    if (const auto* text = std::get_if<std::string>(&*value)) return *text;
    if (const auto* integer = std::get_if<std::int64_t>(&*value)) {
      return with_units(format_ ? number(static_cast<double>(*integer))
                                : fmt::format("{}", *integer));
    }
    return with_units(number(std::get<double>(*value)));
  }

  std::string number(double number) const {
    if (significant_ > 0) return with_significant(number, significant_);
    return format_ ? formatted(number, *format_) : fmt::format("{}", number);
  }
  std::string with_units(std::string text) const {
    constexpr std::string_view kNoBreakSpace = "\u00a0";
    if (style_.units.empty()) return text;
    return fmt::format("{}{}{}", text, kNoBreakSpace, style_.units);
  }

  /// Whether a rule has classed numbers, and there are any.
  bool is_ruled() const {
    return style_.origin && style_.origin->rule && style_.origin->spread != nullptr &&
           !style_.origin->spread->is_empty();
  }
  static std::string with_significant(double number, int digits) {
    return fmt::format("{:.{}g}", number, digits);
  }
  /// As many as needed to tell the numbers in labels apart.
  int significant_digits() const {
    int digits = 2;
    while (digits < std::numeric_limits<double>::max_digits10 &&
           !tells_apart([digits](double number) { return with_significant(number, digits); })) {
      ++digits;
    }
    return digits;
  }
  /// Whether different numbers in labels are written differently.
  template <typename Write>
  bool tells_apart(const Write& write) const {
    double below = least();
    const auto is_told = [&](double at) {
      const bool is_other = at == below || write(at) != write(below);
      below = at;
      return is_other;
    };
    return std::ranges::all_of(style_.classing.breaks, is_told) && is_told(greatest());
  }
  /// Whether the last digit of all numbers in labels is zero.
  bool all_end_with_zero(const NumberFormat& format) const {
    const auto ends_with_zero = [&format](double number) {
      return formatted(number, format).ends_with('0');
    };
    return ends_with_zero(least()) && ends_with_zero(greatest()) &&
           std::ranges::all_of(style_.classing.breaks, ends_with_zero);
  }
  /// The smallest difference between numbers in labels.
  double least_step() const {
    double step = greatest() - least();
    double below = least();
    for (const double at : style_.classing.breaks) {
      if (at > below) step = std::min(step, at - below);
      below = at;
    }
    return step;
  }
  double least() const { return style_.origin->spread->least(); }
  double greatest() const { return style_.origin->spread->greatest(); }

  const LayerStyle& style_;
  std::optional<NumberFormat> format_;
  int significant_ = 0;  // digits, for numbers that decimals do not tell apart; 0: as in the format
};

/// The title of the joined values, if they colour the layer. `query` is its complete style.
std::string title_of_values(const ServedLayer& served, const StyleQuery& query,
                            const LayerStyle& style) {
  const JoinedValues* joined = style.classing.joined.get();
  if (joined == nullptr || !style.origin || style.origin->attribute != kJoinedName) return {};
  if (served.tables != nullptr) {
    // Tables with the same contents may have different titles.
    const ParameterValue* chosen = query.find(served.config.name, ParameterId::values);
    const auto* choice = chosen == nullptr ? nullptr : std::get_if<TableChoice>(chosen);
    const auto wanted =
        choice == nullptr ? served.tables->end() : served.tables->find(choice->name);
    if (wanted != served.tables->end()) {
      const NamedTable& table = wanted->second;
      return table.title.empty() ? table.table->names().value : table.title;
    }
    for (const auto& [name, named] : *served.tables) {
      // Not by address: a join that is kept over a reload has the table that was read before it.
      if (named.table->id() == joined->table().id() && !named.title.empty()) return named.title;
    }
  }
  return joined->table().names().value;
}

LayerLegend legend_of_layer(const ServedLayer& served, const StyleQuery& query, LayerStyle style) {
  LayerLegend legend;
  legend.name = served.config.name;
  legend.title = served.config.title;
  legend.values_title = title_of_values(served, query, style);
  legend.entries = ClassLabels(style).entries(served.config.title);
  legend.style = std::move(style);
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
    auto style = layer_style(*complete, served, *position, Looking::for_legend);
    if (!style) return std::move(style).problem();
    legend.push_back(legend_of_layer(served, *complete, *std::move(style)));
  }
  return legend;
}

Json entry_json(const LegendEntry& entry, const LayerStyle& style) {
  Json json = {{"label", entry.label},
               {"fill", css_colour(entry.paint.fill)},
               {"fill-opacity", entry.paint.fill.a / 255.0 * style.opacity}};
  if (style.stroke.width > 0) {
    json["stroke"] = css_colour(entry.paint.stroke);
    json["stroke-opacity"] = entry.paint.stroke.a / 255.0 * style.opacity;
    json["stroke-width"] = style.stroke.width;
  }
  if (entry.from) json["from"] = *entry.from;
  if (entry.to) json["to"] = *entry.to;
  return json;
}

Json histogram_json(const ValueSpread& spread) {
  constexpr std::size_t kBins = 20;
  if (spread.is_empty()) return nullptr;
  return {
      {"min", spread.least()}, {"max", spread.greatest()}, {"counts", histogram(spread, kBins)}};
}

Json layer_json(const LayerLegend& layer) {
  Json entries = Json::array();
  for (const LegendEntry& entry : layer.entries) entries.push_back(entry_json(entry, layer.style));
  Json json = {{"name", layer.name}, {"title", layer.title}};
  if (!layer.values_title.empty()) json["values_title"] = layer.values_title;
  json["entries"] = std::move(entries);
  if (auto classification = classification_json(layer.style); !classification.is_null()) {
    json["classification"] = std::move(classification);
  }
  if (layer.style.origin && layer.style.origin->spread != nullptr) {
    json["histogram"] = histogram_json(*layer.style.origin->spread);
  }
  return json;
}

std::string legend_json(const std::vector<LayerLegend>& legend) {
  Json layers = Json::array();
  for (const LayerLegend& layer : legend) layers.push_back(layer_json(layer));
  return to_text({{"layers", layers}});
}

// In pixels at scale 1.
constexpr int kLegendMargin = 6;
constexpr int kRowHeight = 16;
constexpr int kLayerGap = 8;  // above and below a layer with several classes
constexpr int kSwatchWidth = 20;
constexpr int kSwatchHeight = 12;
constexpr int kSwatchGap = 6;
constexpr double kMaxSwatchStroke = 4;
constexpr int kMaxLabelWidth = 320;
constexpr int kLegendTextSize = 12;
constexpr int kBaseLine =
    12;  // from the top of its row to the base line, so that capitals are centred
constexpr int kMaxHeight = 8192;  // a short request may have many layers with many classes
constexpr Rgba kPaper{255, 255, 255, 255};
constexpr Rgba kLegendInk{0x22, 0x22, 0x22, 255};
constexpr Rgba kFrame{0x88, 0x88, 0x88, 255};

/// A line of the picture: a title, or a swatch with its label.
struct LegendRow {
  std::string label;
  const LegendEntry* entry = nullptr;  // null for a title
  const LayerLegend* layer = nullptr;
  int top = 0;  // in pixels at scale 1
};

std::vector<LegendRow> rows_of(const std::vector<LayerLegend>& legend) {
  std::vector<LegendRow> rows;
  int top = kLegendMargin;
  const auto add = [&](const LayerLegend& layer, const std::string& label,
                       const LegendEntry* entry) {
    rows.push_back({label, entry, &layer, top});
    top += kRowHeight;
  };
  bool is_below_classes = false;
  for (const LayerLegend& layer : legend) {
    // The only entry of a layer has the layer's title as its label, and does not belong to the
    // classes above it.
    const bool has_classes = layer.entries.size() > 1;
    if (!rows.empty() && (has_classes || is_below_classes)) top += kLayerGap;
    if (has_classes) add(layer, layer.heading(), nullptr);
    for (const LegendEntry& entry : layer.entries) add(layer, entry.label, &entry);
    is_below_classes = has_classes;
  }
  return rows;
}

int left_of_label(const LegendRow& row) {
  return row.entry == nullptr ? kLegendMargin : kLegendMargin + kSwatchWidth + kSwatchGap;
}

/// A polygon drawn as in the map: in a picture of its own, on paper.
class Swatch {
 public:
  explicit Swatch(int scale)
      : scale_(scale),
        view_{kGridMin, kGridMin, kCellsPerPixel, kSwatchWidth * scale, kSwatchHeight * scale} {}

  /// The result is valid until the next call.
  const Picture& draw(const ClassPaint& paint, const LayerLegend& layer) {
    // Wider outlines would leave nothing of the fill.
    Stroke stroke = layer.style.stroke;
    stroke.width = std::min(stroke.width, kMaxSwatchStroke);
    const double inset = scale_ * stroke.width / 2;
    fill_rectangle(inset);
    PaintedClass fill{&fill_, paint.fill};
    PaintedClass line{&line_, paint.stroke};
    PaintedLayer painted{{&fill, 1}, nullptr, layer.style.pattern.colour, {}, layer.style.opacity};
    if (layer.style.pattern.kind != PatternKind::none) {
      pattern_.place(layer.style.pattern, view_, scale_);
      painted.pattern = &pattern_;
    }
    if (layer.style.stroke.width > 0) {
      draw_outline(stroke, inset);
      painted.lines = {&line, 1};
    }
    composer_.compose({&painted, 1}, view_.width, view_.height, kPaper, Quality::exact, runs_);
    picture_ = to_pixels(runs_);
    if (layer.style.stroke.width == 0) draw_frame();
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
    stroker_.add(corners, edges);
    stroker_.draw(stroke);
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
  return (rows.empty() ? kLegendMargin : rows.back().top + kRowHeight) + kLegendMargin;
}

/// The labels by row, cut to the available width.
std::vector<std::string> fitted_labels(const std::vector<LegendRow>& rows, const Fonts& fonts) {
  std::vector<std::string> labels;
  labels.reserve(rows.size());
  for (const LegendRow& row : rows) {
    labels.push_back(fonts.fitted(row.label, kLegendTextSize, kMaxLabelWidth));
  }
  return labels;
}

LegendSize size_of(const std::vector<LegendRow>& rows, const std::vector<std::string>& labels,
                   const Fonts& fonts) {
  int width = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int label = fonts.width_of(labels[i], kLegendTextSize);
    width = std::max(width, left_of_label(rows[i]) + label + kLegendMargin);
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
    if (row.entry != nullptr) {
      copy_into(swatch.draw(row.entry->paint, *row.layer), kLegendMargin * scale,
                (row.top + (kRowHeight - kSwatchHeight) / 2) * scale, picture);
    }
    fonts.draw(labels[i], left_of_label(row) * scale, (row.top + kBaseLine) * scale,
               {kLegendTextSize * scale, kLegendInk}, picture);
  }
  return picture;
}

Result<Document> legend_as_json(std::string_view file, const DocumentRequest& request) {
  file.remove_suffix(kJsonEnding.size());
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
    return Problem{400, "Legends are available as PNG or JSON."};
  }
  const auto layers = parse_layer_list(name->stem);
  if (!layers) return layers.problem();
  const auto legend = legend_of(*layers, request);
  if (!legend) return legend.problem();
  const std::vector<LegendRow> rows = rows_of(*legend);
  const int scale = name->scale;
  if (height_of(rows) * scale > kMaxHeight) {
    return Problem{
        400,
        fmt::format(
            "A legend is at most {} pixels high: use fewer layers or classes, or request .json.",
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
    if (file.ends_with(kJsonEnding)) return legend_as_json(file, request);
    if (file.ends_with(".png")) return legend_as_png(file, request);
  }
  return Problem{404, fmt::format("There is nothing here. Legends are at {}.", kLegendPattern)};
}

}  // namespace trapeze
