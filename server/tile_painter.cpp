#include "server/tile_painter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/debug_marks.h"
#include "render/stopwatch.h"

namespace trapeze {
namespace {

constexpr std::size_t kMaxConstants = 64;

constexpr Rgba kMeshColour{0x20, 0x30, 0x48, 150};
constexpr Rgba kVertexColour{0xc0, 0x20, 0x20, 255};
constexpr Rgba kBorderColour{0x70, 0x20, 0x90, 255};

const Layer& painted_layer(const TilePlan& plan, const LayerPaint& paint) {
  const Layer& layer = *plan.dataset->layers()[paint.layer].layer;
  return paint.topology == Topology::fast ? layer.without_topology_test() : layer;
}

/// At least `side` cells wide and high, around the same middle.
Box widened(const Box& box, std::int64_t side) {
  const auto widen = [side](std::int32_t& min, std::int32_t& max) {
    const std::int64_t missing = side - (std::int64_t{max} - min);
    if (missing <= 0) return;
    const std::int64_t from =
        std::clamp<std::int64_t>(min - missing / 2, kGridMin, kGridMax - side);
    min = static_cast<std::int32_t>(from);
    max = static_cast<std::int32_t>(from + side);
  };
  Box wide = box;
  widen(wide.min_x, wide.max_x);
  widen(wide.min_y, wide.max_y);
  return wide;
}

}  // namespace

TilePainter::TilePainter(std::unique_ptr<CoverageRenderer> renderer)
    : renderer_(std::move(renderer)) {}

std::vector<std::optional<PaintedTile>> TilePainter::paint(std::span<const Job> jobs) {
  drawing_count_ = 0;
  std::vector<Sketch> sketches;
  for (const Job& job : jobs) {
    if (Clock::now() > job.deadline) {
      sketches.push_back({true, drawing_count_, drawing_count_, {}});
    } else {
      sketches.push_back(sketch(*job.plan));
    }
  }
  const DrawTimes drawn = draw(jobs, sketches);
  const double share = 1.0 / static_cast<double>(std::max<std::size_t>(tasks_.size(), 1));

  std::vector<std::optional<PaintedTile>> tiles;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    Sketch& sketch = sketches[i];
    if (sketch.is_late) {
      tiles.emplace_back();
      continue;
    }
    const auto has_task = [this](std::size_t drawing) { return !drawings_[drawing].is_full; };
    double tasks = 0;
    for (std::size_t k = sketch.first_drawing; k < sketch.end_drawing; ++k) tasks += has_task(k);
    sketch.times.draw_ms = drawn.draw_ms * share * tasks;
    sketch.times.read_ms = drawn.read_ms * share * tasks;
    sketch.times.resolve_ms = drawn.resolve_ms * share * tasks;
    tiles.push_back(finish(*jobs[i].plan, sketch));
  }
  return tiles;
}

// From the top down: what lies under an opaque layer that covers everything is not looked at.
TilePainter::Sketch TilePainter::sketch(const TilePlan& plan) {
  Sketch sketch;
  sketch.first_drawing = drawing_count_;
  const View view = View::of_tile(plan.tile, plan.scale);
  const Stopwatch stopwatch(sketch.times.select_ms);
  for (auto paint = plan.layers.rbegin(); paint != plan.layers.rend(); ++paint) {
    if (paint->fill.a == 0) continue;  // here for its marks only
    if (drawing_count_ == drawings_.size()) drawings_.emplace_back();
    Drawing& drawing = drawings_[drawing_count_];
    if (!select(plan, *paint, view, drawing)) continue;
    ++drawing_count_;
    if (drawing.is_full && paint->fill.a == 255) break;
  }
  sketch.end_drawing = drawing_count_;
  return sketch;
}

// False if there is nothing of the layer here.
bool TilePainter::select(const TilePlan& plan, const LayerPaint& paint, const View& view,
                         Drawing& drawing) {
  const Layer& layer = painted_layer(plan, paint);
  const Layer::Selection selection{view.box(), paint.level, plan.pixel_level(), paint.small};
  drawing.paint = &paint;
  drawing.parts.clear();
  drawing.all_places = {};
  layer.select(selection, drawing.ranges);
  drawing.is_full = layer.fill_box(selection, drawing.ranges);
  if (drawing.is_full) return true;
  if (!drawing.ranges.empty()) drawing.parts.push_back({layer.mesh(), drawing.ranges});
  if (paint.small == SmallPolygons::keep) add_places(layer, selection, view, drawing);
  return !drawing.parts.empty();
}

