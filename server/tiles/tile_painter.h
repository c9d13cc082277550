// Paints tiles: selects trapezoids, draws masks, composes colours, encodes the PNG or WebP.
//
// Thread-safety: one thread at a time; every worker has its own painter.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/grid/cancellation.h"
#include "render/mask/mask.h"
#include "render/picture/compose.h"
#include "render/picture/layer_meetings.h"
#include "render/picture/picture.h"
#include "render/picture/png.h"
#include "render/text/fonts.h"
#include "server/labels/label_book.h"
#include "server/styles/feature_classes.h"
#include "server/tiles/layer_drawing.h"
#include "server/tiles/painted_tile.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {

class TilePainter {
 public:
  /// Painters may share the class cache, the fonts (for marks) and the labels.
  explicit TilePainter(std::unique_ptr<MaskRenderer> renderer,
                       std::shared_ptr<FeatureClassCache> classes = new_class_cache(),
                       std::shared_ptr<const Fonts> fonts = std::make_shared<const Fonts>(),
                       std::shared_ptr<LabelBook> labels = std::make_shared<LabelBook>());

  /// Large enough for the classes that the requests of one map use.
  static std::shared_ptr<FeatureClassCache> new_class_cache();

  /// Paints the tiles. Tiles without any boundary are taken from constants; all others are drawn in
  /// one pass. Returns nothing for tiles that are no longer wanted. The picture of a tile does not
  /// depend on the other tiles. Throws the errors of the renderer and the encoder; if it throws
  /// Cancelled, one of the tiles was cancelled.
  ///
  /// The fingerprint, 128 bits as hex digits, covers everything that determines the bytes of a
  /// tile: its sides and lines as clipped to it, colours, size, format, the renderer, and
  /// kPictureVersion. Tiles with the same fingerprint have the same bytes, wherever they are,
  /// however their layers are numbered or named, and whoever paints them. Debug marks are the
  /// exception: with them, the fingerprint differs for each tile, layer and build.
  std::vector<std::optional<PaintedTile>> paint(std::span<const PaintJob> jobs);

  /// The fingerprint that paint() would return.
  std::string identify(const PaintJob& job);

  /// The number of bands a picture is painted in: 1, or several for a large picture, which painters
  /// may paint at the same time. The number depends only on the plan, and so do the bytes.
  static int bands_of(const TilePlan& plan);
  /// Paints one band; 0 is the northernmost. Otherwise as paint().
  std::optional<PaintedBand> paint_band(const PaintJob& job, int band);
  /// Joins the bands, listed from the north, into the tile.
  PaintedTile join(const TilePlan& plan, std::span<const PaintedBand> bands);

  /// Frees working memory that giant tiles need and most tiles do not.
  void release_memory();

  /// Whether painting several tiles in one pass is faster than painting them one by one.
  bool gains_by_batching() const { return renderer_->gains_by_batching(); }

 private:
  // The drawings of one tile or band, and their state.
  struct Sketch {
    View view;
    std::string fingerprint;
    bool is_cancelled = false;
    bool is_wanted = true;
    std::size_t first_drawing = 0;
    std::size_t end_drawing = 0;
    std::size_t tasks = 0;  // of those to be drawn
    std::vector<DrawnLabel> labels;
    PaintTimes times;
  };

  Sketch sketch(const PaintJob& job, const View& view);
  std::string fingerprint_of(const TilePlan& plan, const Sketch& sketch) const;
  bool is_constant(const TilePlan& plan, const Sketch& sketch) const;
  void select(const TilePlan& plan, Sketch& sketch);
  void draw_details(const PaintJob& job, Sketch& sketch);
  std::vector<DrawnPiece> pieces_for(const TilePlan& plan, const LayerPaint& paint,
                                     const View& view);
  DrawTimes draw(std::span<const PaintJob> jobs, std::span<Sketch> sketches);
  void note_times(const DrawTimes& drawn, Sketch& sketch) const;
  PaintedTile finish(const TilePlan& plan, Sketch& sketch);
  /// False if the tile has one colour; the picture then is a single pixel of that colour.
  bool compose(const TilePlan& plan, Sketch& sketch);
  TileHint hint_of(const Sketch& sketch) const;
  std::string encode(TileFormat format);
  std::shared_ptr<const std::string> constant(Rgba colour, int width, int height,
                                              TileFormat format);
  void mark(const TilePlan& plan, const View& view, Picture& picture);
  static void mark_layers(const TilePlan& plan, const View& view, Picture& picture);
  static void mark_piece(const TilePlan& plan, const LayerPaint& paint, const Layer& layer,
                         const View& view, Picture& picture);

  std::unique_ptr<MaskRenderer> renderer_;
  std::string renderer_identity_;
  std::shared_ptr<FeatureClassCache> classes_;
  std::shared_ptr<const Fonts> fonts_;
  std::shared_ptr<LabelBook> labels_;
  Composer composer_;
  PngEncoder encoder_;
  using ConstantKey = std::tuple<std::string, int, int, TileFormat>;  // colour, width, height
  std::map<ConstantKey, std::shared_ptr<const std::string>> constants_;
  // Reused from tile to tile to save allocations.
  std::deque<LayerDrawing> drawings_;  // tasks point into them
  std::size_t drawing_count_ = 0;
  std::vector<MaskTask> tasks_;
  std::vector<PaintedLayer> painted_;
  std::vector<double> tolerances_;  // by layer
  LayerMeetings meetings_;
  DrawingTools tools_;
  RunPicture picture_;
};

}  // namespace trapeze
