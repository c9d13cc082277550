#include "bench/experiment/report.h"

#include <sys/sysinfo.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <thread>

namespace trapeze::experiment {
namespace {

using nlohmann::json;

std::string_view name_of(Topology topology) {
  return topology == Topology::strict ? "strict" : "fast";
}

json views_to_json(const std::vector<ViewCost>& views) {
  json columns;
  const auto column = [&](const char* name, const auto& value) {
    json& values = columns[name];
    for (const ViewCost& view : views) values.push_back(value(view));
  };
  column("simplify_ms", [](const ViewCost& v) { return v.simplify_ms; });
  column("tessellate_ms", [](const ViewCost& v) { return v.tessellate_ms; });
  column("send_ms", [](const ViewCost& v) { return v.send_ms; });
  column("draw_ms", [](const ViewCost& v) { return v.draw_ms; });
  column("read_ms", [](const ViewCost& v) { return v.read_ms; });
  column("cpu_before_draw_ms", [](const ViewCost& v) { return v.cpu_before_draw_ms; });
  column("cpu_ms", [](const ViewCost& v) { return v.cpu_ms; });
  column("vertices", [](const ViewCost& v) { return v.vertices; });
  column("trapezoids", [](const ViewCost& v) { return v.trapezoids; });
  column("bytes", [](const ViewCost& v) { return v.bytes; });
  return columns;
}

json to_json(const RaceResult& race) {
  return {{"method", name_of(race.method)},
          {"title", title_of(race.method)},
          {"topology", name_of(race.topology)},
          {"prepare_ms", race.prepare_ms},
          {"memory", race.memory},
          {"sent_before", race.sent_before},
          {"runs", race.runs},
          {"seconds", race.seconds},
          {"views", views_to_json(race.views)}};
}

json to_json(const PictureErrors& errors) {
  json scales = json::array();
  for (const PictureError& error : errors.scales) {
    scales.push_back({{"scale", error.scale},
                      {"pixels", error.pixels},
                      {"mean", error.mean},
                      {"share_over_64", error.share_over_64},
                      {"area", error.area}});
  }
  return {{"method", name_of(errors.method)},
          {"topology", name_of(errors.topology)},
          {"scales", std::move(scales)}};
}

json to_json(const Quality& quality) {
  return {{"method", name_of(quality.method)},
          {"topology", name_of(quality.topology)},
          {"scale", quality.scale},
          {"polygons", quality.polygons},
          {"gone", quality.gone},
          {"invalid", quality.invalid},
          {"vertices", quality.vertices},
          {"tolerance", quality.tolerance},
          {"hausdorff", quality.hausdorff},
          {"area_error", quality.area_error}};
}

json to_json(const MapReport& map) {
  json layers = json::array();
  for (std::size_t i = 0; i < map.source.layers.size(); ++i) {
    const LayerSource& layer = map.source.layers[i];
    layers.push_back({{"file", layer.file},
                      {"title", layer.title},
                      {"origin", layer.origin},
                      {"below", layer.below},
                      {"polygons", map.layer_polygons[i]},
                      {"vertices", map.layer_vertices[i]}});
  }
  json races = json::array();
  for (const RaceResult& race : map.races) races.push_back(to_json(race));
  json pictures = json::array();
  for (const PictureErrors& errors : map.pictures) pictures.push_back(to_json(errors));
  json quality = json::array();
  for (const Quality& q : map.quality) quality.push_back(to_json(q));
  return {
      {"name", map.source.name},
      {"title", map.source.title},
      {"licence", map.source.licence},
      {"seconds",
       {{"load", map.seconds.load},
        {"races", map.seconds.races},
        {"quality", map.seconds.quality},
        {"figures", map.seconds.figures}}},
      {"layers", std::move(layers)},
      {"smallest_scale", map.source.smallest_scale},
      {"largest_scale", map.source.largest_scale},
      {"trip", {{"scales", map.trip_scales}, {"tolerances", map.trip_tolerances}}},
      {"empty_view", {{"draw_ms", map.empty_view.draw_ms}, {"read_ms", map.empty_view.read_ms}}},
      {"races", std::move(races)},
      {"pictures", std::move(pictures)},
      {"quality", std::move(quality)},
      {"figures", map.figures}};
}

json to_json(const GrowthPoint& point) {
  return {{"vertices", point.vertices},        {"build_ms", point.build_ms},
          {"weigh_ms", point.weigh_ms},        {"generalize_ms", point.generalize_ms},
          {"undo_ms", point.undo_ms},          {"load_ms", point.load_ms},
          {"view_ms", point.view_ms},          {"graph_memory", point.graph_memory},
          {"layer_memory", point.layer_memory}};
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::string_view key = "model name";
    const std::size_t colon = line.find(": ");
    if (line.starts_with(key) && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

double mean(const std::vector<ViewCost>& views, double (*value)(const ViewCost&)) {
  double sum = 0;
  for (const ViewCost& view : views) sum += value(view);
  return sum / static_cast<double>(views.size());
}

}  // namespace

std::string describe_machine() {
  struct sysinfo info {};
  sysinfo(&info);
  const double gigabytes = static_cast<double>(info.totalram) * info.mem_unit / (1 << 30);
  return processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, " +
         std::to_string(std::lround(gigabytes)) + " GiB";
}

void write_report(const Report& report, const std::string& path) {
  json maps = json::array();
  for (const MapReport& map : report.maps) maps.push_back(to_json(map));
  json growth = json::array();
  for (const GrowthPoint& point : report.growth) growth.push_back(to_json(point));
  const json all{{"commit", report.commit},
                 {"machine", report.machine},
                 {"device", report.device},
                 {"seed", report.options.seed},
                 {"simplify_pixels", report.options.simplify_pixels},
                 {"screen", {kScreenWidth, kScreenHeight}},
                 {"runs", report.runs},
                 {"seconds_of_runs", report.seconds_of_runs},
                 {"seconds", report.seconds},
                 {"growth_seconds", report.growth_seconds},
                 {"maps", std::move(maps)},
                 {"growth", std::move(growth)}};
  std::ofstream file(path);
  file << all.dump(1) << '\n';
  if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

std::string summary_of(const MapReport& map) {
  std::string text;
  std::array<char, 200> line{};
  const auto add = [&](int length) { text.append(line.data(), static_cast<std::size_t>(length)); };
  add(std::snprintf(line.data(), line.size(), "%-20s %-8s %9s %10s %8s %8s %8s %9s %9s %5s %8s\n",
                    map.source.name.c_str(), "topology", "simplify", "tessellate", "send", "draw",
                    "read", "total ms", "CPU ms", "runs", "seconds"));
  for (const RaceResult& race : map.races) {
    const auto of = [&](double (*value)(const ViewCost&)) { return mean(race.views, value); };
    add(std::snprintf(line.data(), line.size(),
                      "%-20s %-8s %9.2f %10.2f %8.2f %8.2f %8.2f %9.2f %9.2f %5d %8.1f\n",
                      std::string(title_of(race.method)).c_str(),
                      std::string(name_of(race.topology)).c_str(),
                      of([](const ViewCost& v) { return v.simplify_ms; }),
                      of([](const ViewCost& v) { return v.tessellate_ms; }),
                      of([](const ViewCost& v) { return v.send_ms; }),
                      of([](const ViewCost& v) { return v.draw_ms; }),
                      of([](const ViewCost& v) { return v.read_ms; }),
                      of([](const ViewCost& v) { return v.total_ms(); }),
                      of([](const ViewCost& v) { return v.cpu_ms; }), race.runs, race.seconds));
  }
  add(std::snprintf(line.data(), line.size(),
                    "seconds: load %.1f, races %.1f, quality %.1f, figures %.1f\n",
                    map.seconds.load, map.seconds.races, map.seconds.quality, map.seconds.figures));
  return text;
}

}  // namespace trapeze::experiment
