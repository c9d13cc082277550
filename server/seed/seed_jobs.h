// The work of a seeding, cut into jobs of about equal cost. How it is cut depends on nothing but
// the plan, so that whoever takes part in it has the same jobs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/grid/web_mercator.h"
#include "server/seed/known_tiles.h"
#include "server/seed/seed_plan.h"

namespace trapeze {

/// A tile, alone or with all that lie below it.
struct SeedUnit {
  TileId tile;
  bool is_subtree = false;
};

/// Units that follow each other.
struct SeedJob {
  std::size_t first_unit = 0;
  std::size_t end_unit = 0;
  double cost = 0;   // as drawing_cost() counts, about
  double tiles = 0;  // to be drawn, about
};

/// Jobs from one to another.
struct JobRange {
  std::size_t first = 0;
  std::size_t end = 0;
};

struct SeedJobs {
  /// Each tile that is wanted once; each before those below it, and the four below one in the order
  /// of the curve. So the tiles of every zoom are in order.
  std::vector<SeedUnit> units;
  std::vector<SeedJob> jobs;

  std::span<const SeedUnit> units_of(const SeedJob& job) const {
    return std::span(units).subspan(job.first_unit, job.end_unit - job.first_unit);
  }
  double cost(const JobRange& range) const;
  double tiles(const JobRange& range) const;
};

/// Tiles to be drawn in one job, at most, unless there are more in one unit: they are kept in
/// memory until it is done, and drawn again if it is interrupted.
constexpr double kTilesOfJob = 256;

SeedJobs divide_into_jobs(const SeedPlan& plan, KnownTiles& known,
                          double tiles_of_job = kTilesOfJob);

/// One of several parts, counted from 1.
struct SeedPart {
  std::size_t number = 1;
  std::size_t count = 1;
};
/// "I/N" with 1 <= I <= N; nothing if it is something else.
std::optional<SeedPart> parse_part(std::string_view text);

/// The jobs of a part: parts have about equal costs, and each job belongs to one of them.
JobRange jobs_of_part(const SeedJobs& jobs, const SeedPart& part);

}  // namespace trapeze
