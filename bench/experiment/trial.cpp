#include "bench/experiment/trial.h"

#include <malloc.h>

#include <algorithm>

#include "bench/experiment/stopwatch.h"

namespace trapeze::experiment {
namespace {

constexpr int kEmptyViews = 15;

std::size_t heap_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

ViewCost median_by_total(std::vector<ViewCost> costs) {
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::nth_element(costs.begin(), middle, costs.end(), [](const ViewCost& a, const ViewCost& b) {
    return a.total_ms() < b.total_ms();
  });
  return *middle;
}

}  // namespace

TrialResult run_trial(Method method, Topology topology, const Map& map,
                      std::span<const ScaledView> trip, int runs, Screen& screen) {
  TrialResult result;
  result.method = method;
  result.topology = topology;
  const std::size_t heap_before = heap_in_use();
  Stopwatch stopwatch;
  const std::unique_ptr<Contestant> contestant = make_contestant(method, topology, map, screen);
  result.prepare_ms = stopwatch.lap_ms();
  result.sent_before = contestant->sent_before();

  std::vector<Coverage> coverages;
  std::vector<std::vector<ViewCost>> costs(trip.size());
  // The first view of all makes room and compiles; no run should pay for it.
  contestant->draw(trip.front(), coverages);
  for (int run = 0; run < runs; ++run) {
    contestant->start_run();
    for (std::size_t i = 0; i < trip.size(); ++i) {
      costs[i].push_back(contestant->draw(trip[i], coverages));
    }
  }
  coverages = {};
  result.memory = heap_in_use() - heap_before + contestant->shared_memory();
  for (std::vector<ViewCost>& of_view : costs) {
    result.views.push_back(median_by_total(std::move(of_view)));
  }
  return result;
}

double empty_view_ms(std::size_t layers, Screen& screen) {
  DeviceTrapezoids nothing(screen);
  View view;
  view.width = kScreenWidth;
  view.height = kScreenHeight;
  Coverage coverage;
  std::vector<double> times;
  for (int i = 0; i < kEmptyViews; ++i) {
    Stopwatch stopwatch;
    for (std::size_t layer = 0; layer < layers; ++layer) nothing.draw(0, view, coverage);
    times.push_back(stopwatch.lap_ms());
  }
  return median(std::move(times));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace trapeze::experiment
