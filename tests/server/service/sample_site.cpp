#include "tests/server/service/sample_site.h"

#include <future>
#include <stdexcept>
#include <utility>
#include <vector>

#include "render/make_renderer.h"
#include "server/config/load_config.h"
#include "server/tiles/open_fonts.h"

namespace trapeze::testing {
namespace {

std::vector<std::unique_ptr<MaskRenderer>> software_renderers() {
  return make_renderers({RendererKind::software, {}}, 2).renderers;
}

TileServiceOptions tile_options() {
  static const std::shared_ptr<const Fonts> fonts = open_fonts({});
  TileServiceOptions options;
  options.fonts = fonts;
  options.labels = label_book();
  return options;
}

}  // namespace

std::string fixture(const std::string& name) {
  return TRAPEZE_TEST_FIXTURES "/" + name;
}

StyleQuery style_of(const std::string& query) {
  return *StyleQuery::parse(decode_query(query).value(), {});
}

std::string changed(std::string target, const std::string& from, const std::string& to) {
  const std::size_t at = target.find(from);
  if (at == std::string::npos) throw std::invalid_argument(from + " is not in " + target);
  return target.replace(at, from.size(), to);
}

std::shared_ptr<const Dataset> sample_dataset() {
  auto layers = layers_of_files({fixture("rings.geojson"), fixture("west.geojson")});
  layers[0].title = "Rings";
  layers[0].attribution = "drawn by hand";
  layers[0].style = style_of("fill=f00");
  layers[1].style = style_of("fill=00f&fill-opacity=0.5");
  layers[0].fast_topology = true;
  layers[1].min_zoom = 0;
  layers[1].max_zoom = 5;
  return Dataset::load(layers);
}

std::shared_ptr<LabelBook> label_book() {
  static const auto book = std::make_shared<LabelBook>(FontChoice{open_fonts({})});
  return book;
}

SampleSite::SampleSite(bool is_loaded, StaticFiles files, SiteOptions options)
    : tiles_(tile_options(), software_renderers()),
      site_(std::move(options), std::move(files), data_, tiles_, cache_) {
  if (is_loaded) data_.set(sample_dataset());
}

Handler SampleSite::handler() {
  return [this](const HttpRequest& request, Respond respond) {
    site_.handle(request, std::move(respond));
  };
}

HttpResponse SampleSite::get(const std::string& target, const std::string& if_none_match) {
  return handle({"GET", target, "maps.example:8080", if_none_match, {}});
}

HttpResponse SampleSite::handle(const HttpRequest& request) {
  std::promise<HttpResponse> promise;
  site_.handle(request,
               [&promise](HttpResponse response) { promise.set_value(std::move(response)); });
  return promise.get_future().get();
}

}  // namespace trapeze::testing
