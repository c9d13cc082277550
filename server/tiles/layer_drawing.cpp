#include "server/tiles/layer_drawing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trapeze {
namespace {

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

/// The box and so many cells around it, as far as there is a grid.
Box with_margin(const Box& box, double margin) {
  if (box.is_empty()) return box;
  const auto cells = static_cast<std::int64_t>(std::ceil(margin));
  const auto cell = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, kGridMin, kGridMax));
  };
  return {cell(box.min_x - cells), cell(box.min_y - cells), cell(box.max_x + cells),
          cell(box.max_y + cells)};
}

constexpr unsigned kStepsBetweenChecks = 16'384;

/// To ranges in ascending order.
void append(std::uint32_t trapezoid, std::vector<TrapezoidRange>& ranges) {
  if (!ranges.empty() && ranges.back().first + ranges.back().count == trapezoid) {
    ++ranges.back().count;
  } else {
    ranges.push_back({trapezoid, 1});
  }
}

}  // namespace

void LayerDrawing::ClassDrawing::clear(std::uint8_t class_number) {
  number = class_number;
  is_full = false;
  is_drawn = false;
  ranges.clear();
  place_vertices.clear();
  place_edges.clear();
  place_trapezoids.clear();
  all_places = {};
  parts.clear();
}

void LayerDrawing::ClassDrawing::add_place(const Box& place, bool is_hole) {
  append_box(place, place_vertices, place_edges, place_trapezoids);
  if (is_hole) std::swap(place_trapezoids.back().left, place_trapezoids.back().right);
}

Layer::Selection selection_of(const TilePlan& plan, const LayerPaint& paint, const View& view) {
  const Stroke& stroke = paint.style.stroke;
  const double reach = stroke.width > 0 ? stroke.reach(plan.scale) * view.cells_per_pixel : 0;
  // Dust that many features share has no class.
  const bool has_classes = !paint.style.classing.is_plain();
  return {with_margin(view.box(), reach), paint.level, plan.pixel_level(),
          has_classes ? SmallPolygons::drop : paint.small};
}

bool LayerDrawing::select(const TilePlan& plan, const LayerPaint& paint, const View& view,
                          const FeatureClasses* classes, DrawingTools& tools) {
  paint_ = &paint;
  layer_ = &plan.layer_of(paint);
  class_count_ = 0;
  line_count_ = 0;
  by_number_.assign(style().paints.size(), nullptr);
  const Layer::Selection selection = selection_of(plan, paint, view);
  const auto check = [&tools] {
    if (tools.cancellation != nullptr) tools.cancellation->check();
  };
  check();
  layer_->select(selection, tools.ranges);
  check();
  if (classes == nullptr) {
    if (!tools.ranges.empty()) {
      class_drawing(0).ranges.assign(tools.ranges.begin(), tools.ranges.end());
    }
  } else {
    part_by_class(*classes, tools);
  }
  add_places(selection, view, classes, tools);
  check();
  for (std::size_t i = 0; i < class_count_; ++i) finish_class(selection, classes_[i]);
  if (has_lines()) collect_edges(selection, classes, tools);
  return class_count_ > 0 || line_count_ > 0;
}

LayerDrawing::ClassDrawing& LayerDrawing::class_drawing(std::uint8_t number) {
  ClassDrawing*& drawing = by_number_[number];
  if (drawing != nullptr) return *drawing;
  if (class_count_ == classes_.size()) classes_.emplace_back();
  drawing = &classes_[class_count_++];
  drawing->clear(number);
  return *drawing;
}

void LayerDrawing::part_by_class(const FeatureClasses& classes, const DrawingTools& tools) {
  CancellationCheck check(tools.cancellation, kStepsBetweenChecks);
  for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
    check();
    const std::uint8_t number = classes[layer_->feature_of(i)];
    if (number != kNotDrawn) append(i, class_drawing(number).ranges);
  });
}

