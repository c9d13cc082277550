#include "server/labels/label_book.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "core/grid/plate_carree.h"
#include "core/layer/class_dust.h"
#include "server/base/content_hash.h"
#include "server/labels/broken_lines.h"

namespace trapeze {
namespace {

// Around each label, so that two labels do not touch even after both are moved to whole pixels.
constexpr double kGap = 1;  // pixels
// How much more room than its nominal size a label may need, as letters reach beyond their lines.
constexpr double kSlackPixels = 3;
constexpr double kSlackEms = 0.35;
constexpr double kMostPixels = 1024;  // of a label, in width and in height
constexpr double kLeastWidth = 1;     // ems, of lines
// How far a simplified boundary may be from the true one, per tolerance: the next larger tolerance
// of the ladder may be used, and the edge is a pixel wide.
constexpr double kToleranceReach = 1.5;
constexpr double kEdgePixels = 0.5;
// The cost of placing a label, with its anchor and the width of its text.
constexpr std::uint64_t kSidesPerLabel = 60;
constexpr std::size_t kImageBudget = std::size_t{48} << 20;

double slack_of(std::span<const LabelledLayer> layers) {
  double size = 0;
  for (const LabelledLayer& layer : layers) size = std::max(size, layer.style->size);
  return kSlackPixels + kSlackEms * size;
}

/// The maximum length of lines of a text, in ems.
double longest_line(const LabelStyle& style) {
  return std::max(style.max_width / style.size, kLeastWidth);
}

double pixels_per_cell_at_zoom(double zoom) {
  return std::exp2(zoom) * kTilePixels / static_cast<double>(kGridSize);
}

/// If pixels are not square, the longer side counts: labels are closest to each other along it.
double pixels_per_cell_of(const LabelledView& wanted) {
  const View& view = wanted.view;
  return 1 / (std::max(view.cells_per_pixel, view.cells_per_row()) * wanted.scale);
}

/// The picture on the plane in which its labels are placed.
PlaneBox box_of(const View& view) {
  const double top = static_cast<double>(view.origin_y) + view.first_row * view.cells_per_row();
  return {static_cast<double>(view.origin_x), top,
          static_cast<double>(view.origin_x) + view.width * view.cells_per_pixel,
          top + view.height * view.cells_per_row()};
}

/// By how many cells to move the world so that copies of it are visible in or near the box.
std::vector<double> shifts_of(const View& view, const PlaneBox& box, double reach) {
  if (view.projection == Projection::plane) return {0};
  const auto world = static_cast<double>(kGridSize);
  std::vector<double> shifts;
  const auto copy_of = [world](double x) {
    return static_cast<int>(std::floor((x - kGridMin) / world));
  };
  for (int copy = copy_of(box.min_x - reach); copy <= copy_of(box.max_x + reach); ++copy) {
    shifts.push_back(copy * world);
  }
  return shifts;
}

}  // namespace

// A placement, with the sources of its labels.
struct LabelBook::Placed {
  struct Source {
    std::uint32_t layer = 0;  // among the labelled layers
    std::uint32_t row = 0;
    Room room;
  };
  LabelPlacement placement;
  std::vector<Source> sources;  // by number of the candidate
};

struct LabelBook::Entry {
  std::once_flag once;
  std::shared_ptr<const LabelAnchors> anchors;
  std::shared_ptr<const Placed> placed;
  std::atomic<bool> is_made = false;
};

// Creates the candidates for the layers of one picture.
class LabelBook::Placing {
 public:
  Placing(LabelBook& book, const LabelledView& wanted)
      : book_(book), wanted_(wanted), projection_(wanted.view.projection) {}

  std::shared_ptr<const Placed> place() {
    // Layers on top are labelled first.
    for (std::size_t i = wanted_.layers.size(); i-- > 0;) {
      add_layer(static_cast<std::uint32_t>(i), wanted_.layers[i]);
    }
    const double world = projection_ == Projection::plane ? 0 : static_cast<double>(kGridSize);
    return std::make_shared<const Placed>(
        Placed{LabelPlacement(std::move(candidates_), world), std::move(sources_)});
  }

 private:
  struct Ranked {
    double priority = 0;
    const LabelAnchor* anchor = nullptr;
    LabelCandidate candidate;
    Room room;
    std::string text;
  };

