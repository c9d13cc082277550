// What is drawn of one layer in one tile: the trapezoids of each class of features, the pattern
// over them, and the outlines.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/layer/class_dust.h"
#include "core/layer/layer.h"
#include "render/mask/mask.h"
#include "render/mask/stroke.h"
#include "render/picture/compose.h"
#include "server/styles/feature_classes.h"
#include "server/tiles/loop_length_cache.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {

/// What the drawings of one tile have in common. The memory is kept from tile to tile.
struct DrawingTools {
  const Cancellation* cancellation = nullptr;  // of the tile; null: wanted whatever happens
  ClassDust dust;
  Stroker stroker;
  LoopLengthCache loop_lengths{std::size_t{64} << 20};
  std::vector<TrapezoidRange> ranges;
  std::vector<ClassMote> motes;
  std::vector<Box> places;
};

/// What of the layer is looked at: what lies in the view, and near it as far as outlines reach.
Layer::Selection selection_of(const TilePlan& plan, const LayerPaint& paint, const View& view);

class LayerDrawing {
 public:
  /// Selects what is to be drawn. `classes` has the class of every feature; null if the style is
  /// plain. False if there is nothing of the layer here; the drawing must then not be used. Throws
  /// Cancelled.
  bool select(const TilePlan& plan, const LayerPaint& paint, const View& view,
              const FeatureClasses* classes, DrawingTools& tools);

  /// Whether nothing below the layer can be seen.
  bool hides_all() const;
  /// Whether every pixel has one colour, known without drawing.
  bool is_constant() const;

  /// Appends the masks that have to be drawn; they look at memory of the drawing.
  void add_tasks(const View& view, const Cancellation* cancellation, std::vector<MaskTask>& tasks);
  /// Draws pattern and outlines, for a picture of that scale. Throws Cancelled.
  void draw_details(const View& view, int scale, DrawingTools& tools);
  /// Releases what was made for this picture only.
  void forget_places(MaskRenderer& renderer);

  /// As it goes into the picture, once all has been drawn; looks at memory of the drawing.
  PaintedLayer painted();

  /// Of what was drawn: whether nothing of it is to be seen, and whether it covers all alike.
  bool is_empty() const;
  bool is_full() const;

 private:
  // The features of one class.
  struct ClassDrawing {
    std::uint8_t number = 0;
    bool is_full = false;   // covers the tile wholly and need not be drawn
    bool is_drawn = false;  // its mask
    std::vector<TrapezoidRange> ranges;
    // Small polygons; their mesh is made for this picture.
    std::vector<Point> place_vertices;
    std::vector<MeshEdge> place_edges;
    std::vector<MeshTrapezoid> place_trapezoids;
    TrapezoidRange all_places;
    std::vector<MeshPart> parts;
    Mask mask;

    void clear(std::uint8_t class_number);
    void add_place(const Box& place, bool is_hole);
  };
  // Outlines of one colour.
  struct Lines {
    Rgba colour;
    std::vector<std::uint32_t> sides;  // edges of the mesh, before they are taken once each
    // The same of dashed lines: edge, and row of the feature whose outline it is a part of.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> dashed_sides;
    std::vector<OutlineEdge> edges;
    Mask mask;
  };

  const LayerStyle& style() const { return paint_->style; }
  bool has_lines() const { return style().stroke.width > 0; }
  bool has_pattern() const { return style().pattern.kind != PatternKind::none; }
  ClassDrawing& class_drawing(std::uint8_t number);
  void part_by_class(const FeatureClasses& classes, const DrawingTools& tools);
  void add_places(const Layer::Selection& selection, const View& view,
                  const FeatureClasses* classes, DrawingTools& tools);
  void finish_class(const Layer::Selection& selection, ClassDrawing& drawing);
  void collect_edges(const Layer::Selection& selection, const FeatureClasses* classes,
                     DrawingTools& tools);
  Lines& lines_of(Rgba colour);
  void add_edges(std::span<const TrapezoidRange> ranges, std::uint8_t number);
  void take_sides(const Box& box, Lines& lines) const;
  void take_dashed_sides(Lines& lines, DrawingTools& tools) const;

  const LayerPaint* paint_ = nullptr;
  const Layer* layer_ = nullptr;
  std::deque<ClassDrawing> classes_;  // parts point into them
  std::size_t class_count_ = 0;
  std::vector<ClassDrawing*> by_number_;  // null: not met yet
  std::deque<Lines> lines_;
  std::size_t line_count_ = 0;
  Mask pattern_;
  std::vector<PaintedClass> painted_classes_;
  std::vector<PaintedClass> painted_lines_;
};

}  // namespace trapeze
