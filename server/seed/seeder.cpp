#include "server/seed/seeder.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/grid/for_each_in_parallel.h"

namespace trapeze {
namespace {

using Clock = std::chrono::steady_clock;

/// The layers that are drawn or labelled at any of the zooms.
std::set<std::size_t> layers_of(const SeedPlan& plan) {
  std::set<std::size_t> layers;
  for (int zoom = plan.zooms().first; zoom <= plan.zooms().last; ++zoom) {
    for (const LayerPaint& paint : plan.at(zoom).layers) layers.insert(paint.layer);
    for (const LabelledLayer& labelled : plan.at(zoom).labels) layers.insert(labelled.layer);
  }
  return layers;
}

/// Tiles drawn while their file was overwritten may contain anything.
void refuse_damaged(const SeedPlan& plan) {
  const Dataset& dataset = *plan.at(plan.zooms().last).dataset;
  for (const std::size_t number : layers_of(plan)) {
    const ServedLayer& layer = dataset.layers_on_all_grids()[number];
    if (layer.is_whole()) continue;
    throw std::runtime_error(fmt::format(
        "{} was modified while it was read; run `trapeze prepare` again", layer.report.path));
  }
}

/// A permutation of `count` items in which every initial section is spread over all items.
std::vector<std::size_t> spread(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto mixed = [](std::size_t i) { return i * 0x9e3779b97f4a7c15; };
  std::ranges::sort(order, {}, mixed);
  return order;
}

}  // namespace

Seeder::Seeder(const SeedPlan& plan, const SeedJobs& jobs,
               std::vector<std::unique_ptr<MaskRenderer>> renderers,
               const std::shared_ptr<LabelBook>& labels, const JobPainter::FindKnown& find_known)
    : plan_(plan), jobs_(jobs) {
  const auto classes = TilePainter::new_class_cache();
  for (auto& renderer : renderers) {
    painters_.emplace_back(plan,
                           TilePainter(std::move(renderer), classes, labels->usual_fonts(), labels),
                           classes, labels, find_known);
  }
}

void Seeder::seed(const JobRange& range, SeedLog& log, const Report& report) {
  std::vector<std::size_t> left;
  for (std::size_t job = range.first; job < range.end; ++job) {
    if (!log.done().contains(job)) left.push_back(job);
  }
  std::mutex mutex;  // guards everything below
  SeedProgress progress;
  std::size_t next = 0;
  bool has_failed = false;
  const auto take = [&]() -> std::optional<std::size_t> {
    const std::lock_guard lock(mutex);
    if (next == left.size() || has_failed) return std::nullopt;
    return left[next++];
  };
  const auto work = [&](JobPainter& painter) {
    while (const auto job = take()) {
      const std::uint64_t reused = painter.reused();
      const SeedBlockBuilder block = painter.paint(jobs_.units_of(jobs_.jobs[*job]));
      refuse_damaged(plan_);
      log.append(block.bytes(*job));
      const std::lock_guard lock(mutex);
      progress.figures.add(block.figures);
      progress.reused += painter.reused() - reused;
      progress.cost += jobs_.jobs[*job].cost;
      report(progress);
    }
  };
  for_each_in_parallel(painters_.size(), painters_.size(), [&](std::size_t thread) {
    try {
      work(painters_[thread]);
    } catch (...) {
      const std::lock_guard lock(mutex);
      has_failed = true;
      throw;
    }
  });
  log.sync();
}

// Extrapolates by cost. Jobs that draw nothing are run as well, but cost about nothing, so they do
// not distort the factor for the others.
Seeder::Estimate Seeder::estimate(const JobRange& range, double seconds) {
  const auto order = spread(range.end - range.first);
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  std::mutex mutex;  // guards everything below
  std::size_t next = 0;
  double cost = 0;
  Estimate sum;
  for_each_in_parallel(painters_.size(), painters_.size(), [&](std::size_t thread) {
    while (true) {
      std::size_t job = range.first;
      {
        const std::lock_guard lock(mutex);
        if (next == order.size() || Clock::now() > end) return;
        job += order[next++];
      }
      const auto begin = Clock::now();
      const std::uint64_t reused = painters_[thread].reused();
      const SeedBlockBuilder block = painters_[thread].paint(jobs_.units_of(jobs_.jobs[job]));
      const double took = std::chrono::duration<double>(Clock::now() - begin).count();
      const std::lock_guard lock(mutex);
      sum.figures.add(block.figures);
      sum.reused += painters_[thread].reused() - reused;
      sum.bytes += static_cast<double>(block.bytes(job).size());
      sum.seconds += took;
      cost += jobs_.jobs[job].cost;
    }
  });
  const double factor = next == order.size() ? 1 : jobs_.cost(range) / std::max(cost, 1.0);
  const auto scaled = [factor](std::uint64_t count) {
    return static_cast<std::uint64_t>(static_cast<double>(count) * factor);
  };
  sum.figures.drawn = scaled(sum.figures.drawn);
  sum.figures.alone = scaled(sum.figures.alone);
  sum.reused = scaled(sum.reused);
  sum.bytes *= factor;
  sum.seconds *= factor / static_cast<double>(painters_.size());
  return sum;
}

}  // namespace trapeze