  void add_layer(std::uint32_t number, const LabelledLayer& layer) {
    const ServedLayer& served = wanted_.dataset.layers_on_all_grids()[layer.layer];
    const FeatureTable& features = served.layer->features();
    const FeatureClassifier classifier(layer.classing, features);
    const Attributes attributes(features, layer.style->joined);
    const Fonts& fonts = *book_.fonts_for(*layer.style);
    const auto anchors =
        book_.anchors_of(served, layer.style->all_parts ? LabelParts::all : LabelParts::largest);
    std::vector<Ranked> ranked;
    for (const LabelAnchor& anchor : anchors->all()) {
      if (classifier.class_of(anchor.row) == kNotDrawn) continue;
      std::string text = layer.style->text_of(features, anchor.row, fonts);
      if (text.empty()) continue;
      const Room& room = extent_of(layer, text);
      const bool has_font = room.width > 0;
      if (!has_font || room.width > kMostPixels || room.height > kMostPixels) continue;
      ranked.push_back({priority_of(layer, attributes, anchor), &anchor,
                        candidate_of(layer, anchor, room), room, std::move(text)});
    }
    std::ranges::sort(ranked, [](const Ranked& a, const Ranked& b) {
      const auto key = [](const Ranked& r) {
        return std::tuple(-r.priority, -r.anchor->area, r.anchor->row);
      };
      return key(a) < key(b);
    });
    std::unordered_set<std::string> shown;
    for (const Ranked& each : ranked) {
      if (!layer.style->repeats && !shown.insert(each.text).second) continue;
      candidates_.push_back(each.candidate);
      sources_.push_back({number, each.anchor->row, each.room});
    }
    extents_.clear();
  }

  static double priority_of(const LabelledLayer& layer, const Attributes& attributes,
                            const LabelAnchor& anchor) {
    const double last = -std::numeric_limits<double>::infinity();
    if (layer.style->priority < 0) return anchor.area;
    const Value value = attributes.value(anchor.row, layer.style->priority);
    double number = last;
    if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      number = static_cast<double>(*integer);
    } else if (const auto* real = std::get_if<double>(&value)) {
      number = *real;
    }
    return std::isnan(number) ? last : number;
  }

  /// Many features have the same text.
  const Room& extent_of(const LabelledLayer& layer, const std::string& text) {
    const auto [found, is_new] = extents_.try_emplace(text);
    if (is_new) {
      const LabelStyle& style = *layer.style;
      const BrokenLines broken = broken_lines(text, longest_line(style), *book_.fonts_for(style));
      found->second = {broken.width * style.size,
                       broken.line_height * style.size * static_cast<double>(broken.lines.size())};
    }
    return found->second;
  }

  LabelCandidate candidate_of(const LabelledLayer& layer, const LabelAnchor& anchor,
                              const Room& room) const {
    const LabelStyle& style = *layer.style;
    LabelCandidate candidate;
    candidate.x = anchor.place.x;
    candidate.y = anchor.place.y;
    const double half_width = room.width / 2 + style.halo_width;
    const double half_height = room.height / 2 + style.halo_width;
    candidate.half_width = static_cast<float>(half_width + kGap);
    candidate.half_height = static_cast<float>(half_height + kGap);
    double stretch = 1;  // cells of the grid per cell of the plane, from north to south
    if (projection_ == Projection::plate_carree) {
      stretch = mercator_stretch(candidate.y);
      candidate.y = plate_carree_from_mercator(candidate.y);
    }
    // The ellipse around the anchor contains the corners of the part that must stay inside the
    // polygon.
    const double inner_width = std::max(half_width - style.overhang, 0.0);
    const double inner_height = std::max(half_height - style.overhang, 0.0);
    const double depth = anchor.depth;
    const double fits =
        std::hypot(inner_width / LabelAnchors::kSqueeze, inner_height * stretch) / depth;
    const double is_inside = (kToleranceReach * layer.tolerance + kEdgePixels) * stretch / depth;
    const double is_large = style.min_size * std::sqrt(stretch / std::max(anchor.area, 1.0F));
    candidate.least_scale =
        std::max({fits, is_inside, is_large,
                  layer.min_zoom > 0 ? pixels_per_cell_at_zoom(layer.min_zoom) : 0.0});
    return candidate;
  }

  LabelBook& book_;
  const LabelledView& wanted_;
  const Projection projection_;
  std::unordered_map<std::string, Room> extents_;  // by text, for the current layer
  std::vector<LabelCandidate> candidates_;
  std::vector<Placed::Source> sources_;
};

LabelBook::LabelBook(FontChoice fonts, std::size_t budget)
    : fonts_(std::move(fonts)), kept_(budget), anchors_(budget), images_(kImageBudget) {}

LabelBook::~LabelBook() = default;

const std::shared_ptr<const Fonts>& LabelBook::fonts_for(const LabelStyle& style) const {
  const auto named = fonts_.named.find(style.font);
  return named == fonts_.named.end() ? fonts_.usual : named->second;
}

std::string LabelBook::identity_of_fonts() const {
  std::string text = fonts_.usual->identity();
  for (const auto& [name, fonts] : fonts_.named) text += "; " + name + ": " + fonts->identity();
  return text;
}