// There are no more of them, in one class, than pixels.
void LayerDrawing::add_places(const Layer::Selection& selection, const View& view,
                              const FeatureClasses* classes, DrawingTools& tools) {
  const bool is_kept = paint_->small == SmallPolygons::keep;
  const auto pixel = static_cast<std::int64_t>(std::ceil(view.cells_per_pixel));
  if (classes == nullptr) {
    if (!is_kept) return;
    layer_->small_polygons(selection, tools.places);
    for (const Box& place : tools.places) class_drawing(0).add_place(widened(place, pixel), false);
    return;
  }
  if (paint_->small == SmallPolygons::drop) return;
  const double margin = 2 * view.cells_per_pixel;  // a mote may reach into the next pixel
  tools.dust.gather(layer_->grains(), with_margin(selection.box, margin), selection.level,
                    view.cells_per_pixel, *classes, tools.motes);
  for (const ClassMote& mote : tools.motes) {
    if (is_kept && mote.is_hole) continue;
    class_drawing(mote.feature_class)
        .add_place(is_kept ? widened(mote.box, pixel) : mote.box, mote.is_hole);
  }
}

void LayerDrawing::finish_class(const Layer::Selection& selection, ClassDrawing& drawing) {
  const bool has_places = !drawing.place_trapezoids.empty();
  drawing.is_full = !has_places && layer_->fill_box(selection, drawing.ranges);
  drawing.is_drawn =
      !drawing.is_full && (style().paints[drawing.number].fill.a > 0 || has_pattern());
  if (!drawing.is_drawn) return;
  if (!drawing.ranges.empty()) drawing.parts.push_back({layer_->mesh(), drawing.ranges});
  if (!has_places) return;
  const MeshView mesh{new_mesh_id(), drawing.place_vertices, drawing.place_edges,
                      drawing.place_trapezoids};
  drawing.all_places = {0, static_cast<std::uint32_t>(drawing.place_trapezoids.size())};
  drawing.parts.push_back({mesh, {&drawing.all_places, 1}});
}

void LayerDrawing::collect_edges(const Layer::Selection& selection, const FeatureClasses* classes,
                                 DrawingTools& tools) {
  for (const ClassDrawing* drawing : by_number_) {
    if (drawing != nullptr) add_edges(drawing->ranges, drawing->number);
  }
  layer_->select_horizontal_edges(selection.box, selection.level, tools.ranges);
  std::vector<std::vector<TrapezoidRange>> by_class(style().paints.size());
  for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
    const std::uint8_t number = classes == nullptr ? 0 : (*classes)[layer_->feature_of(i)];
    if (number != kNotDrawn) append(i, by_class[number]);
  });
  for (std::size_t number = 0; number < by_class.size(); ++number) {
    add_edges(by_class[number], static_cast<std::uint8_t>(number));
  }
  for (std::size_t i = 0; i < line_count_; ++i) {
    take_sides(selection.box, lines_[i]);
    take_dashed_sides(lines_[i], tools);
  }
}

// Most edges are sides of several trapezoids, and some of these reach far out of the box.
void LayerDrawing::take_sides(const Box& box, Lines& lines) const {
  const MeshView& mesh = layer_->mesh();
  std::ranges::sort(lines.sides);
  lines.sides.erase(std::unique(lines.sides.begin(), lines.sides.end()), lines.sides.end());
  for (const std::uint32_t side : lines.sides) {
    const MeshEdge& edge = mesh.edges[side];
    Box around;
    around.include(mesh.vertices[edge.upper]);
    around.include(mesh.vertices[edge.lower]);
    if (around.intersects(box)) lines.edges.push_back({edge.upper, edge.lower, 0});
  }
}

LayerDrawing::Lines& LayerDrawing::lines_of(Rgba colour) {
  for (std::size_t i = 0; i < line_count_; ++i) {
    if (lines_[i].colour == colour) return lines_[i];
  }
  if (line_count_ == lines_.size()) lines_.emplace_back();
  Lines& lines = lines_[line_count_++];
  lines.colour = colour;
  lines.sides.clear();
  lines.dashed_sides.clear();
  lines.edges.clear();
  return lines;
}

void LayerDrawing::add_edges(std::span<const TrapezoidRange> ranges, std::uint8_t number) {
  const Rgba colour = style().paints[number].stroke;
  if (ranges.empty() || colour.a == 0) return;
  Lines& lines = lines_of(colour);
  const bool is_dashed = style().stroke.is_dashed();
  const MeshView& mesh = layer_->mesh();
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const std::uint32_t row = layer_->feature_of(i);
    if (row == Layer::kNoFeature) return;  // dust has no outline
    for (const std::uint32_t side : {mesh.trapezoids[i].left, mesh.trapezoids[i].right}) {
      if (is_dashed) {
        lines.dashed_sides.emplace_back(side, row);
      } else {
        lines.sides.push_back(side);
      }
    }
  });
}

