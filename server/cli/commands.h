// The commands of the program, one function each. They return the exit status: 0 if all is done, 1
// if something failed or was found wrong. For what main reports they throw UsageError, which ends
// with 2, or another std::exception, which ends with 1: a file, a port or a renderer that does not
// work.
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
  std::vector<ConfigOverride> settings;  // of the command line; they override all others
  std::vector<std::string> files;        // instead of the layers of the configuration
  CoverageArguments coverage;            // of all layers; empty: as they are configured
  std::optional<SkipLimit> max_skipped;  // of all layers; unset: as they are configured
  bool is_verbose = false;               // whatever log.level says
};
/// What is configured by the file, the environment and the command line. Throws if anything is
/// wrong with it: UsageError if that is only the command line.
LoadedConfig load_serve_config(const ServeArguments& arguments);
/// The same for who draws: there are layers, and none is drawn beyond the last zoom that is
/// answered. Throws as load_serve_config().
Config configure(const ServeArguments& arguments);
int run_serve(const ServeArguments& arguments);

/// Prints all that is wrong with a configuration and the environment; 1 if a server would not
/// start.
int run_config_check(const std::string& path);
/// Prints what is configured, with the origin of each value.
int run_config_print(const ServeArguments& arguments);
int run_config_schema();

struct CheckArguments {
  std::vector<std::string> files;
  CoverageArguments coverage;
  SkipLimit max_skipped;  // of each file
  std::string list;       // a file for the gaps and overlaps of the one of `files`; may be empty
  bool overwrite = false;
};
int run_check(const CheckArguments& arguments);

struct PrepareArguments {
  std::vector<std::string> files;
  std::string output;  // a folder, made if it is not there; of an overview, perhaps its file
  std::string reuse;   // a prepared file, or a folder of them; empty: nothing is taken over
  std::string weights{kWeightNames.name_of(WeightRule::douglas_peucker)};
  CoverageArguments coverage;
  SourceSelection selection;      // of each file
  SkipLimit max_skipped;          // of each file, or each part of one
  std::string part;               // I/N, or A-B/N; empty: files are not divided
  std::vector<std::string> join;  // parts, of which an overview is made, and nothing else is done
  std::vector<std::string> crs;   // systems to prepare for besides Web Mercator
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
  double simplify = kTolerancePixels;  // pixels, as tiles are drawn
  double smooth = 0;                   // pixels
  double grow = 0;                     // pixels; not beside smooth
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
  ServeArguments serve;             // layers, and what draws them
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
  std::vector<std::string> join;  // parts, of which an archive is made, and nothing else is done
  std::string jobs;  // a name of kBatchSystemNames: they are printed, and nothing else is done
  int parts = 0;     // of these jobs; 0: not said
  std::vector<std::string> words;  // of the command line, after "seed"
};
int run_seed(const SeedArguments& arguments);

struct BenchArguments {
  std::string name;
  std::vector<std::string> options;  // for the benchmark
};
/// Replaces the process by the program trapeze-NAME, as benchmarks need libraries that a server
/// does not. Does not return.
int run_bench(const BenchArguments& arguments);

}  // namespace trapeze
