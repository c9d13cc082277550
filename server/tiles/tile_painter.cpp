#include "server/tiles/tile_painter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "render/mask/stopwatch.h"
#include "render/picture/debug_marks.h"
#include "render/picture/webp.h"
#include "render/text/label.h"
#include "server/base/build_id.h"
#include "server/base/content_hash.h"
#include "server/labels/draw_labels.h"
#include "server/tiles/layer_pieces.h"
#include "server/tiles/map_window.h"

namespace trapeze {
namespace {

constexpr std::size_t kMaxConstants = 64;

constexpr Rgba kMeshColour{0x20, 0x30, 0x48, 150};
constexpr Rgba kVertexColour{0xc0, 0x20, 0x20, 255};
constexpr Rgba kJunctionColour{0x10, 0x18, 0x30, 255};
constexpr Rgba kBorderColour{0x70, 0x20, 0x90, 255};
constexpr int kLabelSize = 13;

constexpr int kBandRows = 256;
constexpr std::int64_t kPixelsOfLargePicture = std::int64_t{1} << 20;

View with_margin(const View& view) {
  constexpr int kPixels = 4;
  View around = view;
  around.origin_x -= static_cast<std::int64_t>(std::ceil(kPixels * view.cells_per_pixel));
  around.origin_y -= static_cast<std::int64_t>(std::ceil(kPixels * view.cells_per_row()));
  around.width += 2 * kPixels;
  around.height += 2 * kPixels;
  return around;
}

View band_of(const TilePlan& plan, int band) {
  const int first = band * kBandRows;
  return plan.view.band(first, std::min(kBandRows, plan.view.height - first));
}

/// Adds properties that tiles do not have. Off the world, places in one copy of it look like those
/// in another.
void add_unusual(const View& view, ContentHash& hash) {
  if (view.stretch != 1) hash.add(std::bit_cast<std::uint64_t>(view.stretch));
  if (view.is_on_world()) return;
  hash.add(static_cast<std::uint64_t>(view.origin_x));
  hash.add(static_cast<std::uint64_t>(view.origin_y));
}

/// Adds the times of a band to those of its tile.
void add_times(const PaintTimes& more, PaintTimes& times) {
  times.select_ms += more.select_ms;
  times.draw_ms += more.draw_ms;
  times.read_ms += more.read_ms;
  times.resolve_ms += more.resolve_ms;
  times.compose_ms += more.compose_ms;
}

}  // namespace

TilePainter::TilePainter(std::unique_ptr<MaskRenderer> renderer,
                         std::shared_ptr<FeatureClassCache> classes,
                         std::shared_ptr<const Fonts> fonts, std::shared_ptr<LabelBook> labels)
    : renderer_(std::move(renderer)),
      renderer_identity_(renderer_->identity()),
      classes_(std::move(classes)),
      fonts_(std::move(fonts)),
      labels_(std::move(labels)) {}

std::shared_ptr<FeatureClassCache> TilePainter::new_class_cache() {
  return std::make_shared<FeatureClassCache>(std::size_t{64} << 20);
}

std::vector<std::optional<PaintedTile>> TilePainter::paint(std::span<const PaintJob> jobs) {
  drawing_count_ = 0;
  std::vector<Sketch> sketches;
  for (const PaintJob& job : jobs) {
    sketches.push_back(sketch(job, job.plan->view));
    Sketch& last = sketches.back();
    if (last.is_cancelled) continue;
    const Stopwatch stopwatch(last.times.select_ms);
    last.fingerprint = fingerprint_of(*job.plan, last);
    last.is_wanted = !job.is_wanted || job.is_wanted(last.fingerprint);
    if (last.is_wanted) continue;
    drawing_count_ = last.end_drawing = last.first_drawing;
  }
  const DrawTimes drawn = draw(jobs, sketches);

  std::vector<std::optional<PaintedTile>> tiles;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Sketch& sketch = sketches[i];
    if (sketch.is_cancelled) {
      tiles.emplace_back();
      continue;
    }
    note_times(drawn, sketch);
    if (sketch.is_wanted) {
      tiles.emplace_back(finish(*jobs[i].plan, sketch));
    } else {
      tiles.emplace_back(PaintedTile{{}, nullptr, TileHint::none, sketch.times});
    }
    tiles.back()->fingerprint = std::move(sketch.fingerprint);
  }
  return tiles;
}

std::string TilePainter::identify(const PaintJob& job) {
  drawing_count_ = 0;
  const Sketch sketch = this->sketch(job, job.plan->view);
  if (sketch.is_cancelled) throw Cancelled();
  return fingerprint_of(*job.plan, sketch);
}