// A border that two features share has the dashes of the first one: those of both would fill each
// other's gaps.
void LayerDrawing::take_dashed_sides(Lines& lines, DrawingTools& tools) const {
  auto& sides = lines.dashed_sides;
  const auto has_row_before = [](const auto& a, const auto& b) {
    return std::pair(a.second, a.first) < std::pair(b.second, b.first);
  };
  std::ranges::sort(sides);
  const auto is_same_edge = [](const auto& a, const auto& b) { return a.first == b.first; };
  sides.erase(std::unique(sides.begin(), sides.end(), is_same_edge), sides.end());
  std::ranges::sort(sides, has_row_before);
  const MeshView& mesh = layer_->mesh();
  const std::vector<LoopEdge>* loops = nullptr;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto [side, row] = sides[i];
    if (i == 0 || sides[i - 1].second != row) {
      if (tools.cancellation != nullptr) tools.cancellation->check();
      loops = &tools.loop_lengths.find(*layer_, paint_->level, row);
    }
    const auto found = std::ranges::lower_bound(*loops, side, {}, &LoopEdge::edge);
    if (found == loops->end() || found->edge != side) continue;  // cannot be
    const MeshEdge& edge = mesh.edges[side];
    lines.edges.push_back(found->leads_up ? OutlineEdge{edge.lower, edge.upper, found->along}
                                          : OutlineEdge{edge.upper, edge.lower, found->along});
  }
}

bool LayerDrawing::hides_all() const {
  return class_count_ == 1 && classes_[0].is_full &&
         style().paints[classes_[0].number].fill.a == 255 && style().opacity == 1;
}

bool LayerDrawing::is_constant() const {
  return class_count_ == 1 && classes_[0].is_full && line_count_ == 0 && !has_pattern();
}

void LayerDrawing::add_tasks(const View& view, const Cancellation* cancellation,
                             std::vector<MaskTask>& tasks) {
  for (std::size_t i = 0; i < class_count_; ++i) {
    ClassDrawing& drawing = classes_[i];
    if (drawing.is_drawn) tasks.push_back({drawing.parts, view, &drawing.mask, cancellation});
  }
}

void LayerDrawing::draw_details(const View& view, int scale, DrawingTools& tools) {
  if (has_pattern()) draw_pattern(style().pattern, view, scale, pattern_);
  for (std::size_t i = 0; i < line_count_; ++i) {
    Lines& lines = lines_[i];
    lines.mask.resize(view.width, view.height);
    lines.mask.fill(0);
    tools.stroker.draw(layer_->mesh().vertices, lines.edges, style().stroke, view, scale,
                       lines.mask, tools.cancellation);
  }
}

void LayerDrawing::forget_places(MaskRenderer& renderer) {
  for (std::size_t i = 0; i < class_count_; ++i) {
    if (classes_[i].all_places.count > 0) renderer.forget(classes_[i].parts.back().mesh.id);
  }
}

PaintedLayer LayerDrawing::painted() {
  painted_classes_.clear();
  painted_lines_.clear();
  for (const ClassDrawing* drawing : by_number_) {
    if (drawing == nullptr || (!drawing->is_full && !drawing->is_drawn)) continue;
    painted_classes_.push_back(
        {drawing->is_full ? nullptr : &drawing->mask, style().paints[drawing->number].fill});
  }
  for (std::size_t i = 0; i < line_count_; ++i) {
    painted_lines_.push_back({&lines_[i].mask, lines_[i].colour});
  }
  return {painted_classes_, has_pattern() ? &pattern_ : nullptr, style().pattern.colour,
          painted_lines_, style().opacity};
}

bool LayerDrawing::is_empty() const {
  for (std::size_t i = 0; i < class_count_; ++i) {
    const ClassDrawing& drawing = classes_[i];
    if (drawing.is_full || (drawing.is_drawn && !drawing.mask.is_all(0))) return false;
  }
  for (std::size_t i = 0; i < line_count_; ++i) {
    if (!lines_[i].mask.is_all(0)) return false;
  }
  return true;
}

bool LayerDrawing::is_full() const {
  if (class_count_ != 1 || line_count_ > 0 || has_pattern()) return false;
  return classes_[0].is_full || (classes_[0].is_drawn && classes_[0].mask.is_all(255));
}

}  // namespace trapeze
