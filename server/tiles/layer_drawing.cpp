#include "server/tiles/layer_drawing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "core/grid/box_segment.h"
#include "core/grid/plate_carree.h"
#include "core/grid/web_mercator.h"
#include "core/mesh/mesh_index.h"
#include "render/mask/mask_digest.h"

namespace trapeze {
namespace {

/// The box widened to at least that many cells, around the same centre as far as the grid extends.
/// Precondition: not wider than the grid.
Box widened(const Box& box, std::int64_t width, std::int64_t height) {
  const auto widen = [](std::int32_t& min, std::int32_t& max, std::int64_t side) {
    const std::int64_t missing = side - (std::int64_t{max} - min);
    if (missing <= 0) return;
    const std::int64_t from =
        std::clamp<std::int64_t>(min - missing / 2, kGridMin, kGridMax - side);
    min = static_cast<std::int32_t>(from);
    max = static_cast<std::int32_t>(from + side);
  };
  Box wide = box;
  widen(wide.min_x, wide.max_x, width);
  widen(wide.min_y, wide.max_y, height);
  return wide;
}

/// The box with a margin of that many cells, as far as the grid extends.
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

constexpr double kLeastInk = 0.5 / 255;  // less ink cannot be seen

double length_between(Point a, Point b) {
  const double x = static_cast<double>(b.x) - a.x;
  const double y = static_cast<double>(b.y) - a.y;
  return std::sqrt(x * x + y * y);
}

/// Sorts the items and removes duplicates. Takes linear time where they are dense.
void sort_and_part(std::vector<std::uint32_t>& items) {
  constexpr std::size_t kBits = 64;
  if (items.empty()) return;
  const auto [least, greatest] = std::ranges::minmax(items);
  const std::size_t words = (greatest - least) / kBits + 1;
  if (words > 2 * items.size()) {
    std::ranges::sort(items);
    items.erase(std::unique(items.begin(), items.end()), items.end());
    return;
  }
  std::vector<std::uint64_t> is_there(words, 0);
  for (const std::uint32_t item : items) {
    is_there[(item - least) / kBits] |= std::uint64_t{1} << (item - least) % kBits;
  }
  items.clear();
  for (std::size_t word = 0; word < words; ++word) {
    for (std::uint64_t bits = is_there[word]; bits != 0; bits &= bits - 1) {
      items.push_back(static_cast<std::uint32_t>(least + word * kBits +
                                                 static_cast<unsigned>(std::countr_zero(bits))));
    }
  }
}

void add(const Digest& digest, ContentHash& hash) {
  hash.add(digest.low);
  hash.add(digest.high);
}

/// The class number of a feature; 0 if all are drawn the same way.
std::uint8_t number_of(const FeatureClasses* classes, std::uint32_t row) {
  return classes == nullptr ? std::uint8_t{0} : (*classes)[row];
}

/// A border that is visible on both sides is listed once, with the greater share.
void take_once(std::vector<SeenEdge>& seen) {
  const auto piece = [](const SeenEdge& of) {
    return std::tuple(of.edge, of.from.x, of.from.y, of.to.x, of.to.y);
  };
  std::ranges::sort(seen, [&](const SeenEdge& a, const SeenEdge& b) {
    return std::tuple(piece(a), -a.share) < std::tuple(piece(b), -b.share);
  });
  const auto is_same = [&](const SeenEdge& a, const SeenEdge& b) { return piece(a) == piece(b); };
  seen.erase(std::unique(seen.begin(), seen.end(), is_same), seen.end());
}

}  // namespace

InkOfLoops::InkOfLoops(const Stroke& stroke, const View& view, double scale)
    : stroke_(stroke), view_(view), scale_(scale) {
  // In units of the side of a square as large as a pixel at scale 1.
  const double cells = view.cells_per_pixel * std::sqrt(view.stretch) * scale;
  for (int size = 0; size < kLoopSizes; ++size) {
    by_size_[static_cast<std::size_t>(size)] =
        stroke.ink_of_ring(extent_of(static_cast<LoopSize>(size)) / cells);
  }
}

double InkOfLoops::of(LoopSize size, std::int32_t y) const {
  if (view_.projection != Projection::plate_carree) return by_size_[size];
  return stroke_.ink_of_ring(extent_of(size) / (view_.side_at(y) * scale_));
}

void LayerDrawing::ClassDrawing::clear(std::uint8_t class_number) {
  number = class_number;
  alpha = 0;
  is_beneath = false;
  is_full = false;
  is_drawn = false;
  ranges.clear();
  piece_count = 0;
  made_vertices.clear();
  made_edges.clear();
  made_trapezoids.clear();
  all_made = {};
  parts.clear();
  digest = {};
}

void LayerDrawing::ClassDrawing::end_piece(const Layer& layer) {
  if (ranges.empty()) return;
  if (piece_count == pieces.size()) pieces.emplace_back();
  OfPiece& piece = pieces[piece_count++];
  piece.layer = &layer;
  piece.ranges.swap(ranges);
  ranges.clear();
}

void LayerDrawing::ClassDrawing::add_place(const Box& place, bool is_hole) {
  append_box(place, made_vertices, made_edges, made_trapezoids);
  if (is_hole) std::swap(made_trapezoids.back().left, made_trapezoids.back().right);
}

void LayerDrawing::ClassDrawing::add_patch(const ClassPatch& patch) {
  const std::size_t first = made_trapezoids.size();
  append_rectangle(patch.corners, made_vertices, made_edges, made_trapezoids);
  if (!patch.is_hole) return;
  for (MeshTrapezoid& part : std::span(made_trapezoids).subspan(first)) {
    std::swap(part.left, part.right);
  }
}

void LayerDrawing::ClassDrawing::add_corner(const CornerRounding& corners,
                                            const CornerRounding::Corner& corner, bool is_hole) {
  corners.append_place(corner, is_hole, made_vertices, made_edges, made_trapezoids);
}

void LayerDrawing::ClassDrawing::add_grown(const Exaggeration::Triangle& triangle) {
  Exaggeration::append(triangle, made_vertices, made_edges, made_trapezoids);
}

void LayerDrawing::ClassDrawing::give_way(const Exaggeration& exaggeration, const MeshView& mesh,
                                          const MeshTrapezoid& trapezoid) {
  exaggeration.append_common(mesh, trapezoid, made_vertices, made_edges, made_trapezoids);
}

void LayerDrawing::ClassDrawing::add_part(const MeshView& mesh, const TrapezoidPart& part) {
  const auto v = static_cast<std::uint32_t>(made_vertices.size());
  const auto e = static_cast<std::uint32_t>(made_edges.size());
  const MeshEdge& left = mesh.edges[part.left];
  const MeshEdge& right = mesh.edges[part.right];
  made_vertices.insert(made_vertices.end(), {mesh.vertices[left.upper], mesh.vertices[left.lower],
                                             mesh.vertices[right.upper], mesh.vertices[right.lower],
                                             Point{mesh.vertices[left.upper].x, part.top},
                                             Point{mesh.vertices[left.upper].x, part.bottom}});
  made_edges.insert(made_edges.end(), {{v, v + 1}, {v + 2, v + 3}});
  made_trapezoids.push_back({v + 4, v + 5, e, e + 1});
}

/// Replaces the parts by their projection into the picture.
void LayerDrawing::ClassDrawing::project(const View& view) {
  projected.begin(view.cells_per_row(), view.box());
  for (const MeshPart& part : parts) projected.add(part.mesh, part.ranges);
  parts.clear();
  all_made = {0, static_cast<std::uint32_t>(projected.trapezoids().size())};
  if (all_made.count == 0) return;
  const MeshView mesh{new_mesh_id(), projected.vertices(), projected.edges(),
                      projected.trapezoids()};
  parts.push_back({mesh, {&all_made, 1}});
}

// The edges that a feature has on one side only.
void append_outer(std::vector<LayerDrawing::SideOf>& sides, std::vector<std::uint32_t>& edges) {
  std::ranges::sort(sides);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].row == sides[i].row &&
           sides[end].edge == sides[i].edge) {
      ++end;
    }
    if (sides[i].is_right == sides[end - 1].is_right) edges.push_back(sides[i].edge);
    i = end;
  }
}