bool TilePainter::is_constant(const TilePlan& plan, const Sketch& sketch) const {
  const auto first = drawings_.begin() + static_cast<std::ptrdiff_t>(sketch.first_drawing);
  const auto end = drawings_.begin() + static_cast<std::ptrdiff_t>(sketch.end_drawing);
  return !plan.debug.any() &&
         std::all_of(first, end, [](const LayerDrawing& drawing) { return drawing.is_constant(); });
}

std::string TilePainter::fingerprint_of(const TilePlan& plan, const Sketch& sketch) const {
  const View& view = sketch.view;
  ContentHash hash;
  hash.add(kPictureVersion);
  hash.add(static_cast<std::uint64_t>(view.width));
  hash.add(static_cast<std::uint64_t>(view.height));
  hash.add(to_hex(plan.background));
  hash.add(plan.format == TileFormat::webp ? static_cast<std::uint64_t>(webp_version()) : 0);
  hash.add(kQualityNames.name_of(plan.quality));
  if (plan.debug.any()) {
    hash.add(build_id());
    hash.add(plan.key());
  }
  const std::size_t drawings = sketch.end_drawing - sketch.first_drawing;
  hash.add(drawings);
  const bool is_drawn = !is_constant(plan, sketch);
  if (is_drawn) {
    hash.add(renderer_identity_);
    hash.add(std::bit_cast<std::uint64_t>(view.cells_per_pixel));
    add_unusual(view, hash);
  }
  for (std::size_t k = sketch.first_drawing; k < sketch.end_drawing; ++k) {
    // Layers are searched for shared borders up to the distance of their boundaries from the true
    // ones.
    if (is_drawn && drawings > 1) {
      hash.add(std::bit_cast<std::uint64_t>(drawings_[k].tolerance()));
    }
    // Copies of one layer are added up; a layer lies over another one.
    const bool is_copy =
        k > sketch.first_drawing && drawings_[k].is_of_same_layer(drawings_[k - 1]);
    if (is_copy) hash.add("copy");
    drawings_[k].add_to(hash, view);
  }
  for (const DrawnLabel& label : sketch.labels) {
    hash.add(label.image->look().identity);
    hash.add(static_cast<std::uint64_t>(label.left));
    hash.add(static_cast<std::uint64_t>(label.top));
  }
  return hash.hex();
}

int TilePainter::bands_of(const TilePlan& plan) {
  const View& view = plan.view;
  const bool is_large = std::int64_t{view.width} * view.height >= kPixelsOfLargePicture;
  return is_large && !plan.debug.any() ? (view.height + kBandRows - 1) / kBandRows : 1;
}

std::optional<PaintedBand> TilePainter::paint_band(const PaintJob& job, int band) {
  drawing_count_ = 0;
  Sketch sketch = this->sketch(job, band_of(*job.plan, band));
  note_times(draw({&job, 1}, {&sketch, 1}), sketch);
  if (sketch.is_cancelled) return std::nullopt;
  TilePlan exact = *job.plan;  // colours are reduced for all bands together, when they are joined
  exact.quality = Quality::exact;
  const bool is_constant = !compose(exact, sketch);
  PaintedBand painted;
  painted.hint = picture_.colours.size() == 1 ? hint_of(sketch) : TileHint::none;
  if (is_constant) {
    const Rgba colour = picture_.at(0, 0);
    composer_.compose({}, sketch.view.width, sketch.view.height, colour, Quality::exact, picture_);
  }
  painted.picture = std::move(picture_);
  painted.times = sketch.times;
  return painted;
}

PaintedTile TilePainter::join(const TilePlan& plan, std::span<const PaintedBand> bands) {
  PaintedTile tile;
  std::vector<const RunPicture*> pictures;
  for (const PaintedBand& band : bands) {
    pictures.push_back(&band.picture);
    add_times(band.times, tile.times);
  }
  const Stopwatch stopwatch(tile.times.encode_ms);
  picture_ = joined(pictures);
  if (plan.quality == Quality::bounded) ColourReducer().reduce(picture_);
  const bool are_alike = std::ranges::all_of(
      bands, [&](const PaintedBand& band) { return band.hint == bands.front().hint; });
  if (picture_.colours.size() == 1 && are_alike) tile.hint = bands.front().hint;
  tile.has_palette = picture_.colours.size() <= kPaletteColours;
  tile.bytes = std::make_shared<const std::string>(encode(plan.format));
  return tile;
}

/// Time shared by tiles that were drawn together is split by their number of tasks.
void TilePainter::note_times(const DrawTimes& drawn, Sketch& sketch) const {
  const double part = static_cast<double>(sketch.tasks) /
                      static_cast<double>(std::max<std::size_t>(tasks_.size(), 1));
  sketch.times.draw_ms += drawn.draw_ms * part;
  sketch.times.read_ms += drawn.read_ms * part;
  sketch.times.resolve_ms += drawn.resolve_ms * part;
}

