// Draws one layer in one tile: the trapezoids of each class of features, the pattern over them, and
// the outlines. A layer in several parts is drawn as if it were one: the parts do not overlap, so
// their areas add up.
//
// Thread-safety: one thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/grid/digest.h"
#include "core/layer/class_dust.h"
#include "core/layer/feature_stack.h"
#include "core/layer/layer.h"
#include "core/mesh/corner_rounding.h"
#include "core/mesh/exaggeration.h"
#include "core/mesh/plate_carree_mesh.h"
#include "core/mesh/seen_edges.h"
#include "render/mask/mask.h"
#include "render/mask/stroke.h"
#include "render/picture/compose.h"
#include "server/base/content_hash.h"
#include "server/styles/feature_classes.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {

/// The share of ink of the outlines of loops, by loop size.
class InkOfLoops {
 public:
  /// For a picture of that scale. Keeps a reference to the stroke.
  InkOfLoops(const Stroke& stroke, const View& view, double scale);

  /// At that y of the grid.
  double of(LoopSize size, std::int32_t y) const;

 private:
  const Stroke& stroke_;
  View view_;
  double scale_;
  std::array<double, kLoopSizes> by_size_{};  // if all pixels of the picture are the same size
};

/// Tools shared by the drawings of one tile. Their memory is reused from tile to tile.
struct DrawingTools {
  const Cancellation* cancellation = nullptr;  // of the tile; null: cannot be cancelled
  ClassDust dust;
  FeatureStack stack;
  Stroker stroker;
  std::vector<TrapezoidRange> ranges;
  ClassShapes shapes;
  std::vector<Box> places;
  PlateCarreeMesh plate_carree;  // for outlines
  std::vector<PlateCarreeMesh::PointOnWay> way;
  CornerRounding corners;     // for styles that round them
  Exaggeration exaggeration;  // for styles in which features grow
  std::vector<PlateCarreeMesh::PointOnWay> traced_way;
};

/// A layer, or a part of one, with the classes of its features. `classes` is null if all features
/// are drawn the same way.
struct DrawnPiece {
  const Layer* layer = nullptr;
  std::shared_ptr<const FeatureClasses> classes;
};

/// Selects the features of the layer in the view, and around it as far as outlines reach.
Layer::Selection selection_of(const TilePlan& plan, const LayerPaint& paint, const View& view);

/// How far outlines of the layer reach, in pixels; 0 if it has none.
double reach_of_lines(const TilePlan& plan, const LayerPaint& paint);

/// The births of the dust that is collected from grains, feature by feature.
GrainIndex::Births births_of_dust(const LayerPaint& paint, const Layer::Selection& selection);

/// Whether all features are opaque, of one colour and without outlines, so that the drawing order
/// of overlapping features does not matter.
bool is_plain(const LayerStyle& style);

/// Whether pixels are so small that, in plain styles, only pairs of overlapping features whose
/// boundaries run along each other are cut; see FeatureStack::Options.
bool has_fine_pixels(const View& view);

class LayerDrawing {
 public:
  /// Selects what to draw of the world inside the view; the drawing copies the view. For other
  /// copies of the world, see views_of_copies(). `pieces` are the pieces of the layer there, see
  /// TilePlan::pieces_of(); they must outlive the drawing. Returns false if nothing of the layer is
  /// visible here; the drawing must not be used then. Throws Cancelled.
  bool select(const TilePlan& plan, const LayerPaint& paint, const View& view,
              std::span<const DrawnPiece> pieces, DrawingTools& tools);

  /// Whether the layer hides everything below it.
  bool hides_all() const;
  /// Whether all pixels have the same colour, known without drawing.
  bool is_constant() const;

  /// Adds everything that determines painted(): drawings that add the same are painted the same in
  /// pictures of the same size, however their layers are numbered. `picture` places the pattern,
  /// here and below; it is the same for all copies of the world.
  void add_to(ContentHash& hash, const View& picture) const;

  /// Appends the masks to draw; they refer to memory of the drawing.
  void add_tasks(const Cancellation* cancellation, std::vector<MaskTask>& tasks);
  /// Places the pattern and draws the outlines for a picture of that scale. Throws Cancelled.
  void draw_details(const View& picture, double scale, DrawingTools& tools);
  /// Releases what was created for this picture only.
  void forget_made(MaskRenderer& renderer);

  /// Whether both are of the same layer, in two copies of the world.
  bool is_of_same_layer(const LayerDrawing& other) const { return paint_ == other.paint_; }
  /// Adds what was drawn of the same layer in another copy of the world.
  void take_over(LayerDrawing& copy);