/// The box of the view with a margin of that many pixels.
Box box_around(const View& view, double reach) {
  if (view.box().is_empty()) {  // a copy of the world beside the picture
    const int more = static_cast<int>(std::ceil(reach));
    View around = view;
    around.origin_x -= static_cast<std::int64_t>(std::ceil(more * view.cells_per_pixel));
    around.width += 2 * more + 1;
    return around.box_around(reach);
  }
  return view.projection == Projection::plate_carree
             ? view.box_around(reach)
             : with_margin(view.box(), reach * view.longer_side());
}

double reach_of_lines(const TilePlan& plan, const LayerPaint& paint) {
  const Stroke& stroke = paint.style.stroke;
  return stroke.width > 0 ? stroke.reach(plan.scale) : 0;
}

Layer::Selection selection_of(const TilePlan& plan, const LayerPaint& paint, const View& view) {
  const Box box = box_around(view, paint.style.reach(plan.scale));
  // Dust that many features share has no class.
  const bool has_classes = !paint.style.classing.is_plain();
  return {box, paint.level, plan.pixel_level(), has_classes ? SmallPolygons::drop : paint.small};
}

bool is_plain(const LayerStyle& style) {
  return style.classing.is_plain() && style.paints[0].fill.a == 255 && style.stroke.width <= 0;
}

bool has_fine_pixels(const View& view) {
  return view.longer_side() <= FeatureOverlap::kAlong;
}

bool LayerDrawing::select(const TilePlan& plan, const LayerPaint& paint, const View& view,
                          std::span<const DrawnPiece> pieces, DrawingTools& tools) {
  paint_ = &paint;
  layer_ = nullptr;
  has_pieces_ = pieces.size() > 1;
  least_side_ = std::max(1.0, style().grow * plan.scale);
  scale_ = plan.scale;
  view_ = view;
  class_count_ = 0;
  line_count_ = 0;
  by_number_.assign(style().paints.size(), nullptr);
  const Layer::Selection selection = selection_of(plan, paint, view);
  const auto check = [&tools] {
    if (tools.cancellation != nullptr) tools.cancellation->check();
  };
  std::optional<InkOfLoops> ink;
  if (has_lines()) ink.emplace(style().stroke, view, plan.scale);
  if (has_lines() && is_projected()) {
    tools.plate_carree.begin(view.cells_per_row(), selection.box);
  }
  if (has_round_corners()) round_corners(plan.scale, pieces, selection, tools);
  if (has_growth()) grow(plan.scale, pieces, selection, tools);
  tools.dust.begin(tools.shapes);
  piece_number_ = 0;
  for (const DrawnPiece& piece : pieces) {
    check();
    add_piece(piece, selection, ink ? &*ink : nullptr, tools);
    ++piece_number_;
  }
  tools.dust.finish(view_.shorter_side(), tools.shapes);
  add_shapes(tools);
  check();
  for (std::size_t i = 0; i < class_count_ && has_growth(); ++i) give_way(classes_[i], tools);
  for (std::size_t i = 0; i < class_count_; ++i) finish_class(selection, classes_[i]);
  leave_out_empty_lines();
  const auto is_seen = [](const ClassDrawing& drawing) {
    return drawing.is_full || drawing.is_drawn;
  };
  return line_count_ > 0 ||
         std::any_of(classes_.begin(), classes_.begin() + static_cast<std::ptrdiff_t>(class_count_),
                     is_seen);
}

void LayerDrawing::add_piece(const DrawnPiece& piece, const Layer::Selection& selection,
                             const InkOfLoops* ink, DrawingTools& tools) {
  layer_ = piece.layer;
  const FeatureClasses* classes = piece.classes.get();
  layer_->select(selection, tools.ranges);
  part_by_class(classes, selection, tools);
  add_places(selection, classes, tools);
  if (ink != nullptr) collect_edges(selection, *ink, classes, tools);
  for (std::size_t i = 0; i < class_count_; ++i) classes_[i].end_piece(*layer_);
}

