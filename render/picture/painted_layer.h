// The input of composition: masks with their colours, by layer.
#pragma once

#include <span>
#include <vector>

#include "render/mask/mask.h"
#include "render/picture/colour.h"
#include "render/picture/meeting.h"
#include "render/picture/pattern.h"

namespace trapeze {

/// Polygons or lines of one colour. A view of the caller's memory.
struct PaintedClass {
  const Mask* mask = nullptr;  // null: every pixel is fully covered
  Rgba colour;                 // including its opacity
  // The part that shows through another class of the layer; that class counts as covering the
  // pixel.
  bool is_beneath = false;
};

/// A layer to be painted: classes of polygons, whose colours mix by the area that each covers; the
/// pattern over them; lines over that, the first one lowest. The opacity applies to the result. A
/// view of the caller's memory.
struct PaintedLayer {
  std::span<const PaintedClass> classes;
  const PlacedPattern* pattern = nullptr;  // null: none; visible where the classes cover
  Rgba pattern_colour = kTransparent;
  std::span<const PaintedClass> lines = {};
  double opacity = 1;
  std::span<const Meeting> meetings = {};  // with the layers below, in order of pixels
};

/// Each class as a layer of its own, in this order; views of the classes.
inline std::vector<PaintedLayer> plain_layers(std::span<const PaintedClass> classes) {
  std::vector<PaintedLayer> layers(classes.size());
  for (std::size_t i = 0; i < classes.size(); ++i) layers[i].classes = classes.subspan(i, 1);
  return layers;
}

}  // namespace trapeze
