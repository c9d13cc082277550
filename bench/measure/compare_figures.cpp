// Compares the figures of a run with stored ones, and reports which got worse.
//
//   compare_figures STORED RESULT ...           compares; worse figures are not a failure
//   compare_figures --store STORED RESULT ...   stores the results instead
//
// A RESULT is a JSON file of Google Benchmark, of which processor times are used, the shortest of
// repeated runs, or of one of our own benchmarks. A figure has got worse if it is more than
// --factor times as bad as the stored one; if the stored figures are from another machine, the
// factors mean little.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Json = nlohmann::ordered_json;

struct Figures {
  std::string machine;
  std::string commit;
  std::string time;
  std::map<std::string, double> values;
};

Json read_json(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::stringstream text;
  text << file.rdbuf();
  // Google Benchmark also writes numbers that JSON does not have, such as the variation of a
  // counter that is always 0.
  static const std::regex no_number(": -?(NaN|Infinity)");
  try {
    return Json::parse(std::regex_replace(text.str(), no_number, ": null"));
  } catch (const Json::parse_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

/// The values of a figure that are compared, if present.
constexpr const char* kKept[] = {"tiles_per_second", "cpu_ms_per_tile",      "p50_ms",
                                 "p99_ms",           "cached tiles, cpu us", "304, cpu us",
                                 "first, cpu us",    "seconds to ready"};

void add_own(const Json& json, Figures& figures) {
  const Json& machine = json.at("machine");
  figures.machine = machine.at("processor").get<std::string>() + ", " +
                    std::to_string(machine.at("cores").get<int>()) + " cores";
  figures.commit = json.at("commit");
  figures.time = json.at("time");
  for (const Json& figure : json.at("figures")) {
    for (const char* what : kKept) {
      if (!figure.contains(what)) continue;
      figures.values[figure.at("name").get<std::string>() + ": " + what] = figure.at(what);
    }
  }
}

void add_google(const Json& json, Figures& figures) {
  for (const Json& one : json.at("benchmarks")) {
    if (one.contains("error_occurred")) continue;
    const bool is_aggregate = one.at("run_type") == "aggregate";
    if (is_aggregate && one.at("aggregate_name") != "min") continue;
    const std::string name =
        one.at("run_name").get<std::string>() + ": cpu " + one.at("time_unit").get<std::string>();
    const double time = one.at("cpu_time");
    const auto [place, is_new] = figures.values.emplace(name, time);
    if (!is_new && time < place->second) place->second = time;
  }
}

Figures read_results(const std::vector<std::string>& paths) {
  Figures figures;
  for (const std::string& path : paths) {
    const Json json = read_json(path);
    if (json.contains("benchmarks")) {
      add_google(json, figures);
    } else {
      add_own(json, figures);
    }
  }
  return figures;
}

Figures read_stored(const std::string& path) {
  const Json json = read_json(path);
  Figures figures{json.at("machine"), json.at("commit"), json.at("time"), {}};
  for (const auto& [name, value] : json.at("figures").items()) figures.values[name] = value;
  return figures;
}

void store(const Figures& figures, const std::string& path) {
  const Json json{{"machine", figures.machine},
                  {"commit", figures.commit},
                  {"time", figures.time},
                  {"figures", figures.values}};
  std::ofstream file(path);
  file << json.dump(1) << '\n';
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
  std::printf("stored %zu figures in %s\n", figures.values.size(), path.c_str());
}

bool is_better_if_larger(const std::string& name) {
  return name.ends_with("per_second");
}

/// How many times as bad as before.
double worsening(const std::string& name, double before, double now) {
  return is_better_if_larger(name) ? before / now : now / before;
}

void compare(const Figures& stored, const Figures& now, double factor) {
  std::size_t compared = 0;
  std::size_t without = 0;
  std::vector<std::pair<double, std::string>> worse;
  for (const auto& [name, value] : now.values) {
    const auto before = stored.values.find(name);
    if (before == stored.values.end()) ++without;
    if (before == stored.values.end() || before->second <= 0 || value <= 0) continue;
    ++compared;
    const double times = worsening(name, before->second, value);
    if (times > factor) worse.emplace_back(times, name);
  }
  std::printf("%zu figures against those of %s, commit %s, on %s\n", compared, stored.time.c_str(),
              stored.commit.c_str(), stored.machine.c_str());
  if (without > 0) std::printf("%zu figures are compared with nothing: none are stored\n", without);
  if (!now.machine.empty() && now.machine != stored.machine) {
    std::printf("this is another machine: %s\n", now.machine.c_str());
  }
  std::sort(worse.rbegin(), worse.rend());
  std::printf("%zu got worse by more than %.2f\n", worse.size(), factor);
  for (const auto& [times, name] : worse) {
    std::printf("  %6.2f times as bad   %s: %.4g, was %.4g\n", times, name.c_str(),
                now.values.at(name), stored.values.at(name));
  }
}

int run(int argc, char** argv) {
  std::string stored;
  std::vector<std::string> results;
  bool is_to_store = false;
  double factor = 1.25;
  CLI::App app("Compares figures of benchmarks with stored ones");
  app.add_option("STORED", stored, "The stored figures (JSON)")->required();
  app.add_option("RESULT", results, "What benchmarks wrote (JSON)")->required();
  app.add_flag("--store", is_to_store, "Store the results instead of comparing them");
  app.add_option("--factor", factor, "What is more than so many times as bad has got worse")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const Figures now = read_results(results);
  if (is_to_store) {
    store(now, stored);
  } else {
    compare(read_stored(stored), now, factor);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_figures: %s\n", error.what());
    return 1;
  }
}