// All features count, including those not drawn: which features are drawn must not affect the shape
// of others. Features that overlap others are drawn as far as they are visible, and keep their
// shape.
void LayerDrawing::find_corners(double scale, std::span<const DrawnPiece> pieces,
                                const Layer::Selection& selection, DrawingTools& tools) const {
  Layer::Selection polygons = selection;
  polygons.small = SmallPolygons::drop;
  CancellationCheck check(tools.cancellation, kStepsBetweenChecks);
  tools.corners.begin();
  for (const DrawnPiece& piece : pieces) {
    const Layer& layer = *piece.layer;
    const MeshView& mesh = layer.mesh();
    tools.corners.begin_piece(mesh);
    const auto is_sharp = [&](std::uint32_t row) { return !layer.overlaps().of(row).empty(); };
    const auto is_cut = [&](std::uint32_t edge) {
      return view_.projection != Projection::plane &&
             is_on_frame(mesh.vertices[mesh.edges[edge].upper],
                         mesh.vertices[mesh.edges[edge].lower]);
    };
    layer.select(polygons, tools.ranges);
    for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
      check();
      const MeshTrapezoid& trapezoid = mesh.trapezoids[i];
      const std::uint32_t row = layer.feature_of(i);
      tools.corners.add(trapezoid, row, is_sharp(row));
      for (const std::uint32_t edge : {trapezoid.left, trapezoid.right}) {
        if (is_cut(edge)) tools.corners.add_edge(edge, true);
      }
    });
    layer.select_horizontal_edges(polygons.box, polygons.level, tools.ranges);
    for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
      const std::uint32_t edge = mesh.trapezoids[i].left;
      tools.corners.add_edge(edge, is_sharp(layer.feature_of(i)) || is_cut(edge));
    });
  }
  // Beyond this, not all neighbours have been added. The curves there begin too far away to be
  // seen.
  const double radius = style().smooth * scale;
  const Box tips = box_around(view_, style().reach(scale) - radius);
  tools.corners.find({radius, view_.shorter_side(), tips});
}

// A border whose two sides are drawn the same way does not show in the areas.
void LayerDrawing::round_corners(double scale, std::span<const DrawnPiece> pieces,
                                 const Layer::Selection& selection, DrawingTools& tools) {
  find_corners(scale, pieces, selection, tools);
  const Box box = view_.box();
  for (const CornerRounding::Corner& corner : tools.corners.corners()) {
    Box around;
    around.include(corner.tip);
    for (const Point p : tools.corners.points_of(corner)) around.include(p);
    if (!around.intersects(box)) continue;
    const FeatureClasses* classes = pieces[corner.piece].classes.get();
    const auto class_of = [classes](std::uint32_t row) {
      return row == CornerRounding::kNoFace ? kNotDrawn : number_of(classes, row);
    };
    const std::uint8_t inside = class_of(corner.inside);
    const std::uint8_t outside = class_of(corner.outside);
    if (inside == outside) continue;
    if (inside != kNotDrawn) class_drawing(inside).add_corner(tools.corners, corner, true);
    if (outside != kNotDrawn) class_drawing(outside).add_corner(tools.corners, corner, false);
  }
}

// All features count, as for corners. Features that overlap others neither grow nor obstruct
// growth.
void LayerDrawing::find_growth(double scale, std::span<const DrawnPiece> pieces,
                               const Layer::Selection& selection, DrawingTools& tools) const {
  Layer::Selection polygons = selection;
  polygons.small = SmallPolygons::drop;
  CancellationCheck check(tools.cancellation, kStepsBetweenChecks);
  BoundaryMap& boundary = tools.exaggeration.boundary();
  boundary.begin();
  for (const DrawnPiece& piece : pieces) {
    const Layer& layer = *piece.layer;
    const MeshView& mesh = layer.mesh();
    boundary.begin_piece(mesh);
    const auto lies_over_others = [&](std::uint32_t i) {
      return !layer.overlaps().of(layer.feature_of(i)).empty();
    };
    const auto add_if_cut = [&](std::uint32_t edge) {
      const MeshEdge& ends = mesh.edges[edge];
      const bool is_cut = view_.projection != Projection::plane &&
                          is_on_frame(mesh.vertices[ends.upper], mesh.vertices[ends.lower]);
      if (is_cut) boundary.add_cut(edge);
    };
    layer.select(polygons, tools.ranges);
    for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
      check();
      if (lies_over_others(i)) return;
      const MeshTrapezoid& trapezoid = mesh.trapezoids[i];
      boundary.add(trapezoid, layer.feature_of(i));
      for (const std::uint32_t edge : {trapezoid.left, trapezoid.right}) add_if_cut(edge);
    });
    layer.select_horizontal_edges(polygons.box, polygons.level, tools.ranges);
    for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
      if (lies_over_others(i)) return;
      const std::uint32_t edge = mesh.trapezoids[i].left;
      boundary.add_edge(edge);
      add_if_cut(edge);
    });
  }
  // Outlines reach into the picture from as far away.
  const Box box = has_lines() ? box_around(view_, style().stroke.reach(scale)) : view_.box();
  tools.exaggeration.find({style().grow * scale, view_.shorter_side()}, box, tools.cancellation);
}

void LayerDrawing::grow(double scale, std::span<const DrawnPiece> pieces,
                        const Layer::Selection& selection, DrawingTools& tools) {
  find_growth(scale, pieces, selection, tools);
  const auto class_of = [pieces](BoundaryMap::Face face) {
    return number_of(pieces[BoundaryMap::piece_of(face)].classes.get(),
                     BoundaryMap::number_of(face));
  };
  tools.exaggeration.keep([&](BoundaryMap::Face face) { return class_of(face) != kNotDrawn; });
  for (const Exaggeration::Triangle& triangle : tools.exaggeration.triangles()) {
    class_drawing(class_of(triangle.face)).add_grown(triangle);
  }
}

// Where a grown feature covers a wider one, the wider one is not drawn.
void LayerDrawing::give_way(ClassDrawing& drawing, DrawingTools& tools) const {
  if (drawing.is_beneath || tools.exaggeration.triangles().empty()) return;
  const Box box = view_.box();
  CancellationCheck check(tools.cancellation, kStepsBetweenChecks);
  for (std::size_t k = 0; k < drawing.piece_count; ++k) {
    const ClassDrawing::OfPiece& piece = drawing.pieces[k];
    const MeshView& mesh = piece.layer->mesh();
    for_each_trapezoid(piece.ranges, [&](std::uint32_t i) {
      check();
      const std::uint32_t row = piece.layer->feature_of(i);
      if (row == Layer::kNoFeature || !piece.layer->overlaps().of(row).empty()) return;
      if (!meets(mesh, mesh.trapezoids[i], box)) return;
      drawing.give_way(tools.exaggeration, mesh, mesh.trapezoids[i]);
    });
  }
}