  /// The layer as it is composed into the picture, once everything is drawn. Refers to memory of
  /// the drawing.
  PaintedLayer painted();
  /// The maximum distance of the drawn boundary from the true one, in pixels.
  double tolerance() const;

  /// After drawing: whether nothing is visible, and whether the whole picture is covered evenly.
  bool is_empty() const;
  bool is_full() const;

  /// An edge as a side of a trapezoid of a feature.
  struct SideOf {
    std::uint32_t row = 0;
    std::uint32_t edge = 0;
    bool is_right = false;

    auto operator<=>(const SideOf&) const = default;
  };

 private:
  // The features of one class, or their parts that show through overlapping features.
  struct ClassDrawing {
    std::uint8_t number = 0;
    std::uint8_t alpha = 0;  // of the fill
    bool is_beneath = false;
    bool is_full = false;                // covers the whole tile, so needs no drawing
    bool is_drawn = false;               // whether its mask is drawn
    std::vector<TrapezoidRange> ranges;  // of the current piece
    struct OfPiece {
      const Layer* layer = nullptr;
      std::vector<TrapezoidRange> ranges;
    };
    std::vector<OfPiece> pieces;  // pieces with a selection; only the first piece_count count
    std::size_t piece_count = 0;
    // A mesh created for this picture: small polygons, and parts of trapezoids.
    std::vector<Point> made_vertices;
    std::vector<MeshEdge> made_edges;
    std::vector<MeshTrapezoid> made_trapezoids;
    TrapezoidRange all_made;
    PlateCarreeMesh projected;  // all parts, if the picture is in plate carree
    std::vector<MeshPart> parts;
    Digest digest;  // of the mask, if it is drawn
    Mask mask;

    void clear(std::uint8_t class_number);
    void end_piece(const Layer& layer);
    void add_place(const Box& place, bool is_hole);
    void add_patch(const ClassPatch& patch);
    void add_corner(const CornerRounding& corners, const CornerRounding::Corner& corner,
                    bool is_hole);
    void add_grown(const Exaggeration::Triangle& triangle);
    void give_way(const Exaggeration& exaggeration, const MeshView& mesh,
                  const MeshTrapezoid& trapezoid);
    void add_part(const MeshView& mesh, const TrapezoidPart& part);
    void project(const View& view);
  };
  // Points of edges; shared between edges if they are joined.
  struct PointsByPlace {
    std::vector<Point> points;
    std::unordered_map<std::uint64_t, std::uint32_t> numbers;  // by place, for the current piece
    bool is_joined = false;

    /// The number of the point at that place: a new one if there is none, or if points are not
    /// joined.
    std::uint32_t at(Point place);
    void clear();
  };
  // Outlines of one colour.
  struct Lines {
    Rgba colour;
    // Edges of the current piece's mesh, with duplicates still to be removed.
    std::vector<std::uint32_t> sides;
    std::vector<OutlineEdge> edges;
    // With several pieces, in plate carree, with rounded corners and where something has grown, the
    // edges run between points of their own. Some of these are vertices: `point_of_vertex` maps
    // vertex numbers of the current piece to them.
    PointsByPlace points;
    std::unordered_map<std::uint32_t, std::uint32_t> point_of_vertex;
    // The visible parts of the edges of features overlapped by others, between points of their own.
    std::vector<SeenEdge> seen;  // of the current piece
    PointsByPlace seen_points;
    std::vector<OutlineEdge> seen_edges;
    Mask mask;

    std::uint32_t point_of(std::uint32_t vertex, Point place);
  };

  // A trapezoid with its feature and the class of that feature.
  struct Painted {
    std::uint32_t trapezoid = 0;
    std::uint32_t row = 0;
    std::uint8_t number = 0;
  };

