// The paper's experiment (sections 4 and 5.1), with additions. Started by `trapeze bench
// experiment`.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/experiment/figures.h"
#include "bench/experiment/report.h"

namespace {

using namespace trapeze;
using namespace trapeze::experiment;

constexpr const char* kDescription =
    "The paper's experiment: 72 views of a map, zooming and panning, drawn by Douglas-Peucker and\n"
    "by BLG trees with trapezoidation for every view, by the paper's adaptable graphs, and by\n"
    "Trapeze; quality of what is drawn; growth with the number of vertices.\n\n"
    "With no FILE: the maps of bench/RESULTS.md, as far as their files are there. With FILEs: one\n"
    "map with a layer from each, the lowest first, such as an extract of OpenStreetMap:\n"
    "  trapeze bench experiment city.osm.pbf --parts race,quality";

struct Arguments {
  std::vector<std::string> files;
  std::string data;
  std::string sample = "data";
  std::vector<std::string> maps;
  std::vector<std::string> parts{"race", "quality", "growth", "figures"};
  std::string output = "out/bench/experiment";
  std::string commit = "unknown";
  std::string device;
  TripOptions trip;
  RaceOptions race;
  double smallest_scale = 250000;
  std::size_t most_vertices = 10'000'000;

  bool has(const std::string& part) const {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  }
};

std::vector<std::string> names_of_methods() {
  std::vector<std::string> names;
  for (const Method method : kMethods) names.emplace_back(name_of(method));
  return names;
}

std::vector<Method> methods_named(const std::vector<std::string>& names) {
  std::vector<Method> methods;
  for (const Method method : kMethods) {
    if (std::find(names.begin(), names.end(), name_of(method)) != names.end()) {
      methods.push_back(method);
    }
  }
  return methods;
}

Arguments parse(CLI::App& app, int argc, char** argv) {
  Arguments a;
  if (const char* data = std::getenv("TRAPEZE_DATA")) a.data = data;
  app.add_option("FILE", a.files, "Files of polygons, in any format GDAL reads");
  app.add_option("--data", a.data, "Folder of the real layers; $TRAPEZE_DATA if not set")
      ->type_name("DIR");
  app.add_option("--sample", a.sample, "Folder of the sample world, data if not set")
      ->type_name("DIR");
  app.add_option("--maps", a.maps, "Only these: shenzhen, malta, world")->delimiter(',');
  app.add_option("--parts", a.parts, "Only these: race, quality, growth, figures")
      ->delimiter(',')
      ->check(CLI::IsMember({"race", "quality", "growth", "figures"}));
  app.add_option("--runs", a.race.runs, "How often each goes on the trip, 3 if not set")
      ->check(CLI::Range(1, 99));
  app.add_option("--seconds", a.race.seconds,
                 "Of a map, with one treatment of topology: runs that would end later than this\n"
                 "are not begun, but for the first; 120 if not set")
      ->check(CLI::NonNegativeNumber);
  std::vector<std::string> contestants = names_of_methods();
  app.add_option("--contestants", contestants,
                 "Only these: dp, blg, cdt, all, paper, trapeze, dust, none")
      ->delimiter(',')
      ->check(CLI::IsMember(names_of_methods()));
  app.add_option("--seed", a.trip.seed, "Of the trip, 1 if not set");
  app.add_option("--simplify", a.trip.simplify_pixels, "Tolerance in pixels, 0.25 if not set")
      ->check(CLI::Range(0.01, 64.0));
  app.add_option("--scale", a.smallest_scale,
                 "Of FILEs: the trip is from 1:SCALE to 1:(SCALE / 83) and back")
      ->check(CLI::Range(100.0, 5e8));
  app.add_option("--most-vertices", a.most_vertices, "Where the growth ends, 10^7 if not set");
  app.add_option("--device", a.device, "The EGL device to prefer: its index, or part of its name");
  app.add_option("--commit", a.commit, "Noted in the JSON");
  app.add_option("--output", a.output, "Folder for experiment.json and the pictures")
      ->type_name("DIR");
  app.parse(argc, argv);
  a.race.methods = methods_named(contestants);
  return a;
}

std::vector<MapSource> chosen_maps(const Arguments& a) {
  if (!a.files.empty()) {
    MapSource map{.name = "map", .title = "Files given", .licence = "", .layers = {}};
    for (const std::string& file : a.files) {
      map.layers.push_back({file, std::filesystem::path(file).stem().string(), file, ""});
    }
    map.smallest_scale = a.smallest_scale;
    map.largest_scale = a.smallest_scale * 3 / 250;
    return {map};
  }
  std::vector<MapSource> maps = known_maps(a.data, a.sample);
  const auto is_left_out = [&a](const MapSource& map) {
    return !a.maps.empty() && std::find(a.maps.begin(), a.maps.end(), map.name) == a.maps.end();
  };
  std::erase_if(maps, is_left_out);
  if (maps.size() < a.maps.size()) throw std::runtime_error("files of --maps are not there");
  return maps;
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

using Pictures = std::vector<std::vector<Mask>>;

constexpr Method kPictured[] = {Method::douglas_peucker, Method::adapting, Method::lifespans,
                                Method::lifespans_and_dust};

/// By the scales of Figure 7; `full_detail` has the pictures of each.
std::vector<PictureErrors> errors_of(Race& race, Topology topology, const MapSource& map,
                                     const std::vector<ScaledView>& trip,
                                     const std::vector<Pictures>& full_detail) {
  std::vector<PictureErrors> all;
  for (const Method method : kPictured) {
    if (!race.has(method)) continue;
    PictureErrors errors{method, topology, {}};
    for (std::size_t i = 0; i < full_detail.size(); ++i) {
      const auto views = views_of_scale(trip, kFigureScales[i] * map.smallest_scale);
      errors.scales.push_back(compare(views, race.pictures(method, views), full_detail[i]));
    }
    all.push_back(std::move(errors));
  }
  return all;
}

void run_races(const Map& map, const std::vector<ScaledView>& trip, const Arguments& a,
               Screen& screen, MapReport& report) {
  std::vector<Pictures> full_detail;
  for (const Topology topology : {Topology::strict, Topology::fast}) {
    Race race(map, topology, screen, a.race.methods);
    if (a.has("race")) {
      race.run(trip, a.race);
      for (RaceResult& result : race.results()) report.races.push_back(std::move(result));
    }
    if (!a.has("quality")) continue;
    if (race.has(Method::no_simplification)) {
      for (const double share : kFigureScales) {
        const auto views = views_of_scale(trip, share * map.source.smallest_scale);
        full_detail.push_back(race.pictures(Method::no_simplification, views));
      }
    }
    if (full_detail.empty()) continue;
    for (PictureErrors& e : errors_of(race, topology, map.source, trip, full_detail)) {
      report.pictures.push_back(std::move(e));
    }
  }
}

void measure_quality_of_all(const Map& map, const std::vector<ScaledView>& trip,
                            MapReport& report) {
  std::vector<ScaledView> views;
  for (const double share : kFigureScales) {
    views.push_back(views_of_scale(trip, share * map.source.smallest_scale).front());
  }
  const auto measure = [&](Topology topology) {
    std::vector<Quality> all;
    for (const Method method : {Method::douglas_peucker, Method::adapting, Method::lifespans}) {
      const std::vector<Quality> quality = measure_quality(method, topology, map, views);
      all.insert(all.end(), quality.begin(), quality.end());
    }
    return all;
  };
  // No times are measured here.
  auto fast = std::async(std::launch::async, measure, Topology::fast);
  report.quality = measure(Topology::strict);
  const std::vector<Quality> without = fast.get();
  report.quality.insert(report.quality.end(), without.begin(), without.end());
}

MapReport report_on(const MapSource& source, const Arguments& a, Screen& screen) {
  MapReport report;
  std::cout << "experiment: " << source.title << std::endl;
  auto begin = std::chrono::steady_clock::now();
  const auto lap = [&begin](double& seconds) {
    seconds = seconds_since(begin);
    begin = std::chrono::steady_clock::now();
  };
  const Map map = load_map(source);
  report.source = source;
  for (const MapLayer& layer : map.layers) {
    report.layer_polygons.push_back(layer.polygons.size());
    report.layer_vertices.push_back(layer.vertices);
  }
  const std::vector<ScaledView> trip = plan_trip(map, a.trip);
  for (const ScaledView& view : trip) {
    report.trip_scales.push_back(view.scale);
    report.trip_tolerances.push_back(view.epsilon() / view.view.cells_per_pixel);
  }
  report.empty_view = cost_of_empty_view(map.layers.size(), screen);
  lap(report.seconds.load);
  if (a.has("race") || a.has("quality")) run_races(map, trip, a, screen, report);
  lap(report.seconds.races);
  if (a.has("quality")) measure_quality_of_all(map, trip, report);
  lap(report.seconds.quality);
  if (a.has("figures")) report.figures = draw_figures(map, trip, a.output, screen);
  lap(report.seconds.figures);
  if (a.has("race")) std::cout << summary_of(report) << std::flush;
  return report;
}

int run(const Arguments& a) {
  const auto begin = std::chrono::steady_clock::now();
  std::filesystem::create_directories(a.output);
  Screen screen(a.device);
  Report report;
  report.commit = a.commit;
  report.machine = describe_machine();
  report.device = screen.renderer().description();
  report.options = a.trip;
  report.runs = a.race.runs;
  report.seconds_of_runs = a.race.seconds;
  for (const MapSource& map : chosen_maps(a)) report.maps.push_back(report_on(map, a, screen));
  if (a.has("growth")) {
    std::cout << "experiment: growth" << std::endl;
    const auto growth_begin = std::chrono::steady_clock::now();
    report.growth = measure_growth(a.most_vertices, screen);
    report.growth_seconds = seconds_since(growth_begin);
  }
  report.seconds = seconds_since(begin);
  const std::string path = (std::filesystem::path(a.output) / "experiment.json").string();
  write_report(report, path);
  std::cout << "experiment: the figures are in " << path << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kDescription, "trapeze bench experiment");
  try {
    return run(parse(app, argc, argv));
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::cerr << "trapeze bench experiment: " << error.what() << '\n';
    return 1;
  }
}