LayerDrawing::ClassDrawing& LayerDrawing::new_drawing(std::uint8_t number) {
  if (class_count_ == classes_.size()) classes_.emplace_back();
  ClassDrawing& drawing = classes_[class_count_++];
  drawing.clear(number);
  return drawing;
}

LayerDrawing::ClassDrawing& LayerDrawing::class_drawing(std::uint8_t number) {
  ClassDrawing*& drawing = by_number_[number];
  if (drawing == nullptr) {
    drawing = &new_drawing(number);
    drawing->alpha = style().paints[number].fill.a;
  }
  return *drawing;
}

LayerDrawing::ClassDrawing& LayerDrawing::drawing_beneath(std::uint8_t number, std::uint8_t alpha) {
  for (std::size_t i = 0; i < class_count_; ++i) {
    ClassDrawing& drawing = classes_[i];
    if (drawing.is_beneath && drawing.number == number && drawing.alpha == alpha) return drawing;
  }
  ClassDrawing& drawing = new_drawing(number);
  drawing.is_beneath = true;
  drawing.alpha = alpha;
  return drawing;
}

void LayerDrawing::part_by_class(const FeatureClasses* classes, const Layer::Selection& selection,
                                 DrawingTools& tools) {
  if (!layer_->overlaps().empty()) leave_those_that_meet(selection.box, tools.ranges);
  has_stack_ = find_stack(classes, selection, tools);
  if (classes == nullptr && !has_stack_) {
    layer_->keep_uppermost(tools.ranges);
    if (!tools.ranges.empty()) {
      class_drawing(0).ranges.assign(tools.ranges.begin(), tools.ranges.end());
    }
    return;
  }
  const bool are_in_common =
      layer_->overlaps().are_any_in_common() && !(has_stack_ && tools.stack.covers_in_common());
  const auto add = [&](const Painted& one) {
    const bool is_cut_up =
        has_stack_ && one.row != Layer::kNoFeature && tools.stack.add(one.row, one.trapezoid);
    if (!is_cut_up) append_trapezoid(one.trapezoid, class_drawing(one.number).ranges);
  };
  std::optional<Painted> uppermost;
  CancellationCheck check(tools.cancellation, kStepsBetweenChecks);
  for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
    check();
    const Painted one{i, layer_->feature_of(i), number_of(classes, layer_->feature_of(i))};
    if (one.number == kNotDrawn) return;
    if (!are_in_common) return add(one);
    if (uppermost && layer_->have_in_common(uppermost->trapezoid, i)) {
      if (!is_raised(uppermost->number) || is_raised(one.number)) uppermost = one;
      return;
    }
    if (uppermost) add(*uppermost);
    uppermost = one;
  });
  if (uppermost) add(*uppermost);
  if (has_stack_) add_stack(classes, selection, tools);
}

// Which features overlap here must not depend on what the index selects beyond the box.
void LayerDrawing::leave_those_that_meet(const Box& box,
                                         std::vector<TrapezoidRange>& ranges) const {
  std::vector<TrapezoidRange> left;
  const MeshView& mesh = layer_->mesh();
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const bool is_dust = layer_->feature_of(i) == Layer::kNoFeature;
    if (is_dust || meets(mesh, mesh.trapezoids[i], box)) append_trapezoid(i, left);
  });
  ranges.swap(left);
}

bool LayerDrawing::is_raised(std::uint8_t number) const {
  return number == style().classing.class_of_highlighted();
}

// Whether features of the layer overlap here. Features of one colour are cut as well: where their
// edges run through the same pixels, their areas would add up to more than they cover.
bool LayerDrawing::find_stack(const FeatureClasses* classes, const Layer::Selection& selection,
                              DrawingTools& tools) {
  if (layer_->overlaps().empty()) return false;
  tools.stack.begin(layer_->overlaps(), layer_->mesh(),
                    {epsilon_of_level(selection.pixel_level), has_lines(), is_plain(style()),
                     has_fine_pixels(view_)});
  const auto paint_of = [&](std::uint32_t row) {
    const std::uint8_t number = number_of(classes, row);
    const Rgba fill = style().paints[number].fill;
    return FeatureStack::Paint{has_lines() ? row : number, static_cast<float>(fill.a) / 255.0f,
                               is_raised(number)};
  };
  CancellationCheck check(tools.cancellation, kStepsBetweenChecks);
  const auto for_each_row = [&](const auto& visit) {
    for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
      check();
      const std::uint32_t row = layer_->feature_of(i);
      if (row != Layer::kNoFeature && number_of(classes, row) != kNotDrawn) visit(row, i);
    });
  };
  for_each_row([&](std::uint32_t row, std::uint32_t) { tools.stack.note(row, paint_of); });
  if (!tools.stack.find_covers(tools.cancellation)) return false;
  for_each_row([&](std::uint32_t row, std::uint32_t i) { tools.stack.note_place(row, i); });
  return tools.stack.settle();
}

// Where the layer's features overlap, draws the visible part of each.
void LayerDrawing::add_stack(const FeatureClasses* classes, const Layer::Selection& selection,
                             DrawingTools& tools) {
  using RowAndEdge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<RowAndEdge> level_edges;
  if (has_lines()) {
    layer_->select_horizontal_edges(selection.box, selection.level, tools.ranges);
    for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
      const std::uint32_t row = layer_->feature_of(i);
      if (!tools.stack.is_cut(row)) return;
      level_edges.emplace_back(row, layer_->mesh().trapezoids[i].left);
    });
    std::ranges::sort(level_edges);
  }
  const auto parts_of = [&](std::uint32_t row, std::span<const std::uint32_t> trapezoids,
                            std::span<const TrapezoidPart> parts) {
    const std::uint8_t number = number_of(classes, row);
    add_parts(number, parts);
    if (!has_lines()) return;
    std::vector<std::uint32_t> edges;
    auto edge = std::ranges::lower_bound(level_edges, RowAndEdge{row, 0});
    for (; edge != level_edges.end() && edge->first == row; ++edge) edges.push_back(edge->second);
    add_seen_edges(number, trapezoids, edges, {parts, selection.box});
  };
  tools.stack.resolve(tools.cancellation, parts_of);
}