  bool is_raised(std::uint8_t number) const;
  /// The only class of which anything is painted; null if there are none or several.
  const ClassDrawing* only_class() const;
  const LayerStyle& style() const { return paint_->style; }
  bool is_projected() const { return view_.projection == Projection::plate_carree; }
  bool has_round_corners() const { return style().smooth > 0; }
  bool has_growth() const { return style().grow > 0; }
  bool has_lines() const { return style().stroke.width > 0; }
  bool has_pattern() const { return style().pattern.kind != PatternKind::none; }
  // `ink` is null if no outlines are drawn.
  void add_piece(const DrawnPiece& piece, const Layer::Selection& selection, const InkOfLoops* ink,
                 DrawingTools& tools);
  void round_corners(double scale, std::span<const DrawnPiece> pieces,
                     const Layer::Selection& selection, DrawingTools& tools);
  void find_corners(double scale, std::span<const DrawnPiece> pieces,
                    const Layer::Selection& selection, DrawingTools& tools) const;
  void grow(double scale, std::span<const DrawnPiece> pieces, const Layer::Selection& selection,
            DrawingTools& tools);
  void find_growth(double scale, std::span<const DrawnPiece> pieces,
                   const Layer::Selection& selection, DrawingTools& tools) const;
  void give_way(ClassDrawing& drawing, DrawingTools& tools) const;
  Box least_around(const Box& box) const;
  void add_shapes(DrawingTools& tools);
  std::span<const Point> points_of(const Lines& lines) const;
  ClassDrawing& new_drawing(std::uint8_t number);
  ClassDrawing& class_drawing(std::uint8_t number);
  ClassDrawing& drawing_beneath(std::uint8_t number, std::uint8_t alpha);
  void part_by_class(const FeatureClasses* classes, const Layer::Selection& selection,
                     DrawingTools& tools);
  void leave_those_that_meet(const Box& box, std::vector<TrapezoidRange>& ranges) const;
  bool find_stack(const FeatureClasses* classes, const Layer::Selection& selection,
                  DrawingTools& tools);
  void add_stack(const FeatureClasses* classes, const Layer::Selection& selection,
                 DrawingTools& tools);
  void add_parts(std::uint8_t number, std::span<const TrapezoidPart> parts);
  void add_seen_edges(std::uint8_t number, std::span<const std::uint32_t> trapezoids,
                      std::span<const std::uint32_t> level_edges, const VisibleInBox& visible);
  bool take_edge(std::uint32_t edge, Point from, Point to, const Box& box, const InkOfLoops& ink,
                 OutlineEdge& line) const;
  void add_places(const Layer::Selection& selection, const FeatureClasses* classes,
                  DrawingTools& tools);
  void finish_class(const Layer::Selection& selection, ClassDrawing& drawing);
  static bool fills_box(const Layer::Selection& selection, const ClassDrawing& drawing);
  void leave_out_empty_lines();
  template <typename Visit>
  void for_each_painted(const Visit& visit) const;
  template <typename Visit>
  void for_each_lines(const Visit& visit) const;
  Rgba colour_of(const ClassDrawing& drawing) const;
  void add_pattern_to(ContentHash& hash, const View& picture) const;
  void add_lines_to(ContentHash& hash) const;
  void collect_edges(const Layer::Selection& selection, const InkOfLoops& ink,
                     const FeatureClasses* classes, DrawingTools& tools);
  Lines* find_lines(Rgba colour);
  Lines& lines_of(Rgba colour);
  void add_edges(std::span<const TrapezoidRange> ranges, std::uint8_t number);
  void add_sides_of(std::uint32_t trapezoid, std::vector<std::uint32_t>& edges,
                    std::vector<SideOf>& in_common) const;
  void take_sides(const Box& box, const InkOfLoops& ink, Lines& lines, DrawingTools& tools) const;
  void take_points(OutlineEdge& line, Lines& lines) const;
  void project_side(const OutlineEdge& line, Lines& lines, DrawingTools& tools) const;
  void trace_side(const OutlineEdge& line, std::uint32_t edge, Lines& lines,
                  DrawingTools& tools) const;
  void project_seen(const OutlineEdge& line, const SeenEdge& seen, Lines& lines,
                    DrawingTools& tools) const;
  void append_way(const OutlineEdge& line, double length, std::uint32_t first, std::uint32_t last,
                  std::span<const PlateCarreeMesh::PointOnWay> way, std::vector<Point>& points,
                  std::vector<OutlineEdge>& edges) const;

  const LayerPaint* paint_ = nullptr;
  const Layer* layer_ = nullptr;  // the current piece; afterwards the only one
  std::uint32_t piece_number_ = 0;
  bool has_pieces_ = false;  // more than one
  double least_side_ = 1;    // of a small polygon as it is drawn, in pixels
  double scale_ = 1;         // of lines and patterns
  View view_;
  bool has_stack_ = false;            // features overlap here
  std::deque<ClassDrawing> classes_;  // parts point into them
  std::size_t class_count_ = 0;
  std::vector<ClassDrawing*> by_number_;  // null: not met yet
  std::deque<Lines> lines_;
  std::size_t line_count_ = 0;
  PlacedPattern pattern_;
  std::vector<PaintedClass> painted_classes_;
  std::vector<PaintedClass> painted_lines_;
};

}  // namespace trapeze
