// Results of benchmarks of whole servers, as a table for people and as JSON for storage.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace trapeze {

struct TileTime {
  int zoom = 0;
  double ms = 0;
  double bytes = 0;  // of the image; 0: not counted
};

/// One run over a list of tiles.
struct TileRun {
  double seconds = 0;      // wall time
  double cpu_seconds = 0;  // processor time of the drawing processes
  std::vector<TileTime> tiles;
};

struct Percentiles {
  std::size_t count = 0;
  double p50 = 0;
  double p95 = 0;
  double p99 = 0;
  double max = 0;
};

Percentiles percentiles_of(std::vector<double> values);

/// The figures of one measurement: several runs over the same tiles, or single values.
class Figure {
 public:
  /// The name is for example "malta/trapeze-egl/cold".
  explicit Figure(std::string name) : name_(std::move(name)) {}

  void add(TileRun run) { runs_.push_back(std::move(run)); }
  void set(const std::string& what, double value) { values_[what] = value; }
  void note(std::string text) { note_ = std::move(text); }

  const std::string& name() const { return name_; }
  const std::string& note() const { return note_; }
  bool has_runs() const { return !runs_.empty(); }
  const std::map<std::string, double>& values() const { return values_; }

  /// Of the median run, which is least affected by other load on the machine.
  double tiles_per_second() const;
  double best_tiles_per_second() const;
  /// Processor time per tile of the run that used the least.
  double cpu_ms_per_tile() const;
  /// The mean.
  double bytes_per_tile() const;
  /// Over the tiles of all runs.
  Percentiles percentiles() const;
  std::map<int, Percentiles> percentiles_by_zoom() const;

 private:
  std::string name_;
  std::string note_;
  std::vector<TileRun> runs_;
  std::map<std::string, double> values_;
};

/// Print the head of the table, and a line for each figure, to standard output.
void print_table_head();
void print_line(const Figure& figure);
void print_zooms(const Figure& figure);

/// Writes the figures with the machine, the time, the commit (from the variable TRAPEZE_COMMIT) and
/// the command; creates the folder. Throws std::runtime_error if the file cannot be written.
void write_figures(const std::vector<Figure>& figures, const std::string& command,
                   const std::string& file);

/// The words of the command line.
std::string command_line(int argc, char** argv);

}  // namespace trapeze
