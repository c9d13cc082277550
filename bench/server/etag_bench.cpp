// The time from a request to its 304 response, for tiles that were never requested from the server
// before.
//
//   TRAPEZE_DATA=folder etag_bench
//
// In one process and without HTTP: a site draws every tile and so determines its entity tag; then a
// new site, which has only the data, gets a request for each tile with that tag. Before that, one
// other tile makes it read layers and styles, and compute classes and labels, as on a server in
// use. Every time counts; any response other than 304 ends the benchmark.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/figures.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "render/make_renderer.h"
#include "server/config/load_config.h"
#include "server/service/site.h"
#include "server/tiles/open_fonts.h"

namespace trapeze {
namespace {

struct Options {
  std::vector<std::string> maps{"malta_landuse+malta_natural+malta_buildings",
                                "usa48_land",
                                "us_counties",
                                "melbourne_landuse",
                                "shenzhen_buildings",
                                "europe_countries"};
  std::vector<std::string> styles{"", "stroke=333", "color-by={}&classes=*:red", "label={}"};
  std::size_t tiles = 30;
  int first_zoom = 1;  // the tile of zoom 0 is the one requested first
  int last_zoom = 18;
  std::string json = "out/bench/etag.json";
};

std::vector<std::string> split(const std::string& names) {
  std::vector<std::string> all(1);
  for (const char c : names) {
    if (c == '+') {
      all.emplace_back();
    } else {
      all.back() += c;
    }
  }
  return all;
}

/// The last text attribute that all layers have.
std::string attribute_of(const Dataset& dataset) {
  const auto has_text = [](const ServedLayer& layer, const std::string& name) {
    return std::ranges::any_of(layer.layer->features().fields(), [&](const Field& field) {
      return field.name == name && field.type == FieldType::text;
    });
  };
  std::string found;
  for (const Field& field : dataset.layers().front().layer->features().fields()) {
    const auto in_layer = [&](const ServedLayer& layer) { return has_text(layer, field.name); };
    if (std::ranges::all_of(dataset.layers(), in_layer)) found = field.name;
  }
  return found;
}

/// A site that has only the data.
class FreshSite {
 public:
  FreshSite(std::shared_ptr<const Dataset> dataset, const std::shared_ptr<LabelBook>& labels)
      : tiles_(options_of(labels), make_renderers({RendererKind::software, {}}, 2).renderers),
        site_({.tile_cost = 0}, {}, data_, tiles_, cache_) {
    data_.set(std::move(dataset));
  }

  HttpResponse get(const std::string& target, const std::string& tag) const {
    std::promise<HttpResponse> promise;
    site_.handle({"GET", target, "localhost", tag},
                 [&promise](HttpResponse response) { promise.set_value(std::move(response)); });
    return promise.get_future().get();
  }

 private:
  TileServiceOptions options_of(const std::shared_ptr<LabelBook>& labels) {
    TileServiceOptions options;
    options.fonts = open_fonts({});
    options.labels = labels;
    options.find_kept = [this](const std::string& fingerprint) { return cache_.find(fingerprint); };
    return options;
  }

  CurrentDataset data_;
  TileCache cache_{std::size_t{64} << 20};
  TileService tiles_;
  Site site_;
};

class Measurement {
 public:
  Measurement(const std::string& map, const Options& options)
      : map_(map),
        names_(split(map)),
        labels_(std::make_shared<LabelBook>(FontChoice{open_fonts({})})) {
    std::vector<TripLayer> layers;
    std::vector<std::string> files;
    for (const std::string& name : names_) {
      files.push_back(real_data_folder() + "/" + name + ".fgb");
      layers.push_back({name, files.back(), ""});
    }
    dataset_ = Dataset::load(layers_of_files(files));
    tiles_ = tiles_at_vertices(read_places(layers), options.first_zoom, options.last_zoom,
                               options.tiles);
  }

  Figure measure(std::string style) const {
    if (const auto place = style.find("{}"); place != std::string::npos) {
      style.replace(place, 2, attribute_of(*dataset_));
    }
    Figure figure("etag/" + map_ + "/" + (style.empty() ? "plain" : style));
    std::vector<std::string> tags;
    {
      const FreshSite site(dataset_, labels_);
      for (const TileId& tile : tiles_) {
        tags.emplace_back(expect(200, site.get(target_of(tile, style), "")).header("ETag"));
      }
    }
    const FreshSite site(dataset_, labels_);
    expect(200, site.get(target_of({0, 0, 0}, style), ""));
    TileRun run;
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
      const std::string target = target_of(tiles_[i], style);
      const auto begin = std::chrono::steady_clock::now();
      const HttpResponse response = site.get(target, tags[i]);
      const std::chrono::duration<double, std::milli> time =
          std::chrono::steady_clock::now() - begin;
      expect(304, response);
      run.tiles.push_back({tiles_[i].z, time.count()});
      run.seconds += time.count() / 1000;
    }
    figure.add(std::move(run));
    return figure;
  }

 private:
  std::string target_of(const TileId& tile, const std::string& style) const {
    return fmt::format("/tiles/{}/{}/{}/{}.png{}{}", fmt::join(names_, ","), tile.z, tile.x, tile.y,
                       style.empty() ? "" : "?", style);
  }

  static const HttpResponse& expect(int status, const HttpResponse& response) {
    if (response.status == status) return response;
    throw std::runtime_error("the answer is " + std::to_string(response.status) + ": " +
                             (response.body ? *response.body : ""));
  }

  std::string map_;
  std::vector<std::string> names_;
  std::shared_ptr<LabelBook> labels_;
  std::shared_ptr<const Dataset> dataset_;
  std::vector<TileId> tiles_;
};

int run(int argc, char** argv) {
  Options options;
  CLI::App app("From a request to the 304 that answers it, of tiles never asked for before");
  app.add_option("--map", options.maps, "Layers of one picture, joined by +; several times");
  app.add_option("--style", options.styles, "As in a URL, {} being an attribute; several times");
  app.add_option("--tiles", options.tiles, "Tiles of every zoom")->capture_default_str();
  app.add_option("--first-zoom", options.first_zoom)
      ->check(CLI::Range(1, 22))
      ->capture_default_str();
  app.add_option("--last-zoom", options.last_zoom)->check(CLI::Range(1, 22))->capture_default_str();
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<Figure> figures;
  print_table_head();
  for (const std::string& map : options.maps) {
    const Measurement measurement(map, options);
    for (const std::string& style : options.styles) {
      figures.push_back(measurement.measure(style));
      print_line(figures.back());
    }
  }
  write_figures(figures, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("etag_bench", trapeze::run, argc, argv);
}
