#include "server/seed/seed_jobs.h"

#include <algorithm>
#include <charconv>

#include "server/seed/hilbert_order.h"
#include "server/tiles/drawing_cost.h"

namespace trapeze {
namespace {

class Division {
 public:
  Division(const SeedPlan& plan, KnownTiles& known, double tiles_of_job)
      : plan_(plan), known_(known), tiles_of_job_(tiles_of_job) {
    const double side = kTilePixels * plan.at(plan.zooms().last).scale;
    cost_of_tile_ = side * side / static_cast<double>(kPixelsPerSide);
  }

  SeedJobs divide() {
    visit({0, 0, 0});
    end_job();
    return std::move(jobs_);
  }

 private:
  void visit(const TileId& tile) {
    if (!plan_.meets(tile)) return;
    known_.look_at(tile);
    const auto estimate = known_.estimate();
    const bool is_last = tile.z == plan_.zooms().last;
    const bool is_small = estimate && (estimate->tiles <= tiles_of_job_ || known_.is_known());
    if (is_last || is_small) {
      add({tile, true}, estimate.value_or(KnownTiles::Estimate{1, 0}));
      return;
    }
    if (tile.z >= plan_.zooms().first) add({tile, false}, {1, 0});
    for (const TileId& child : children_in_order(tile)) visit(child);
  }

  void add(const SeedUnit& unit, const KnownTiles::Estimate& estimate) {
    if (job_.tiles + estimate.tiles > tiles_of_job_) end_job();
    jobs_.units.push_back(unit);
    job_.end_unit = jobs_.units.size();
    job_.tiles += estimate.tiles;
    job_.cost += cost_of_tile_ * estimate.tiles + estimate.trapezoids;
  }

  void end_job() {
    if (job_.end_unit > job_.first_unit) jobs_.jobs.push_back(job_);
    job_ = {jobs_.units.size(), jobs_.units.size(), 0, 0};
  }

  const SeedPlan& plan_;
  KnownTiles& known_;
  const double tiles_of_job_;
  double cost_of_tile_ = 0;
  SeedJobs jobs_;
  SeedJob job_;
};

/// The number, 1 or greater, that the text consists of; nothing if it is not one.
std::optional<std::size_t> number_in(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && number > 0;
  return is_number ? std::optional(number) : std::nullopt;
}

}  // namespace

double SeedJobs::cost(const JobRange& range) const {
  double cost = 0;
  for (std::size_t i = range.first; i < range.end; ++i) cost += jobs[i].cost;
  return cost;
}

double SeedJobs::tiles(const JobRange& range) const {
  double tiles = 0;
  for (std::size_t i = range.first; i < range.end; ++i) tiles += jobs[i].tiles;
  return tiles;
}

SeedJobs divide_into_jobs(const SeedPlan& plan, KnownTiles& known, double tiles_of_job) {
  return Division(plan, known, tiles_of_job).divide();
}

std::optional<SeedPart> parse_part(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto number = number_in(text.substr(0, slash));
  const auto count = number_in(text.substr(slash + 1));
  if (!number || !count || *number > *count) return std::nullopt;
  return SeedPart{*number, *count};
}

JobRange jobs_of_part(const SeedJobs& jobs, const SeedPart& part) {
  const double total = jobs.cost({0, jobs.jobs.size()});
  const auto ends_at = [&](std::size_t number) {
    const double until = total * static_cast<double>(number) / static_cast<double>(part.count);
    double cost = 0;
    std::size_t end = 0;
    while (end < jobs.jobs.size() && cost + jobs.jobs[end].cost / 2 <= until) {
      cost += jobs.jobs[end++].cost;
    }
    return end;
  };
  return {part.number == 1 ? 0 : ends_at(part.number - 1),
          part.number == part.count ? jobs.jobs.size() : ends_at(part.number)};
}

}  // namespace trapeze
