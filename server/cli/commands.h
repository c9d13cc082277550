// The commands of the program, one function each. They return the exit status: 0 on success, 1 if
// something failed or problems were found. Errors that main reports are thrown: as UsageError,
// which gives status 2, or as another std::exception, which gives status 1, for a file, a port or a
// renderer that does not work.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/changes/changed_tiles.h"
#include "server/changes/tile_list.h"
#include "server/cli/option_values.h"
#include "server/config/load_config.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

struct ServeArguments {
  std::string config;                    // may be empty
  std::vector<ConfigOverride> settings;  // from the command line; they override all others
  std::vector<std::string> files;        // replace the layers of the configuration
  CoverageArguments coverage;            // for all layers; empty: as configured
  std::optional<SkipLimit> max_skipped;  // for all layers; unset: as configured
  bool is_verbose = false;               // overrides log.level
};
/// The configuration from the file, the environment and the command line. Throws if anything is
/// wrong with it: UsageError if only the command line is wrong.
LoadedConfig load_serve_config(const ServeArguments& arguments);
/// The same for commands that draw: there must be layers, and their zooms are limited to the last
/// zoom the server answers. Throws as load_serve_config() does.
Config configure(const ServeArguments& arguments);
int run_serve(const ServeArguments& arguments);

/// Prints all problems of a configuration and the environment; returns 1 if a server would not
/// start.
int run_config_check(const std::string& path);
/// Prints the configuration, with the origin of each value.
int run_config_print(const ServeArguments& arguments);
int run_config_schema();

struct CheckArguments {
  std::vector<std::string> files;
  CoverageArguments coverage;
  SkipLimit max_skipped;  // for each file
  std::string list;       // a file for gaps and overlaps of the single input file; may be empty
  bool overwrite = false;
};
int run_check(const CheckArguments& arguments);

struct PrepareArguments {
  std::vector<std::string> files;
  std::string output;  // a folder, created if missing; for an overview, optionally its file
  std::string reuse;   // a prepared file, or a folder of them; empty: nothing is reused
  std::string weights{kWeightNames.name_of(WeightRule::douglas_peucker)};
  CoverageArguments coverage;
  SourceSelection selection;      // from each file
  SkipLimit max_skipped;          // for each file, or each part of one
  std::string part;               // I/N, or A-B/N; empty: files are not divided
  std::vector<std::string> join;  // parts to create an overview of, without doing anything else
  std::vector<std::string> crs;   // reference systems to prepare for in addition to Web Mercator
};
int run_prepare(const PrepareArguments& arguments);

struct DiffArguments {
  std::string before;  // files of the layer's two states
  std::string after;
  std::string zooms;
  std::string style;  // a query string
  int scale = 1;
  CoverageArguments coverage;
  std::string certainty{kCertaintyNames.name_of(Certainty::fingerprints)};
  std::string format{kTileListNames.name_of(TileListFormat::text)};
};
int run_diff(const DiffArguments& arguments);

struct ExportArguments {
  std::string file;
  int zoom = 0;
  double simplify = kTolerancePixels;  // pixels, as for tiles
  double smooth = 0;                   // pixels
  double grow = 0;                     // pixels; not together with smooth
  std::string topology{kTopologyNames.name_of(Topology::strict)};
  std::string weights{kWeightNames.name_of(WeightRule::douglas_peucker)};
  CoverageArguments coverage;
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
  CoverageArguments coverage;
  std::string renderer = "auto";
  std::string device;
  std::string output;
};
int run_render(const RenderArguments& arguments);

struct SeedArguments {
  ServeArguments serve;             // layers and renderers
  std::vector<std::string> layers;  // bottom first; empty: all
  std::string style;                // a query string
  std::string zooms;
  std::string bbox;  // W,S,E,N; may be empty
  int scale = 1;
  std::string format{kTileFormatNames.name_of(TileFormat::png)};
  std::string output;
  bool is_sparse = false;
  bool is_dry_run = false;
  std::string part;               // I/N; empty: all
  std::string update;             // an archive; may be empty
  std::vector<std::string> join;  // parts to join into an archive, without doing anything else
  std::string jobs;  // a name of kBatchSystemNames: jobs are printed, and nothing else is done
  int parts = 0;     // number of these jobs; 0: not given
  std::vector<std::string> words;  // of the command line, after "seed"
};
int run_seed(const SeedArguments& arguments);

struct BenchArguments {
  std::string name;
  std::vector<std::string> options;  // for the benchmark
};
/// Replaces the process by the program trapeze-NAME, since benchmarks need libraries that a server
/// does not. Does not return.
int run_bench(const BenchArguments& arguments);

}  // namespace trapeze
