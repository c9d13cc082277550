#include "bench/measure/figures.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

namespace trapeze {
namespace {

using Json = nlohmann::ordered_json;

/// The smallest value that at least that share of all values does not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

Json to_json(const Percentiles& p) {
  return {{"tiles", p.count},
          {"p50_ms", rounded(p.p50)},
          {"p95_ms", rounded(p.p95)},
          {"p99_ms", rounded(p.p99)},
          {"max_ms", rounded(p.max)}};
}

Json to_json(const Figure& figure) {
  Json json{{"name", figure.name()}};
  if (!figure.note().empty()) json["note"] = figure.note();
  for (const auto& [what, value] : figure.values()) json[what] = rounded(value);
  if (!figure.has_runs()) return json;
  json["tiles_per_second"] = rounded(figure.tiles_per_second());
  json["best_tiles_per_second"] = rounded(figure.best_tiles_per_second());
  json["cpu_ms_per_tile"] = rounded(figure.cpu_ms_per_tile());
  if (figure.bytes_per_tile() > 0) json["bytes_per_tile"] = rounded(figure.bytes_per_tile());
  json.update(to_json(figure.percentiles()));
  Json& zooms = json["by_zoom"] = Json::array();
  for (const auto& [zoom, percentiles] : figure.percentiles_by_zoom()) {
    Json one{{"zoom", zoom}};
    one.update(to_json(percentiles));
    zooms.push_back(one);
  }
  return json;
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

Json machine() {
  utsname system{};
  uname(&system);
  return {{"processor", processor()},
          {"cores", std::thread::hardware_concurrency()},
          {"system", std::string(system.sysname) + " " + system.release + " " + system.machine}};
}

std::string now() {
  const std::time_t time = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
  return text;
}

}  // namespace

Percentiles percentiles_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {values.size(), quantile(values, 0.5), quantile(values, 0.95), quantile(values, 0.99),
          values.back()};
}

double Figure::tiles_per_second() const {
  std::vector<double> rates;
  for (const TileRun& run : runs_) {
    rates.push_back(static_cast<double>(run.tiles.size()) / run.seconds);
  }
  return percentiles_of(std::move(rates)).p50;
}

double Figure::best_tiles_per_second() const {
  double best = 0;
  for (const TileRun& run : runs_) {
    best = std::max(best, static_cast<double>(run.tiles.size()) / run.seconds);
  }
  return best;
}

double Figure::cpu_ms_per_tile() const {
  double least = HUGE_VAL;
  for (const TileRun& run : runs_) {
    least = std::min(least, 1000 * run.cpu_seconds / static_cast<double>(run.tiles.size()));
  }
  return least;
}

double Figure::bytes_per_tile() const {
  double bytes = 0;
  std::size_t tiles = 0;
  for (const TileRun& run : runs_) {
    for (const TileTime& tile : run.tiles) bytes += tile.bytes;
    tiles += run.tiles.size();
  }
  return tiles == 0 ? 0 : bytes / static_cast<double>(tiles);
}

Percentiles Figure::percentiles() const {
  std::vector<double> times;
  for (const TileRun& run : runs_) {
    for (const TileTime& tile : run.tiles) times.push_back(tile.ms);
  }
  return percentiles_of(std::move(times));
}

std::map<int, Percentiles> Figure::percentiles_by_zoom() const {
  std::map<int, std::vector<double>> times;
  for (const TileRun& run : runs_) {
    for (const TileTime& tile : run.tiles) times[tile.zoom].push_back(tile.ms);
  }
  std::map<int, Percentiles> percentiles;
  for (auto& [zoom, values] : times) percentiles[zoom] = percentiles_of(std::move(values));
  return percentiles;
}

void print_table_head() {
  std::printf("%-48s %7s %9s %9s %8s %8s %8s %8s %8s %8s\n", "", "tiles", "tiles/s", "best",
              "cpu ms", "bytes", "p50 ms", "p95 ms", "p99 ms", "max ms");
}

void print_line(const Figure& figure) {
  if (figure.has_runs()) {
    const Percentiles p = figure.percentiles();
    std::printf("%-48s %7zu %9.0f %9.0f %8.3f %8.0f %8.2f %8.2f %8.2f %8.2f\n",
                figure.name().c_str(), p.count, figure.tiles_per_second(),
                figure.best_tiles_per_second(), figure.cpu_ms_per_tile(), figure.bytes_per_tile(),
                p.p50, p.p95, p.p99, p.max);
  }
  if (!figure.note().empty()) {
    std::printf("%-48s %s\n", figure.name().c_str(), figure.note().c_str());
  }
  for (const auto& [what, value] : figure.values()) {
    std::printf("%-48s %-44s %8.4g\n", figure.name().c_str(), what.c_str(), value);
  }
  std::fflush(stdout);
}

void print_zooms(const Figure& figure) {
  for (const auto& [zoom, p] : figure.percentiles_by_zoom()) {
    std::printf("  zoom %2d %75zu %26.2f %8.2f %8.2f %8.2f\n", zoom, p.count, p.p50, p.p95, p.p99,
                p.max);
  }
  std::fflush(stdout);
}

void write_figures(const std::vector<Figure>& figures, const std::string& command,
                   const std::string& file) {
  const char* commit = std::getenv("TRAPEZE_COMMIT");
  Json json{{"machine", machine()},
            {"time", now()},
            {"commit", commit == nullptr ? "unknown" : commit},
            {"command", command},
            {"figures", Json::array()}};
  for (const Figure& figure : figures) json["figures"].push_back(to_json(figure));
  const std::filesystem::path path(file);
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  std::ofstream out(path);
  out << json.dump(1) << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}

std::string command_line(int argc, char** argv) {
  std::string text;
  for (int i = 0; i < argc; ++i) text += (i == 0 ? "" : " ") + std::string(argv[i]);
  return text;
}

}  // namespace trapeze