std::shared_ptr<LabelBook::Entry> LabelBook::entry(Entries& entries, const std::string& key) {
  const std::lock_guard lock(mutex_);
  if (auto* found = entries.find(key)) return *found;
  return entries.insert(key, std::make_shared<Entry>(), key.size());
}

// The entry counts with its size from the time that it is known.
void LabelBook::set_size(Entries& entries, const std::string& key, std::shared_ptr<Entry> entry,
                         std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  entries.erase(key);
  entries.insert(key, std::move(entry), key.size() + bytes);
}

std::shared_ptr<const LabelAnchors> LabelBook::anchors_of(const ServedLayer& served,
                                                          LabelParts parts) {
  const std::string key = fmt::format("{:016x} {}", served.revision, static_cast<int>(parts));
  const auto entry = this->entry(anchors_, key);
  std::call_once(entry->once, [&] {
    const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
    const bool are_known = !served.label_anchors.empty() && served.whole == nullptr;
    entry->anchors = are_known
                         ? std::make_shared<const LabelAnchors>(served.label_anchors, parts)
                         : std::make_shared<const LabelAnchors>(*served.layer, parts, threads);
    set_size(anchors_, key, entry, entry->anchors->memory());
  });
  return entry->anchors;
}

std::string LabelBook::key_of(const LabelledView& wanted) {
  std::string key = fmt::format("placed {}", static_cast<int>(wanted.view.projection));
  for (const LabelledLayer& layer : wanted.layers) {
    const ServedLayer& served = wanted.dataset.layers_on_all_grids()[layer.layer];
    key += fmt::format(" {:016x} {} {} {} {}", served.revision, layer.tolerance, layer.min_zoom,
                       layer.style->placement_key(),
                       layer.classing.is_plain() ? "" : layer.classing.key());
  }
  return key;
}

std::shared_ptr<const LabelBook::Placed> LabelBook::placed(const LabelledView& wanted) {
  const std::string key = key_of(wanted);
  const auto entry = this->entry(kept_, key);
  std::call_once(entry->once, [&] {
    entry->placed = Placing(*this, wanted).place();
    set_size(kept_, key, entry,
             entry->placed->placement.memory() +
                 entry->placed->sources.capacity() * sizeof(Placed::Source));
    entry->is_made = true;
  });
  return entry->placed;
}

std::uint64_t LabelBook::cost_of(const LabelledView& wanted) const {
  if (wanted.layers.empty()) return 0;
  {
    const std::lock_guard lock(mutex_);
    if (kept_.find(key_of(wanted)) != nullptr) return 0;
  }
  std::uint64_t labels = 0;
  for (const LabelledLayer& layer : wanted.layers) {
    const ServedLayer& served = wanted.dataset.layers_on_all_grids()[layer.layer];
    const std::size_t features = served.layer->features().size();
    // A few features may have thousands of parts, such as countries with islands.
    labels += layer.style->all_parts ? std::max(features, served.report.polygons) : features;
  }
  return labels * kSidesPerLabel;
}

bool LabelBook::has_placed(const LabelledView& wanted) const {
  if (wanted.layers.empty()) return true;
  const std::lock_guard lock(mutex_);
  const auto* found = kept_.find(key_of(wanted));
  return found != nullptr && (*found)->is_made;
}

const std::string& LabelBook::identity_of(const Fonts& fonts) {
  const std::lock_guard lock(mutex_);
  std::string& identity = identities_[&fonts];
  if (identity.empty()) identity = fonts.identity();
  return identity;
}

std::shared_ptr<const LabelImage> LabelBook::image_of(const LabelledLayer& layer,
                                                      const FeatureTable& features,
                                                      std::uint32_t row, const Room& room,
                                                      double scale) {
  const LabelStyle& style = *layer.style;
  const std::shared_ptr<const Fonts>& fonts = fonts_for(style);
  std::string text = style.text_of(features, row, *fonts);
  // A halo without a width must not show at the rims of letters, which cover pixels in part.
  const Rgba halo_colour = style.halo_width > 0 ? style.halo_colour : kTransparent;
  const std::string key =
      fmt::format("{} {} {} {} {} {} {} {}", style.font, style.size, style.max_width,
                  style.halo_width, scale, to_hex(style.colour), to_hex(halo_colour), text);
  {
    const std::lock_guard lock(mutex_);
    if (const auto* found = images_.find(key)) return *found;
  }
  const double half_width = room.width / 2 + style.halo_width + kSlackPixels / 2;
  const double half_height = room.height / 2 + style.halo_width + kSlackEms * style.size;
  const int width = 2 * static_cast<int>(std::ceil(half_width * scale));
  const int height = 2 * static_cast<int>(std::ceil(half_height * scale));
  ContentHash hash;
  hash.add(key);
  hash.add(identity_of(*fonts));
  auto draw = [fonts, text = std::move(text), size = style.size, halo = style.halo_width, scale,
               most = longest_line(style), width, height] {
    const BrokenLines broken = broken_lines(text, most, *fonts);
    return fonts->mask_of(broken.lines, size * scale, broken.line_height * size * scale,
                          halo * scale, width, height);
  };
  auto image = std::make_shared<const LabelImage>(
      LabelImage::Look{width, height, style.colour, halo_colour, hash.hex()}, std::move(draw));
  const std::size_t bytes = key.size() +
                            2 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height) +
                            sizeof(LabelImage);
  const std::lock_guard lock(mutex_);
  if (const auto* found = images_.find(key)) return *found;
  return images_.insert(key, std::move(image), bytes);
}