TilePainter::Sketch TilePainter::sketch(const PaintJob& job, const View& view) {
  Sketch sketch;
  sketch.view = view;
  sketch.first_drawing = drawing_count_;
  tools_.cancellation = job.cancellation;
  try {
    select(*job.plan, sketch);
  } catch (const Cancelled&) {
    sketch.is_cancelled = true;
    drawing_count_ = sketch.first_drawing;
  }
  sketch.end_drawing = drawing_count_;
  return sketch;
}

void TilePainter::release_memory() {
  drawings_.clear();
  drawing_count_ = 0;
  // {} would assign an empty list, which keeps the memory of a vector.
  tasks_ = std::vector<MaskTask>();
  painted_ = std::vector<PaintedLayer>();
  tolerances_ = std::vector<double>();
  meetings_ = {};
  picture_ = {};
  tools_ = {};
  renderer_->release_memory();
}

// From the top down: anything below an opaque layer that covers everything is skipped.
void TilePainter::select(const TilePlan& plan, Sketch& sketch) {
  const Stopwatch stopwatch(sketch.times.select_ms);
  for (auto paint = plan.layers.rbegin(); paint != plan.layers.rend(); ++paint) {
    if (!paint->style.is_visible()) continue;  // included for its marks only
    const std::size_t first = drawing_count_;
    for (const View& copy : views_of_copies(sketch.view, reach_of_lines(plan, *paint))) {
      if (drawing_count_ == drawings_.size()) drawings_.emplace_back();
      LayerDrawing& drawing = drawings_[drawing_count_];
      if (drawing.select(plan, *paint, copy, pieces_for(plan, *paint, copy), tools_)) {
        ++drawing_count_;
      }
    }
    if (drawing_count_ > first && drawings_[first].hides_all()) break;
  }
  if (plan.labels.empty()) return;
  sketch.labels = labels_->find({*plan.dataset, plan.labels, sketch.view, plan.scale});
}

std::vector<DrawnPiece> TilePainter::pieces_for(const TilePlan& plan, const LayerPaint& paint,
                                                const View& view) {
  const Classing& classing = paint.style.classing;
  const ServedLayer& served = plan.dataset->layers_on_all_grids()[paint.layer];
  std::vector<DrawnPiece> pieces;
  for (const LayerPiece& piece : pieces_in_view(plan, paint, view)) {
    std::shared_ptr<const FeatureClasses> classes;
    if (!classing.is_plain() && served.parts != nullptr) {
      const FeatureTable& features = piece.layer->features();
      classes = classes_->find(piece.revision, classing.over(features), features);
    } else if (!classing.is_plain()) {
      classes = classes_->find(served.revision, classing, served.layer->features());
    }
    pieces.push_back({piece.layer, std::move(classes)});
  }
  return pieces;
}

DrawTimes TilePainter::draw(std::span<const PaintJob> jobs, std::span<Sketch> sketches) {
  tasks_.clear();
  for (std::size_t i = 0; i < jobs.size(); ++i) draw_details(jobs[i], sketches[i]);
  if (tasks_.empty()) return {};
  const auto forget_made = [this] {
    for (std::size_t k = 0; k < drawing_count_; ++k) drawings_[k].forget_made(*renderer_);
  };
  try {
    const DrawTimes times = renderer_->draw(tasks_);
    forget_made();
    return times;
  } catch (...) {
    forget_made();
    throw;
  }
}

// Draws the outlines and patterns of one tile, and adds its masks to those to be drawn.
void TilePainter::draw_details(const PaintJob& job, Sketch& sketch) {
  const View& view = sketch.view;
  const std::size_t tasks_before = tasks_.size();
  tools_.cancellation = job.cancellation;
  try {
    const Stopwatch stopwatch(sketch.times.draw_ms);
    for (std::size_t k = sketch.first_drawing; k < sketch.end_drawing; ++k) {
      drawings_[k].add_tasks(job.cancellation, tasks_);
      drawings_[k].draw_details(view, job.plan->scale, tools_);
    }
  } catch (const Cancelled&) {
    sketch.is_cancelled = true;
    tasks_.resize(tasks_before);
  }
  sketch.tasks = tasks_.size() - tasks_before;
}

