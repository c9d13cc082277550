// Draws the tiles of a seeding that are not known without drawing, into a log.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "render/mask/mask.h"
#include "server/seed/job_painter.h"
#include "server/seed/seed_block.h"
#include "server/seed/seed_jobs.h"
#include "server/seed/seed_log.h"
#include "server/seed/seed_plan.h"

namespace trapeze {

/// What was done in this run.
struct SeedProgress {
  SeedFigures figures;
  std::uint64_t reused = 0;  // those of the drawn tiles that came from an earlier archive
  double cost = 0;           // of the finished jobs
};

/// Uses one thread for each renderer.
class Seeder {
 public:
  using Report = std::function<void(const SeedProgress&)>;

  /// `plan` and `jobs` must outlive it.
  Seeder(const SeedPlan& plan, const SeedJobs& jobs,
         std::vector<std::unique_ptr<MaskRenderer>> renderers,
         const std::shared_ptr<LabelBook>& labels, const JobPainter::FindKnown& find_known);

  /// Runs the jobs of the range that are missing in the log. `report` is called after each job, one
  /// call at a time. Throws the errors of drawing and of the log, and std::runtime_error if the
  /// file of a layer was overwritten.
  void seed(const JobRange& range, SeedLog& log, const Report& report);

  struct Estimate {
    SeedFigures figures;
    std::uint64_t reused = 0;  // see SeedProgress
    double bytes = 0;          // of distinct contents, without directories
    double seconds = 0;        // on all threads
  };
  /// Estimates the results for the jobs of the range: runs some of them for about that many
  /// seconds, and extrapolates to the others. If there is time to run all, the figures are exact.
  Estimate estimate(const JobRange& range, double seconds);

 private:
  const SeedPlan& plan_;
  const SeedJobs& jobs_;
  std::vector<JobPainter> painters_;  // one for each thread
};

}  // namespace trapeze
