// The commands of the program, one function each. They return the exit status and throw
// std::exception for what main reports: a file, a port, a renderer that does not work.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace trapeze {

/// What the command line says; unset means: as configured.
struct ServeArguments {
  std::string config;
  std::optional<std::uint16_t> port;
  std::optional<std::string> address;
  std::optional<unsigned> threads;
  std::optional<unsigned> workers;
  std::optional<std::string> renderer;
  std::optional<std::string> device;
  std::optional<std::string> web_root;
  std::vector<std::string> files;  // instead of the layers of the configuration
};
int run_serve(const ServeArguments& arguments);

struct CheckArguments {
  std::vector<std::string> files;
};
int run_check(const CheckArguments& arguments);

struct PrepareArguments {
  std::vector<std::string> files;
  std::string output;  // a folder, made if it is not there
  std::string weights = "douglas-peucker";
};
int run_prepare(const PrepareArguments& arguments);

struct ExportArguments {
  std::string file;
  int zoom = 0;
  double simplify = 0.25;  // pixels, as tiles are drawn
  std::string topology = "strict";
  std::string weights = "douglas-peucker";
  std::string crs = "EPSG:4326";
  bool overwrite = false;
  std::string output;
};
int run_export(const ExportArguments& arguments);

struct RenderArguments {
  std::vector<std::string> files;  // bottom first
  std::string tile;                // Z/X/Y
  int scale = 1;
  std::string style;  // a query string
  std::string renderer = "auto";
  std::string device;
  std::string output;
};
int run_render(const RenderArguments& arguments);

struct BenchArguments {
  std::string name;
  std::vector<std::string> options;  // for the benchmark
};
/// Becomes the program trapeze-NAME: benchmarks need libraries that whoever serves does not. Returns
/// never.
int run_bench(const BenchArguments& arguments);

}  // namespace trapeze
