#include <spdlog/spdlog.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "render/picture/webp.h"
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

/// The value, or the problem thrown as a sentence for the command line.
template <typename T>
T value_or_throw(OrProblem<T> result) {
  if (const auto* problem = std::get_if<Problem>(&result)) {
    throw UsageError(problem->value.empty()
                         ? problem->detail
                         : fmt::format("{} Given was \"{}\".", problem->detail, problem->value));
  }
  return std::move(std::get<T>(result));
}

TileId tile_of_text(const std::string& text) {
  const std::size_t first = text.find('/');
  const std::size_t second = first == std::string::npos ? first : text.find('/', first + 1);
  if (second == std::string::npos) {
    throw UsageError(fmt::format("--tile takes Z/X/Y, given was \"{}\"", text));
  }
  const std::string_view view = text;
  return value_or_throw(parse_tile_id(
      view.substr(0, first), view.substr(first + 1, second - first - 1), view.substr(second + 1)));
}

/// What the end of a file's name says, whatever its case.
TileFormat format_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".png") return TileFormat::png;
  if (extension != ".webp") {
    throw UsageError(
        fmt::format("--output takes a name that ends in .png or .webp, given was \"{}\"", path));
  }
  if (!has_webp()) throw UsageError("--output: this program was built without WebP; take .png");
  return TileFormat::webp;
}

TileRequest make_request(const RenderArguments& arguments, const std::vector<LayerConfig>& layers) {
  TileRequest request;
  for (const LayerConfig& layer : layers) request.layers.push_back(layer.name);
  request.tile = tile_of_text(arguments.tile);
  request.scale = arguments.scale;
  request.format = format_of(arguments.output);
  const auto query = decode_query(arguments.style);
  if (!query) throw UsageError("--style takes a query string such as fill=red");
  const auto expanded = value_or_throw(StyleBook().expand(*query));
  request.style = value_or_throw(StyleQuery::parse(expanded, request.layers));
  return request;
}

void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw std::runtime_error(fmt::format("cannot write {}", path));
}

}  // namespace

int run_render(const RenderArguments& arguments) {
  const std::vector<LayerConfig> layers = layers_of_files(arguments.files);
  const TileRequest request = make_request(arguments, layers);
  const auto kind = renderer_kind_from(arguments.renderer);
  if (!kind) throw UsageError("--renderer takes auto, egl, osmesa or software");
  auto renderers = start_renderers({*kind, arguments.device}, 1);
  TilePainter painter(std::move(renderers.front()), TilePainter::new_class_cache(), open_fonts({}));
  const TilePlan plan = value_or_throw(plan_tile(request, Dataset::load(layers)));
  const TilePainter::Job job{&plan, TilePainter::Deadline::max()};
  const PaintedTile tile = painter.paint({&job, 1}).front().value();
  write_file(arguments.output, *tile.bytes);
  const PaintTimes& times = tile.times;
  spdlog::info(
      "{}: {} bytes; select {:.2f}, draw {:.2f}, read {:.2f}, resolve {:.2f}, compose "
      "{:.2f}, encode {:.2f} ms",
      arguments.output, tile.bytes->size(), times.select_ms, times.draw_ms, times.read_ms,
      times.resolve_ms, times.compose_ms, times.encode_ms);
  return 0;
}

}  // namespace trapeze
