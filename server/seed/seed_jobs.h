// The work of a seeding, divided into jobs of about equal cost. The division depends only on the
// plan, so that all participants have the same jobs.
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

/// A tile, alone or with all tiles below it.
struct SeedUnit {
  TileId tile;
  bool is_subtree = false;
};

/// Consecutive units.
struct SeedJob {
  std::size_t first_unit = 0;
  std::size_t end_unit = 0;
  double cost = 0;   // approximate, in units of drawing_cost()
  double tiles = 0;  // to be drawn, approximate
};

/// A range of jobs.
struct JobRange {
  std::size_t first = 0;
  std::size_t end = 0;
};

struct SeedJobs {
  /// Contains each wanted tile once. A tile comes before those below it, and its four children are
  /// in the order of the curve, so the tiles of every zoom are in order.
  std::vector<SeedUnit> units;
  std::vector<SeedJob> jobs;

  std::span<const SeedUnit> units_of(const SeedJob& job) const {
    return std::span(units).subspan(job.first_unit, job.end_unit - job.first_unit);
  }
  double cost(const JobRange& range) const;
  double tiles(const JobRange& range) const;
};

/// The maximum number of tiles to draw in one job, unless a single unit has more: they are kept in
/// memory until the job is done, and drawn again if it is interrupted.
constexpr double kTilesOfJob = 256;

SeedJobs divide_into_jobs(const SeedPlan& plan, KnownTiles& known,
                          double tiles_of_job = kTilesOfJob);

/// One of several parts, numbered from 1.
struct SeedPart {
  std::size_t number = 1;
  std::size_t count = 1;
};
/// Parses "I/N" with 1 <= I <= N; nothing for other text.
std::optional<SeedPart> parse_part(std::string_view text);

/// The jobs of a part: parts have about equal costs, and each job belongs to exactly one of them.
JobRange jobs_of_part(const SeedJobs& jobs, const SeedPart& part);

}  // namespace trapeze