PaintedTile TilePainter::finish(const TilePlan& plan, Sketch& sketch) {
  const View& view = sketch.view;
  const bool is_constant = !compose(plan, sketch);
  PaintedTile tile{{}, nullptr, TileHint::none, sketch.times};
  if (plan.debug.any()) {
    const Stopwatch stopwatch(tile.times.compose_ms);
    Picture marked = to_pixels(picture_);
    mark(plan, view, marked);
    picture_ = to_runs(marked);
  }
  const Stopwatch stopwatch(tile.times.encode_ms);
  if (picture_.colours.size() == 1 && !plan.debug.any()) tile.hint = hint_of(sketch);
  tile.has_palette = picture_.colours.size() <= kPaletteColours;
  tile.bytes = is_constant ? constant(picture_.at(0, 0), view.width, view.height, plan.format)
                           : std::make_shared<const std::string>(encode(plan.format));
  return tile;
}

bool TilePainter::compose(const TilePlan& plan, Sketch& sketch) {
  const View& view = sketch.view;
  const Stopwatch stopwatch(sketch.times.compose_ms);
  const bool is_constant = this->is_constant(plan, sketch);
  painted_.clear();
  tolerances_.clear();
  for (std::size_t k = sketch.end_drawing; k-- > sketch.first_drawing;) {
    if (k > sketch.first_drawing && drawings_[k - 1].is_of_same_layer(drawings_[k])) {
      drawings_[k - 1].take_over(drawings_[k]);
      continue;
    }
    painted_.push_back(drawings_[k].painted());
    tolerances_.push_back(drawings_[k].tolerance());
  }
  if (!is_constant) meetings_.find(painted_, tolerances_, view.width, view.height);
  const Quality quality = sketch.labels.empty() ? plan.quality : Quality::exact;
  composer_.compose(painted_, is_constant ? 1 : view.width, is_constant ? 1 : view.height,
                    plan.background, quality, picture_);
  if (sketch.labels.empty()) return !is_constant;
  if (is_constant) {
    const Rgba colour = picture_.at(0, 0);
    composer_.compose({}, view.width, view.height, colour, Quality::exact, picture_);
  }
  draw_labels(sketch.labels, picture_);
  if (plan.quality == Quality::bounded) ColourReducer().reduce(picture_);
  return true;
}

// For a tile of one colour.
TileHint TilePainter::hint_of(const Sketch& sketch) const {
  TileHint hint = TileHint::empty;
  for (std::size_t k = sketch.first_drawing; k < sketch.end_drawing; ++k) {
    if (drawings_[k].is_full()) {
      hint = TileHint::full;
    } else if (!drawings_[k].is_empty()) {
      return TileHint::none;
    }
  }
  return hint;
}

std::string TilePainter::encode(TileFormat format) {
  return format == TileFormat::webp ? encode_webp(picture_) : encoder_.encode(picture_);
}

std::shared_ptr<const std::string> TilePainter::constant(Rgba colour, int width, int height,
                                                         TileFormat format) {
  auto& bytes = constants_[{to_hex(colour), width, height, format}];
  if (bytes != nullptr) return bytes;
  composer_.compose({}, width, height, colour, Quality::exact, picture_);
  auto made = std::make_shared<const std::string>(encode(format));
  bytes = made;
  if (constants_.size() > kMaxConstants) constants_.clear();
  return made;
}

void TilePainter::mark(const TilePlan& plan, const View& view, Picture& picture) {
  for (const View& copy : views_of_copies(view)) mark_layers(plan, copy, picture);
  if (!plan.debug.tile) return;
  mark_border(kBorderColour, picture);
  draw_label(plan.caption, 3, 3, {kLabelSize, kBorderColour}, *fonts_, picture);
}

void TilePainter::mark_layers(const TilePlan& plan, const View& view, Picture& picture) {
  for (const LayerPaint& paint : plan.layers) {
    for (const LayerPiece& piece : pieces_in_view(plan, paint, view)) {
      mark_piece(plan, paint, *piece.layer, view, picture);
    }
  }
}

void TilePainter::mark_piece(const TilePlan& plan, const LayerPaint& paint, const Layer& layer,
                             const View& view, Picture& picture) {
  const View around = with_margin(view);  // for marks that reach into the picture
  std::vector<TrapezoidRange> ranges;
  layer.select({around.box(), paint.level, plan.pixel_level(), SmallPolygons::drop}, ranges);
  const FeatureOf feature_of = [&layer](std::uint32_t i) { return layer.feature_of(i); };
  if (plan.debug.faces) mark_faces(layer.mesh(), ranges, feature_of, view, picture);
  if (plan.debug.mesh) mark_mesh(layer.mesh(), ranges, view, kMeshColour, picture);
  if (plan.debug.vertices) mark_vertices(layer.mesh(), ranges, view, kVertexColour, picture);
  if (!plan.debug.junctions) return;
  std::vector<TrapezoidRange> horizontal_edges;
  layer.select_horizontal_edges(around.box(), paint.level, horizontal_edges);
  mark_junctions(layer.mesh(), ranges, horizontal_edges, feature_of, view, kJunctionColour,
                 picture);
}

}  // namespace trapeze
