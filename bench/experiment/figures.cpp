#include "bench/experiment/figures.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/experiment/trip.h"
#include "render/picture/compose.h"
#include "render/picture/debug_marks.h"
#include "render/picture/png.h"

namespace trapeze::experiment {
namespace {

constexpr int kWidth = 640;  // pixels: a part of the screen, at the same scale
constexpr int kHeight = 480;
constexpr Rgba kPaper{0xfa, 0xf8, 0xf2, 0xff};
constexpr Rgba kMeshColour{0x20, 0x30, 0x48, 0x70};
constexpr std::array<Rgba, 3> kFills{
    {{0xe3, 0xd5, 0xa8, 0xff}, {0x8f, 0xbf, 0x8a, 0xff}, {0xb0, 0x52, 0x4a, 0xff}}};
constexpr std::array<Rgba, 3> kPaleFills{
    {{0xf4, 0xee, 0xdc, 0xff}, {0xd5, 0xe8, 0xd3, 0xff}, {0xec, 0xcf, 0xcb, 0xff}}};

View middle_view(const View& view) {
  View middle = view;
  middle.width = kWidth;
  middle.height = kHeight;
  middle.origin_x += static_cast<std::int64_t>(view.cells_per_pixel * (view.width - kWidth) / 2);
  middle.origin_y += static_cast<std::int64_t>(view.cells_per_pixel * (view.height - kHeight) / 2);
  return middle;
}

void write(const RunPicture& picture, const std::filesystem::path& path) {
  const std::string png = PngEncoder().encode(picture);
  std::ofstream file(path, std::ios::binary);
  file.write(png.data(), static_cast<std::streamsize>(png.size()));
  if (!file.flush()) throw std::runtime_error(path.string() + " cannot be written");
}

RunPicture filled(const std::vector<Mask>& masks, std::span<const Rgba> fills) {
  std::vector<PaintedClass> layers;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    layers.push_back({&masks[i], fills[i % fills.size()]});
  }
  RunPicture picture;
  Composer().compose(plain_layers(layers), kWidth, kHeight, kPaper, Quality::exact, picture);
  return picture;
}

}  // namespace

std::vector<ScaledView> views_of_scale(const std::vector<ScaledView>& trip, double scale) {
  std::vector<ScaledView> views;
  bool was_there = false;
  for (const ScaledView& view : trip) {
    const bool is_there = view.scale == scale;
    if (is_there && !was_there) views.push_back(view);
    was_there = is_there;
  }
  return views;
}

std::vector<std::string> draw_figures(const Map& map, const std::vector<ScaledView>& trip,
                                      const std::string& folder, Screen& screen) {
  std::vector<std::unique_ptr<Layer>> layers;
  std::vector<MeshView> meshes;
  for (const MapLayer& layer : map.layers) {
    layers.push_back(build_layer(layer, Topology::strict));
    meshes.push_back(layers.back()->mesh());
  }
  std::vector<std::string> names;
  std::vector<Ranges> ranges(layers.size());
  std::vector<Mask> masks;
  int number = 0;
  for (const double share : kFigureScales) {
    const ScaledView scaled = views_of_scale(trip, share * map.source.smallest_scale).front();
    const View view = middle_view(scaled.view);
    const auto select = [&](SmallPolygons small) {
      for (std::size_t i = 0; i < layers.size(); ++i) {
        layers[i]->select({view.box(), scaled.level, scaled.level, small}, ranges[i]);
      }
    };
    const auto write_as = [&](const RunPicture& picture, const std::string& suffix) {
      names.push_back(map.source.name + "-" + std::to_string(number) + suffix + ".png");
      write(picture, std::filesystem::path(folder) / names.back());
    };
    ++number;
    select(SmallPolygons::dust);
    screen.draw(meshes, ranges, view, masks);
    write_as(filled(masks, kFills), "");
    Picture picture = to_pixels(filled(masks, kPaleFills));
    select(SmallPolygons::drop);
    for (std::size_t i = 0; i < layers.size(); ++i) {
      mark_mesh(meshes[i], ranges[i], view, kMeshColour, picture);
    }
    write_as(to_runs(picture), "-mesh");
  }
  for (const MeshView& mesh : meshes) screen.forget(mesh.id);
  return names;
}

}  // namespace trapeze::experiment