void LayerDrawing::add_parts(std::uint8_t number, std::span<const TrapezoidPart> parts) {
  for (const TrapezoidPart& part : parts) {
    ClassDrawing& drawing = class_drawing(number);
    const auto alpha =
        static_cast<std::uint8_t>(std::lround(static_cast<float>(drawing.alpha) * part.share));
    if (part.share == 1) {
      drawing.add_part(layer_->mesh(), part);
    } else if (alpha > 0) {
      drawing_beneath(number, alpha).add_part(layer_->mesh(), part);
    }
  }
}

void LayerDrawing::add_seen_edges(std::uint8_t number, std::span<const std::uint32_t> trapezoids,
                                  std::span<const std::uint32_t> level_edges,
                                  const VisibleInBox& visible) {
  const Rgba colour = style().paints[number].stroke;
  if (colour.a == 0) return;
  const MeshView& mesh = layer_->mesh();
  std::vector<std::uint32_t> own;
  std::vector<SideOf> in_common;
  for (const std::uint32_t i : trapezoids) add_sides_of(i, own, in_common);
  append_outer(in_common, own);
  sort_and_part(own);
  std::vector<SeenEdge>& seen = lines_of(colour).seen;
  append_seen_sides(mesh, own, visible, seen);
  append_seen_level_edges(mesh, level_edges, visible, seen);
}

GrainIndex::Births births_of_dust(const LayerPaint& paint, const Layer::Selection& selection) {
  if (paint.small == SmallPolygons::drop) return {1, 0};
  const bool has_classes = !paint.style.classing.is_plain();
  return has_classes ? GrainIndex::Births{0, selection.level} : selection.later_births();
}

/// The box, enlarged to the smallest size that is drawn, which in a picture of a few pixels may be
/// larger than the world.
Box LayerDrawing::least_around(const Box& box) const {
  const double side = least_side_ * view_.shorter_side();
  const double middle = (static_cast<double>(box.min_y) + box.max_y) / 2;
  const double high = is_projected() ? side * mercator_stretch(middle) : side;
  const auto cells = [](double length) {
    return static_cast<std::int64_t>(std::ceil(std::min(length, static_cast<double>(kGridSize))));
  };
  return widened(box, cells(side), cells(high));
}

// In one class, there are no more of them than pixels.
void LayerDrawing::add_places(const Layer::Selection& selection, const FeatureClasses* classes,
                              DrawingTools& tools) {
  const bool is_kept = paint_->small == SmallPolygons::keep;
  // A mote may reach into the next pixel, and an enlarged small polygon into the next picture.
  Layer::Selection around = selection;
  around.box = with_margin(selection.box, 2 * least_side_ * view_.longer_side());
  if (classes == nullptr && is_kept) {
    layer_->small_polygons(around, tools.places);
    for (const Box& place : tools.places) class_drawing(0).add_place(least_around(place), false);
  }
  const GrainIndex::Births births = births_of_dust(*paint_, selection);
  if (births.is_empty()) return;
  tools.dust.add(layer_->grains(), {around.box, births, view_.shorter_side()},
                 classes == nullptr ? std::span<const std::uint8_t>() : *classes, tools.shapes);
}

// For all pieces.
void LayerDrawing::add_shapes(DrawingTools& tools) {
  const bool is_kept = paint_->small == SmallPolygons::keep;
  for (const ClassMote& mote : tools.shapes.motes) {
    if (is_kept && mote.is_hole) continue;
    class_drawing(mote.feature_class)
        .add_place(is_kept ? least_around(mote.box) : mote.box, mote.is_hole);
  }
  for (const ClassPatch& patch : tools.shapes.patches) {
    if (is_kept && patch.is_hole) continue;
    class_drawing(patch.feature_class).add_patch(patch);
  }
}

// If one piece fills the box, so do all together, unless there is dust, which may remove area.
bool LayerDrawing::fills_box(const Layer::Selection& selection, const ClassDrawing& drawing) {
  const std::span pieces(drawing.pieces.data(), drawing.piece_count);
  const auto have_dust = [](const auto& piece) { return piece.layer->have_dust(piece.ranges); };
  if (pieces.size() > 1 && std::ranges::any_of(pieces, have_dust)) return false;
  return std::ranges::any_of(
      pieces, [&](const auto& piece) { return piece.layer->fill_box(selection, piece.ranges); });
}

void LayerDrawing::finish_class(const Layer::Selection& selection, ClassDrawing& drawing) {
  const bool has_made = !drawing.made_trapezoids.empty();
  if (drawing.alpha == 0 && !has_pattern()) return;
  drawing.is_full = !has_made && view_.is_on_world() && fills_box(selection, drawing);
  if (drawing.is_full) return;
  for (std::size_t i = 0; i < drawing.piece_count; ++i) {
    const ClassDrawing::OfPiece& piece = drawing.pieces[i];
    drawing.parts.push_back({piece.layer->mesh(), piece.ranges});
  }
  if (has_made) {
    const MeshView mesh{new_mesh_id(), drawing.made_vertices, drawing.made_edges,
                        drawing.made_trapezoids};
    drawing.all_made = {0, static_cast<std::uint32_t>(drawing.made_trapezoids.size())};
    drawing.parts.push_back({mesh, {&drawing.all_made, 1}});
  }
  if (is_projected()) drawing.project(view_);
  drawing.digest = mask_digest(drawing.parts, view_);
  drawing.is_full = drawing.digest == whole_mask_digest(view_);
  drawing.is_drawn = !drawing.is_full && drawing.digest != Digest();
  if (!drawing.is_drawn) drawing.digest = {};
}

void LayerDrawing::leave_out_empty_lines() {
  std::size_t left = 0;
  for (std::size_t i = 0; i < line_count_; ++i) {
    if (lines_[i].edges.empty() && lines_[i].seen_edges.empty()) continue;
    if (left != i) std::swap(lines_[left], lines_[i]);
    ++left;
  }
  line_count_ = left;
}

void LayerDrawing::collect_edges(const Layer::Selection& selection, const InkOfLoops& ink,
                                 const FeatureClasses* classes, DrawingTools& tools) {
  for (const ClassDrawing* drawing : by_number_) {
    if (drawing != nullptr) add_edges(drawing->ranges, drawing->number);
  }
  layer_->select_horizontal_edges(selection.box, selection.level, tools.ranges);
  std::vector<std::vector<TrapezoidRange>> by_class(style().paints.size());
  for_each_trapezoid(tools.ranges, [&](std::uint32_t i) {
    const std::uint32_t row = layer_->feature_of(i);
    const std::uint8_t number = number_of(classes, row);
    const bool is_cut = has_stack_ && tools.stack.is_cut(row);
    if (number != kNotDrawn && !is_cut) append_trapezoid(i, by_class[number]);
  });
  for (std::size_t number = 0; number < by_class.size(); ++number) {
    add_edges(by_class[number], static_cast<std::uint8_t>(number));
  }
  for (std::size_t i = 0; i < line_count_; ++i) {
    if (tools.cancellation != nullptr) tools.cancellation->check();
    take_sides(selection.box, ink, lines_[i], tools);
  }
}

