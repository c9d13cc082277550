#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/io/file/atomic_file.h"
#include "render/picture/webp.h"
#include "server/base/nearest_name.h"
#include "server/base/url.h"
#include "server/cli/commands.h"
#include "server/config/load_config.h"
#include "server/data/dataset.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/start_renderers.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

std::optional<TileId> tile_of_text(std::string_view text) {
  const std::size_t first = text.find('/');
  const std::size_t second = first == std::string::npos ? first : text.find('/', first + 1);
  if (second == std::string::npos) return std::nullopt;
  auto tile = parse_tile_id(text.substr(0, first), text.substr(first + 1, second - first - 1),
                            text.substr(second + 1));
  if (!tile) return std::nullopt;
  return *std::move(tile);
}

TileId tile_or_throw(const std::string& text) {
  const auto tile = tile_of_text(text);
  if (tile) return *tile;
  throw UsageError(
      fmt::format("--tile takes Z/X/Y, a zoom from 0 to {} and a column and a row from "
                  "0 to 2^Z - 1, got \"{}\"",
                  kMaxZoom, text));
}

/// Determined by the file name extension, ignoring case.
TileFormat format_of(const std::string& path) {
  const std::string extension = in_lower_case(std::filesystem::path(path).extension().string());
  if (extension == ".png") return TileFormat::png;
  if (extension != ".webp") {
    throw UsageError(fmt::format("--output takes a name that ends in .png or .webp, got \"{}\"{}",
                                 path, did_you_mean(extension, {".png", ".webp"})));
  }
  if (!has_webp()) throw UsageError("--output: this program was built without WebP; use .png");
  return TileFormat::webp;
}

TileRequest make_request(const RenderArguments& arguments, const std::vector<LayerConfig>& layers) {
  TileRequest request;
  for (const LayerConfig& layer : layers) request.layers.push_back(layer.name);
  request.tile = tile_or_throw(arguments.tile);
  request.scale = arguments.scale;
  request.format = format_of(arguments.output);
  request.style = style_or_throw(arguments.style, request.layers);
  return request;
}

/// A file of that name stays as it is unless everything is written.
void write_file(const std::string& path, const std::string& bytes) {
  const Unfinished unfinished = Unfinished::file_beside(path);
  errno = 0;
  std::ofstream file(unfinished.path(), std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    throw std::runtime_error(
        fmt::format("cannot write {}: {}", path, std::generic_category().message(errno)));
  }
  give_name_durably(unfinished, path);
}

}  // namespace

int run_render(const RenderArguments& arguments) {
  std::vector<LayerConfig> layers = layers_or_throw(arguments.files);
  const TileRequest request = make_request(arguments, layers);
  for (LayerConfig& layer : layers) {
    const auto topology = request.style.value_for(layer.name, ParameterId::topology);
    layer.fast_topology = topology && *topology == ParameterValue("fast");
    apply(arguments.coverage, layer);
  }
  const RendererKind kind = word_or_throw("--renderer", arguments.renderer, kRendererNames);
  auto renderers = start_renderers({kind, arguments.device}, 1);
  const auto fonts = open_fonts({});
  TilePainter painter(std::move(renderers.front()), TilePainter::new_class_cache(), fonts,
                      std::make_shared<LabelBook>(FontChoice{fonts}));
  const auto plan = plan_tile(request, Dataset::load(layers));
  if (!plan) throw_wrong_style(plan.problem());
  const PaintJob job{&*plan};
  const PaintedTile tile = painter.paint({&job, 1}).front().value();
  write_file(arguments.output, *tile.bytes);
  const PaintTimes& times = tile.times;
  spdlog::info(
      fmt::format("{}: {} bytes; select {:.2f}, draw {:.2f}, read {:.2f}, resolve {:.2f}, compose "
                  "{:.2f}, encode {:.2f} ms",
                  arguments.output, tile.bytes->size(), times.select_ms, times.draw_ms,
                  times.read_ms, times.resolve_ms, times.compose_ms, times.encode_ms));
  return 0;
}

}  // namespace trapeze
