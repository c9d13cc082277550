// All results of the experiment, as JSON.
#pragma once

#include <string>
#include <vector>

#include "bench/experiment/growth.h"
#include "bench/experiment/quality.h"
#include "bench/experiment/race.h"
#include "bench/experiment/trip.h"

namespace trapeze::experiment {

/// For one method and setting of topology, over the scales of Figure 7.
struct PictureErrors {
  Method method = Method::lifespans;
  Topology topology = Topology::strict;
  std::vector<PictureError> scales;
};

/// The time spent on a map, in seconds.
struct MapSeconds {
  double load = 0;
  double races = 0;
  double quality = 0;
  double figures = 0;
};

struct MapReport {
  MapSource source;
  MapSeconds seconds;
  std::vector<std::size_t> layer_polygons;
  std::vector<std::size_t> layer_vertices;
  std::vector<double> trip_scales;      // by view
  std::vector<double> trip_tolerances;  // by view, pixels
  ViewCost empty_view;
  std::vector<RaceResult> races;
  std::vector<PictureErrors> pictures;
  std::vector<Quality> quality;
  std::vector<std::string> figures;  // file names
};

struct Report {
  std::string commit;
  std::string machine;
  std::string device;
  TripOptions options;
  int runs = 0;                // maximum
  double seconds_of_runs = 0;  // no run starts after that
  double seconds = 0;
  double growth_seconds = 0;
  std::vector<MapReport> maps;
  std::vector<GrowthPoint> growth;
};

/// The processor, the number of cores, and the memory of this machine.
std::string describe_machine();

/// Writes the report. Throws std::runtime_error if the file cannot be written.
void write_report(const Report& report, const std::string& path);

/// A short table for the terminal.
std::string summary_of(const MapReport& map);

}  // namespace trapeze::experiment