// Most edges are sides of several trapezoids, some of which reach far out of the box.
void LayerDrawing::take_sides(const Box& box, const InkOfLoops& ink, Lines& lines,
                              DrawingTools& tools) const {
  const MeshView& mesh = layer_->mesh();
  lines.point_of_vertex.clear();
  lines.points.numbers.clear();
  lines.seen_points.numbers.clear();
  sort_and_part(lines.sides);
  for (const std::uint32_t side : lines.sides) {
    const MeshEdge& edge = mesh.edges[side];
    OutlineEdge line{edge.upper, edge.lower};
    if (!take_edge(side, mesh.vertices[edge.upper], mesh.vertices[edge.lower], box, ink, line)) {
      continue;
    }
    if (has_round_corners() || has_growth()) {
      trace_side(line, side, lines, tools);
      continue;
    }
    if (is_projected()) {
      project_side(line, lines, tools);
      continue;
    }
    if (has_pieces_) take_points(line, lines);
    lines.edges.push_back(line);
  }
  lines.sides.clear();
  if (lines.seen_points.is_joined) take_once(lines.seen);
  for (const SeenEdge& seen : lines.seen) {
    OutlineEdge line;
    if (!take_edge(seen.edge, seen.from, seen.to, box, ink, line)) continue;
    line.ink *= seen.share;
    if (is_projected()) {
      project_seen(line, seen, lines, tools);
      continue;
    }
    line.from = lines.seen_points.at(seen.from);
    line.to = lines.seen_points.at(seen.to);
    lines.seen_edges.push_back(line);
  }
  lines.seen.clear();
}

// For an edge between vertices of the current piece: edges that share a vertex still share it.
void LayerDrawing::take_points(OutlineEdge& line, Lines& lines) const {
  const std::span<const Point> vertices = layer_->mesh().vertices;
  line.from = lines.point_of(line.from, vertices[line.from]);
  line.to = lines.point_of(line.to, vertices[line.to]);
}

std::uint32_t LayerDrawing::Lines::point_of(std::uint32_t vertex, Point place) {
  const auto [found, is_new] =
      point_of_vertex.emplace(vertex, static_cast<std::uint32_t>(points.points.size()));
  if (is_new) points.points.push_back(place);
  return found->second;
}

// Lines that meet at a vertex must meet at one point, so that they are joined there.
void LayerDrawing::project_side(const OutlineEdge& line, Lines& lines, DrawingTools& tools) const {
  const Point from = layer_->mesh().vertices[line.from];
  const Point to = layer_->mesh().vertices[line.to];
  tools.plate_carree.cut(from, to, tools.way);
  if (tools.way.empty()) return;
  const auto point_at = [&lines](const PlateCarreeMesh::PointOnWay& end, std::uint32_t vertex) {
    if (end.share == 0 || end.share == 1) return lines.point_of(vertex, end.place);
    lines.points.points.push_back(end.place);
    return static_cast<std::uint32_t>(lines.points.points.size() - 1);
  };
  const std::uint32_t first = point_at(tools.way.front(), line.from);
  const std::uint32_t last = point_at(tools.way.back(), line.to);
  append_way(line, length_between(from, to), first, last, tools.way, lines.points.points,
             lines.edges);
}

std::uint32_t LayerDrawing::PointsByPlace::at(Point place) {
  const auto next = static_cast<std::uint32_t>(points.size());
  if (is_joined) {
    const auto key = std::uint64_t{static_cast<std::uint32_t>(place.x)} << 32 |
                     static_cast<std::uint32_t>(place.y);
    const auto [found, is_new] = numbers.emplace(key, next);
    if (!is_new) return found->second;
  }
  points.push_back(place);
  return next;
}

void LayerDrawing::PointsByPlace::clear() {
  points.clear();
  numbers.clear();
}

// A rounded edge includes half of the curve at each end, up to where it meets the adjacent rounded
// edge. A moved edge extends to the adjacent edge, with which it is joined.
void LayerDrawing::trace_side(const OutlineEdge& line, std::uint32_t edge, Lines& lines,
                              DrawingTools& tools) const {
  using PointOnWay = PlateCarreeMesh::PointOnWay;
  const MeshView& mesh = layer_->mesh();
  const double length = length_between(mesh.vertices[line.from], mesh.vertices[line.to]);
  const auto append = [&](std::span<const PointOnWay> way) {
    if (way.size() < 2) return;
    const std::uint32_t first = lines.points.at(way.front().place);
    const std::uint32_t last = lines.points.at(way.back().place);
    append_way(line, length, first, last, way, lines.points.points, lines.edges);
  };
  std::vector<PointOnWay>& way = tools.traced_way;
  if (has_growth()) {
    tools.exaggeration.trace(piece_number_, mesh, edge, way);
  } else {
    tools.corners.trace(piece_number_, mesh, edge, way);
  }
  if (!is_projected()) return append(way);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double from = way[i - 1].share;
    const double all = way[i].share - from;
    tools.plate_carree.cut(way[i - 1].place, way[i].place, tools.way);
    for (PointOnWay& point : tools.way) point.share = from + point.share * all;
    append(tools.way);
  }
}

void LayerDrawing::project_seen(const OutlineEdge& line, const SeenEdge& seen, Lines& lines,
                                DrawingTools& tools) const {
  tools.plate_carree.cut(seen.from, seen.to, tools.way);
  if (tools.way.empty()) return;
  const std::uint32_t first = lines.seen_points.at(tools.way.front().place);
  const std::uint32_t last = lines.seen_points.at(tools.way.back().place);
  append_way(line, length_between(seen.from, seen.to), first, last, tools.way,
             lines.seen_points.points, lines.seen_edges);
}

