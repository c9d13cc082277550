// Compares tiles drawn by the software renderer and with EGL.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "render/make_renderer.h"
#include "render/picture/png.h"
#include "render/software/software_renderer.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_request.h"

namespace trapeze::testing {

/// Draws a tile, given by its address after /tiles/, in plain C++ and with EGL, and expects
/// opacities that differ by at most 2.
inline void expect_same_by_gl(const std::string& target,
                              const std::shared_ptr<const Dataset>& dataset) {
  const auto parsed = parse_tiles_target(split_target("/tiles/" + target).value(), StyleBook());
  const TilePlan plan = *plan_tile(std::get<TileRequest>(*parsed), dataset);
  const auto draw = [&plan](std::unique_ptr<MaskRenderer> renderer) {
    TilePainter painter(std::move(renderer));
    const PaintJob job{&plan};
    return decode_png(*painter.paint({&job, 1}).front()->bytes);
  };
  const Picture one = draw(std::make_unique<SoftwareRenderer>());
  const Picture other = draw(make_renderer({RendererKind::egl, {}}).renderer);
  ASSERT_EQ(one.pixels.size(), other.pixels.size());
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    ASSERT_NEAR(one.pixels[i].a, other.pixels[i].a, 2) << target;
  }
}

}  // namespace trapeze::testing