// There are no more of them than pixels.
void TilePainter::add_places(const Layer& layer, const Layer::Selection& selection,
                             const View& view, Drawing& drawing) {
  layer.small_polygons(selection, places_);
  if (places_.empty()) return;
  drawing.place_vertices.clear();
  drawing.place_edges.clear();
  drawing.place_trapezoids.clear();
  const auto pixel = static_cast<std::int64_t>(std::ceil(view.cells_per_pixel));
  for (const Box& place : places_) {
    append_box(widened(place, pixel), drawing.place_vertices, drawing.place_edges,
               drawing.place_trapezoids);
  }
  const MeshView mesh{new_mesh_id(), drawing.place_vertices, drawing.place_edges,
                      drawing.place_trapezoids};
  drawing.all_places = {0, static_cast<std::uint32_t>(drawing.place_trapezoids.size())};
  drawing.parts.push_back({mesh, {&drawing.all_places, 1}});
}

DrawTimes TilePainter::draw(std::span<const Job> jobs, std::span<const Sketch> sketches) {
  tasks_.clear();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const View view = View::of_tile(jobs[i].plan->tile, jobs[i].plan->scale);
    for (std::size_t k = sketches[i].first_drawing; k < sketches[i].end_drawing; ++k) {
      Drawing& drawing = drawings_[k];
      if (!drawing.is_full) tasks_.push_back({drawing.parts, view, &drawing.coverage});
    }
  }
  if (tasks_.empty()) return {};
  const DrawTimes times = renderer_->draw(tasks_);
  for (std::size_t k = 0; k < drawing_count_; ++k) {
    const bool has_places = !drawings_[k].is_full && drawings_[k].all_places.count > 0;
    if (has_places) renderer_->forget(drawings_[k].parts.back().mesh.id);
  }
  return times;
}

PaintedTile TilePainter::finish(const TilePlan& plan, const Sketch& sketch) {
  PaintedTile tile{nullptr, TileHint::none, sketch.times};
  const View view = View::of_tile(plan.tile, plan.scale);
  bool is_constant = !plan.debug.any();
  {
    const Stopwatch stopwatch(tile.times.compose_ms);
    filled_.clear();
    for (std::size_t k = sketch.end_drawing; k-- > sketch.first_drawing;) {
      const Drawing& drawing = drawings_[k];
      is_constant = is_constant && drawing.is_full;
      filled_.push_back({drawing.is_full ? nullptr : &drawing.coverage, drawing.paint->fill});
    }
    const int side = is_constant ? 1 : view.width;  // one pixel tells the colour
    composer_.compose(filled_, side, side, plan.background, picture_);
    if (plan.debug.any()) mark(plan, view, picture_);
  }
  const Stopwatch stopwatch(tile.times.encode_ms);
  if (picture_.palette.size() == 1 && !plan.debug.any()) tile.hint = hint_of(sketch);
  tile.png = is_constant ? constant_png(picture_.at(0, 0), view.width)
                         : std::make_shared<const std::string>(encoder_.encode(picture_));
  return tile;
}

// Of a tile of one colour.
TileHint TilePainter::hint_of(const Sketch& sketch) const {
  TileHint hint = TileHint::empty;
  for (std::size_t k = sketch.first_drawing; k < sketch.end_drawing; ++k) {
    const Drawing& drawing = drawings_[k];
    if (drawing.is_full || drawing.coverage.is_all(255)) {
      hint = TileHint::full;
    } else if (!drawing.coverage.is_all(0)) {
      return TileHint::none;
    }
  }
  return hint;
}

std::shared_ptr<const std::string> TilePainter::constant_png(Rgba colour, int side) {
  auto& png = constants_[{to_hex(colour), side}];
  if (png != nullptr) return png;
  Picture picture;
  composer_.compose({}, side, side, colour, picture);
  const auto made = std::make_shared<const std::string>(encoder_.encode(picture));
  png = made;
  if (constants_.size() > kMaxConstants) constants_.clear();
  return made;
}

void TilePainter::mark(const TilePlan& plan, const View& view, Picture& picture) {
  spread_palette(picture);
  for (const LayerPaint& paint : plan.layers) {
    const Layer& layer = painted_layer(plan, paint);
    std::vector<TrapezoidRange> ranges;
    layer.select({view.box(), paint.level, plan.pixel_level(), SmallPolygons::drop}, ranges);
    if (plan.debug.mesh) mark_mesh(layer.mesh(), ranges, view, kMeshColour, picture);
    if (plan.debug.vertices) mark_vertices(layer.mesh(), ranges, view, kVertexColour, picture);
  }
  if (!plan.debug.tile) return;
  std::string text = fmt::format("{}/{}/{}", plan.tile.z, plan.tile.x, plan.tile.y);
  if (plan.scale > 1) text += fmt::format(" {}x", plan.scale);
  mark_border(text, kBorderColour, picture);
}

}  // namespace trapeze
