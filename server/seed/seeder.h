// Draws the tiles of a seeding, as far as they are not known without, into a log.
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

/// What has been done in this run.
struct SeedProgress {
  SeedFigures figures;
  std::uint64_t reused = 0;  // of those drawn, the ones that were known from before
  double cost = 0;           // of the jobs that are done
};

/// Works with one thread for each renderer.
class Seeder {
 public:
  using Report = std::function<void(const SeedProgress&)>;

  /// `plan` and `jobs` must outlive it.
  Seeder(const SeedPlan& plan, const SeedJobs& jobs,
         std::vector<std::unique_ptr<MaskRenderer>> renderers,
         const std::shared_ptr<LabelBook>& labels, const JobPainter::FindKnown& find_known);

  /// Does the jobs of the range that the log has not got. `report` is called after each, one call
  /// at a time. Throws what drawing and the log throw, and std::runtime_error if the file of a
  /// layer was written into.
  void seed(const JobRange& range, SeedLog& log, const Report& report);

  struct Estimate {
    SeedFigures figures;
    double bytes = 0;    // of different contents, directories left out
    double seconds = 0;  // on all threads
  };
  /// What the jobs of the range would come to: some of them are done for about so many seconds, and
  /// the others are taken to be like them. With time enough for all, the figures are exact.
  Estimate estimate(const JobRange& range, double seconds);

 private:
  const SeedPlan& plan_;
  const SeedJobs& jobs_;
  std::vector<JobPainter> painters_;  // one for each thread
};

}  // namespace trapeze