/// Appends a line along the way, whose length was `length`, from its first point to its last, with
/// new points between. Dashes are as long as in Web Mercator where the line runs along a parallel,
/// and shorter elsewhere.
void LayerDrawing::append_way(const OutlineEdge& line, double length, std::uint32_t first,
                              std::uint32_t last, std::span<const PlateCarreeMesh::PointOnWay> way,
                              std::vector<Point>& points, std::vector<OutlineEdge>& edges) const {
  const bool is_dashed = style().stroke.is_dashed();
  std::uint32_t from = first;
  for (std::size_t i = 1; i < way.size(); ++i) {
    std::uint32_t to = last;
    if (i + 1 < way.size()) {
      to = static_cast<std::uint32_t>(points.size());
      points.push_back(way[i].place);
    }
    OutlineEdge piece = line;
    piece.from = from;
    piece.to = to;
    if (is_dashed) {
      const double grown = line.rate * length * (way[i].share - way[i - 1].share);
      piece.along = line.along + line.rate * length * way[i - 1].share;
      piece.rate = grown / length_between(way[i - 1].place, way[i].place);
    }
    edges.push_back(piece);
    from = to;
  }
}

std::span<const Point> LayerDrawing::points_of(const Lines& lines) const {
  const bool has_own = has_pieces_ || is_projected() || has_round_corners() || has_growth();
  return has_own ? std::span<const Point>(lines.points.points) : layer_->mesh().vertices;
}

// Sets ink and dashes for the piece of an edge between two points. False if it is not visible here.
bool LayerDrawing::take_edge(std::uint32_t edge, Point from, Point to, const Box& box,
                             const InkOfLoops& ink, OutlineEdge& line) const {
  const MeshView& mesh = layer_->mesh();
  const OutlineView& outline = layer_->outline();
  line.ink = ink.of(outline.loop_size(edge), from.y);
  const bool has_frame = view_.projection != Projection::plane;
  if (line.ink < kLeastInk || !meets(from, to, box)) return false;
  if (has_frame && is_on_frame(from, to)) return false;
  if (!style().stroke.is_dashed()) return true;
  const Point upper = mesh.vertices[mesh.edges[edge].upper];
  const Point lower = mesh.vertices[mesh.edges[edge].lower];
  const AlongEdge along = along_edge(mesh, outline, edge, paint_->level);
  line.rate = (along.lower - along.upper) / length_between(upper, lower);
  line.along = along.upper + line.rate * length_between(upper, from);
  return true;
}

LayerDrawing::Lines* LayerDrawing::find_lines(Rgba colour) {
  for (std::size_t i = 0; i < line_count_; ++i) {
    if (lines_[i].colour == colour) return &lines_[i];
  }
  return nullptr;
}

LayerDrawing::Lines& LayerDrawing::lines_of(Rgba colour) {
  if (Lines* found = find_lines(colour)) return *found;
  if (line_count_ == lines_.size()) lines_.emplace_back();
  Lines& lines = lines_[line_count_++];
  lines.colour = colour;
  // Lines with round ends need no joins.
  const bool is_joined = style().stroke.join != LineJoin::round;
  lines.points.is_joined = lines.seen_points.is_joined = is_joined;
  lines.sides.clear();
  lines.edges.clear();
  lines.points.clear();
  lines.seen.clear();
  lines.seen_points.clear();
  lines.seen_edges.clear();
  return lines;
}

void LayerDrawing::add_edges(std::span<const TrapezoidRange> ranges, std::uint8_t number) {
  const Rgba colour = style().paints[number].stroke;
  if (ranges.empty() || colour.a == 0) return;
  Lines& lines = lines_of(colour);
  std::vector<SideOf> in_common;
  // Where others grow, features that overlap others keep their shape, and lines with joins are
  // joined only with lines of their own kind. As whether those others are near depends on the
  // picture, their edges must not: they are those that add_stack() adds.
  const bool are_apart = has_growth() || lines.points.is_joined;
  std::vector<std::uint32_t> unmoved;
  std::vector<std::uint32_t>& of_overlapping = are_apart ? unmoved : lines.sides;
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const auto is_alone = [&](std::uint32_t row) {
      return row == Layer::kNoFeature || layer_->overlaps().of(row).empty();
    };
    const bool may_move = !are_apart || is_alone(layer_->feature_of(i));
    add_sides_of(i, may_move ? lines.sides : of_overlapping, in_common);
  });
  append_outer(in_common, of_overlapping);
  sort_and_part(unmoved);
  const MeshView& mesh = layer_->mesh();
  for (const std::uint32_t edge : unmoved) {
    const MeshEdge& ends = mesh.edges[edge];
    lines.seen.push_back({edge, mesh.vertices[ends.upper], mesh.vertices[ends.lower]});
  }
}

// If the feature overlaps others, only some of its sides are edges of its outline: these go to
// `in_common`, see append_outer(). For all other features, both sides are.
void LayerDrawing::add_sides_of(std::uint32_t trapezoid, std::vector<std::uint32_t>& edges,
                                std::vector<SideOf>& in_common) const {
  const std::uint32_t row = layer_->feature_of(trapezoid);
  if (row == Layer::kNoFeature) return;  // dust has no outline
  const MeshTrapezoid& t = layer_->mesh().trapezoids[trapezoid];
  if (!layer_->overlaps().has_in_common(row)) {
    edges.insert(edges.end(), {t.left, t.right});
    return;
  }
  in_common.push_back({row, t.left, false});
  if (t.left != t.right) in_common.push_back({row, t.right, true});  // otherwise it is a level edge
}

const LayerDrawing::ClassDrawing* LayerDrawing::only_class() const {
  const ClassDrawing* only = nullptr;
  for (std::size_t i = 0; i < class_count_; ++i) {
    const ClassDrawing& drawing = classes_[i];
    if (!drawing.is_full && !drawing.is_drawn) continue;
    if (only != nullptr) return nullptr;
    only = &drawing;
  }
  return only;
}

bool LayerDrawing::hides_all() const {
  const ClassDrawing* only = only_class();
  return only != nullptr && only->is_full && only->alpha == 255 && style().opacity == 1;
}

bool LayerDrawing::is_constant() const {
  const ClassDrawing* only = only_class();
  return only != nullptr && only->is_full && line_count_ == 0 && !has_pattern();
}

void LayerDrawing::add_tasks(const Cancellation* cancellation, std::vector<MaskTask>& tasks) {
  for (std::size_t i = 0; i < class_count_; ++i) {
    ClassDrawing& drawing = classes_[i];
    if (drawing.is_drawn) tasks.push_back({drawing.parts, view_, &drawing.mask, cancellation});
  }
}