std::vector<DrawnLabel> LabelBook::find(const LabelledView& wanted) {
  if (wanted.layers.empty()) return {};
  const auto placed = this->placed(wanted);
  const View& view = wanted.view;
  const double pixels_per_cell = pixels_per_cell_of(wanted);
  const double slack = slack_of(wanted.layers);
  const PlaneBox box = box_of(view);
  std::vector<DrawnLabel> labels;
  const double reach = placed->placement.reach(pixels_per_cell, slack);
  for (const double shift : shifts_of(view, box, reach)) {
    std::vector<std::uint32_t> numbers;
    placed->placement.find({box.min_x - shift, box.min_y, box.max_x - shift, box.max_y},
                           pixels_per_cell, slack, numbers);
    std::ranges::sort(numbers);
    for (const std::uint32_t number : numbers) {
      const Placed::Source& source = placed->sources[number];
      const LabelledLayer& layer = wanted.layers[source.layer];
      if (!layer.is_drawn) continue;
      const FeatureTable& features =
          wanted.dataset.layers_on_all_grids()[layer.layer].layer->features();
      DrawnLabel label{image_of(layer, features, source.row, source.room, wanted.scale)};
      const LabelCandidate& candidate = placed->placement.candidates()[number];
      const double column =
          (candidate.x + shift - static_cast<double>(view.origin_x)) / view.cells_per_pixel;
      const double row = (candidate.y - static_cast<double>(view.origin_y)) / view.cells_per_row();
      const auto& [width, height, letters, halo, identity] = label.image->look();
      label.left = static_cast<int>(std::floor(column + 0.5)) - width / 2;
      label.top = static_cast<int>(std::floor(row + 0.5)) - view.first_row - height / 2;
      const bool is_seen = label.left < view.width && label.left + width > 0 &&
                           label.top < view.height && label.top + height > 0;
      if (is_seen) labels.push_back(std::move(label));
    }
  }
  return labels;
}

std::vector<PlacedLabel> LabelBook::all_at_scale_of(const LabelledView& wanted) {
  std::vector<PlacedLabel> labels;
  const double pixels_per_cell = pixels_per_cell_of(wanted);
  const std::optional<int> step = LabelPlacement::step_of(pixels_per_cell);
  if (wanted.layers.empty() || !step) return labels;
  const auto placed = this->placed(wanted);
  const double slack = slack_of(wanted.layers);
  const std::span<const LabelCandidate> candidates = placed->placement.candidates();
  for (std::uint32_t number = 0; number < candidates.size(); ++number) {
    const Placed::Source& source = placed->sources[number];
    const LabelledLayer& layer = wanted.layers[source.layer];
    if (!layer.is_drawn || placed->placement.first_step_of(number) > *step) continue;
    const FeatureTable& features =
        wanted.dataset.layers_on_all_grids()[layer.layer].layer->features();
    const LabelCandidate& candidate = candidates[number];
    labels.push_back({candidate.x, candidate.y, (candidate.half_width + slack) / pixels_per_cell,
                      (candidate.half_height + slack) / pixels_per_cell, source.layer,
                      layer.style->text_of(features, source.row, *fonts_for(*layer.style))});
  }
  return labels;
}

bool LabelBook::is_any_from(const LabelledView& wanted) {
  if (wanted.layers.empty()) return false;
  const auto placed = this->placed(wanted);
  const double pixels_per_cell = pixels_per_cell_of(wanted);
  const double slack = slack_of(wanted.layers);
  const PlaneBox box = box_of(wanted.view);
  const double reach = placed->placement.reach(pixels_per_cell, slack);
  return std::ranges::any_of(shifts_of(wanted.view, box, reach), [&](double shift) {
    return placed->placement.is_any_from(
        {box.min_x - shift, box.min_y, box.max_x - shift, box.max_y}, pixels_per_cell, slack);
  });
}

std::size_t LabelBook::memory() const {
  const std::lock_guard lock(mutex_);
  return kept_.bytes() + anchors_.bytes() + images_.bytes();
}

}  // namespace trapeze
