#include "bench/experiment/race.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "render/mask/stopwatch.h"

namespace trapeze::experiment {
namespace {

constexpr int kEmptyViews = 15;
constexpr int kPlainlyDifferent = 64;  // 255ths

std::size_t heap_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

ViewCost median_by_total(std::vector<ViewCost> costs) {
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>((costs.size() - 1) / 2);
  std::nth_element(costs.begin(), middle, costs.end(), [](const ViewCost& a, const ViewCost& b) {
    return a.total_ms() < b.total_ms();
  });
  return *middle;
}

}  // namespace

Race::Race(const Map& map, Topology topology, Screen& screen, std::span<const Method> methods)
    : map_(map), screen_(screen) {
  cost_of_empty_view(map.layers.size(), screen);  // creates what all of them use
  for (const Method method : methods) {
    if (is_possible(method, topology, map)) prepare(method, topology);
  }
}

void Race::prepare(Method method, Topology topology) {
  Runner& runner = runners_.emplace_back();
  runner.result.method = method;
  runner.result.topology = topology;
  const std::size_t heap_before = heap_in_use();
  {
    const Stopwatch stopwatch(runner.result.prepare_ms);
    runner.contestant = make_contestant(method, topology, map_, screen_);
  }
  runner.result.memory =
      heap_in_use() - std::min(heap_before, heap_in_use()) + runner.contestant->shared_memory();
  runner.result.sent_before = runner.contestant->sent_before();
}

void Race::run(std::span<const ScaledView> trip, const RaceOptions& options) {
  std::vector<Mask> masks;
  for (Runner& runner : runners_) {
    runner.costs.resize(trip.size());
    runner.contestant->draw(trip.front(), masks);  // allocates memory, which no run should include
  }
  double spent = 0;
  double last_round = 0;
  for (int run = 0; run < options.runs && (run == 0 || spent + last_round <= options.seconds);
       ++run) {
    last_round = 0;
    for (Runner& runner : runners_) {
      const bool is_reference = is_for_reference(runner.result.method);
      if (run > 0 && is_reference) continue;
      const double seconds = run_once(runner, trip);
      spent += seconds;
      if (!is_reference) last_round += seconds;
    }
  }
}

double Race::run_once(Runner& runner, std::span<const ScaledView> trip) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Mask> masks;
  runner.contestant->start_run();
  for (std::size_t i = 0; i < trip.size(); ++i) {
    runner.costs[i].push_back(runner.contestant->draw(trip[i], masks));
  }
  ++runner.result.runs;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  runner.result.seconds += seconds;
  return seconds;
}

std::vector<RaceResult> Race::results() const {
  std::vector<RaceResult> results;
  for (const Runner& runner : runners_) {
    results.push_back(runner.result);
    for (const std::vector<ViewCost>& of_view : runner.costs) {
      results.back().views.push_back(median_by_total(of_view));
    }
  }
  return results;
}

bool Race::has(Method method) const {
  return std::any_of(runners_.begin(), runners_.end(),
                     [method](const Runner& runner) { return runner.result.method == method; });
}

std::vector<std::vector<Mask>> Race::pictures(Method method, std::span<const ScaledView> views) {
  std::vector<std::vector<Mask>> pictures;
  for (Runner& runner : runners_) {
    if (runner.result.method != method) continue;
    for (const ScaledView& view : views) {
      pictures.emplace_back();
      runner.contestant->draw(view, pictures.back());
    }
  }
  return pictures;
}

PictureError compare(std::span<const ScaledView> views, std::span<const std::vector<Mask>> pictures,
                     std::span<const std::vector<Mask>> full_detail) {
  PictureError error;
  error.scale = views.front().scale;
  std::uint64_t difference = 0;
  std::uint64_t plainly_different = 0;
  std::uint64_t covered = 0;
  std::uint64_t covered_in_full = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t layer = 0; layer < pictures[v].size(); ++layer) {
      const Mask& drawn = pictures[v][layer];
      const Mask& truth = full_detail[v][layer];
      for (int row = 0; row < drawn.height(); ++row) {
        std::uint64_t begin = 0;
        const auto add = [&](std::uint64_t end, int value, int true_value) {
          const std::uint64_t count = end - std::exchange(begin, end);
          if (value == 0 && true_value == 0) return;
          const auto off = static_cast<std::uint64_t>(std::abs(value - true_value));
          error.pixels += count;
          difference += count * off;
          plainly_different += off > kPlainlyDifferent ? count : 0;
          covered += count * static_cast<std::uint64_t>(value);
          covered_in_full += count * static_cast<std::uint64_t>(true_value);
        };
        for_each_run_of_both(drawn.row(row), truth.row(row), add);
      }
    }
  }
  if (error.pixels == 0) return error;
  const auto pixels = static_cast<double>(error.pixels);
  error.mean = static_cast<double>(difference) / pixels;
  error.share_over_64 = static_cast<double>(plainly_different) / pixels;
  error.area = static_cast<double>(covered) /
                   static_cast<double>(std::max<std::uint64_t>(1, covered_in_full)) -
               1;
  return error;
}

ViewCost cost_of_empty_view(std::size_t layers, Screen& screen) {
  DeviceTrapezoids nothing(screen);
  View view;
  view.width = kScreenWidth;
  view.height = kScreenHeight;
  std::vector<Mask> masks;
  std::vector<ViewCost> costs(kEmptyViews);
  for (ViewCost& cost : costs) {
    cost.add(nothing.draw(std::vector<std::uint32_t>(layers), view, masks));
  }
  return median_by_total(std::move(costs));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace trapeze::experiment