void LayerDrawing::draw_details(const View& picture, double scale, DrawingTools& tools) {
  if (has_pattern()) pattern_.place(style().pattern, picture, scale);
  for (std::size_t i = 0; i < line_count_; ++i) {
    Lines& lines = lines_[i];
    tools.stroker.begin(view_, scale);
    tools.stroker.add(points_of(lines), lines.edges);
    tools.stroker.add(lines.seen_points.points, lines.seen_edges);
    tools.stroker.draw(style().stroke, tools.cancellation);
    tools.stroker.finish(lines.mask);
  }
}

void LayerDrawing::forget_made(MaskRenderer& renderer) {
  for (std::size_t i = 0; i < class_count_; ++i) {
    if (classes_[i].all_made.count > 0) renderer.forget(classes_[i].parts.back().mesh.id);
  }
}

// A pixel on the seam shows a part of each copy; a line that ends there continues beyond it in
// both.
void LayerDrawing::take_over(LayerDrawing& copy) {
  const auto take = [](Mask& from, bool is_first, Mask& to, const auto& combine) {
    to = is_first ? std::move(from) : combine(to, from);
  };
  for (std::size_t i = 0; i < copy.class_count_; ++i) {
    ClassDrawing& theirs = copy.classes_[i];
    if (!theirs.is_full && !theirs.is_drawn) continue;
    ClassDrawing& ours = theirs.is_beneath ? drawing_beneath(theirs.number, theirs.alpha)
                                           : class_drawing(theirs.number);
    // Then this copy is beside the picture, and only its lines reach into it.
    ours.is_full = ours.is_full || theirs.is_full;
    if (!theirs.is_drawn) continue;
    take(theirs.mask, !ours.is_drawn, ours.mask, sum_of);
    ours.is_drawn = true;
  }
  for (std::size_t i = 0; i < copy.line_count_; ++i) {
    Lines& theirs = copy.lines_[i];
    const bool is_first = find_lines(theirs.colour) == nullptr;
    take(theirs.mask, is_first, lines_of(theirs.colour).mask, greater_of);
  }
}

// In painting order.
template <typename Visit>
void LayerDrawing::for_each_painted(const Visit& visit) const {
  const auto visit_seen = [&visit](const ClassDrawing& drawing) {
    if (drawing.is_full || drawing.is_drawn) visit(drawing);
  };
  for (const ClassDrawing* drawing : by_number_) {
    if (drawing != nullptr) visit_seen(*drawing);
  }
  for (std::size_t i = 0; i < class_count_; ++i) {
    if (classes_[i].is_beneath) visit_seen(classes_[i]);
  }
}

// In painting order: outlines of highlighted features, whose class is the last one, are above all
// others. Which of the two were met first differs from tile to tile.
template <typename Visit>
void LayerDrawing::for_each_lines(const Visit& visit) const {
  const Rgba uppermost = style().paints.back().stroke;
  for (const bool is_uppermost : {false, true}) {
    for (std::size_t i = 0; i < line_count_; ++i) {
      if ((lines_[i].colour == uppermost) == is_uppermost) visit(lines_[i]);
    }
  }
}

Rgba LayerDrawing::colour_of(const ClassDrawing& drawing) const {
  Rgba colour = style().paints[drawing.number].fill;
  colour.a = drawing.alpha;
  return colour;
}

PaintedLayer LayerDrawing::painted() {
  painted_classes_.clear();
  painted_lines_.clear();
  for_each_painted([this](const ClassDrawing& drawing) {
    painted_classes_.push_back(
        {drawing.is_full ? nullptr : &drawing.mask, colour_of(drawing), drawing.is_beneath});
  });
  for_each_lines([this](const Lines& lines) {
    painted_lines_.push_back({&lines.mask, lines.colour});
  });
  return {painted_classes_, has_pattern() ? &pattern_ : nullptr, style().pattern.colour,
          painted_lines_, style().opacity};
}

void LayerDrawing::add_to(ContentHash& hash, const View& picture) const {
  hash.add(std::bit_cast<std::uint64_t>(style().opacity));
  for_each_painted([&](const ClassDrawing& drawing) {
    hash.add(to_hex(colour_of(drawing)));
    hash.add(drawing.is_full ? "full" : drawing.is_beneath ? "beneath" : "beside");
    add(drawing.digest, hash);
  });
  if (has_pattern()) add_pattern_to(hash, picture);
  if (line_count_ > 0) add_lines_to(hash);
}

// Patterns are fixed to the ground.
void LayerDrawing::add_pattern_to(ContentHash& hash, const View& picture) const {
  const Pattern& pattern = style().pattern;
  hash.add(kPatternNames.name_of(pattern.kind));
  hash.add(to_hex(pattern.colour));
  for (const double length : {pattern.size, pattern.angle, pattern.width, picture.cells_per_pixel,
                              picture.stretch, scale_}) {
    hash.add(std::bit_cast<std::uint64_t>(length));
  }
  // Where the world repeats, patterns are adapted to it.
  hash.add(picture.projection == Projection::plane ? std::uint64_t{1} : std::uint64_t{0});
  hash.add(static_cast<std::uint64_t>(picture.origin_x));
  hash.add(static_cast<std::uint64_t>(picture.origin_y));
}

void LayerDrawing::add_lines_to(ContentHash& hash) const {
  const Stroke& stroke = style().stroke;
  hash.add(kLineJoinNames.name_of(stroke.join));
  hash.add(std::bit_cast<std::uint64_t>(stroke.width));
  hash.add(std::bit_cast<std::uint64_t>(scale_));
  hash.add(stroke.dashes.size());
  for (const double dash : stroke.dashes) hash.add(std::bit_cast<std::uint64_t>(dash));
  for_each_lines([&](const Lines& lines) {
    hash.add(to_hex(lines.colour));
    add(outline_digest(points_of(lines), lines.edges, stroke, view_), hash);
    add(outline_digest(lines.seen_points.points, lines.seen_edges, stroke, view_), hash);
  });
}

double LayerDrawing::tolerance() const {
  return epsilon_of_level(paint_->level) / view_.shorter_side();
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
  if (line_count_ > 0 || has_pattern()) return false;
  const ClassDrawing* only = only_class();
  return only != nullptr && (only->is_full || only->mask.is_all(255));
}

}  // namespace trapeze
