#include "render/picture/past_runs.h"

#include <algorithm>

namespace trapeze {
namespace {

constexpr std::size_t kMostRuns = std::size_t{1} << 17;  // more than a Deflate window contains

}  // namespace

void PastRuns::begin(std::uint32_t bytes_per_pixel) {
  bytes_per_pixel_ = bytes_per_pixel;
  forget();
}

void PastRuns::forget() {
  runs_.clear();
  first_of_row_ = passed_ = 0;
  of_one_.fill(kNone);
  of_two_.fill(kNone);
}

void PastRuns::add_row(std::span<const PixelRun> runs, std::uint32_t first_byte) {
  if (runs_.size() > kMostRuns) forget();
  pass(runs_.size() - first_of_row_);
  first_of_row_ = runs_.size();
  std::uint32_t begin = 0;
  for (const PixelRun& run : runs) {
    runs_.push_back({first_byte + begin * bytes_per_pixel_, run.end - begin, run.pixel});
    begin = run.end;
  }
}

void PastRuns::pass(std::size_t run) {
  for (; passed_ < first_of_row_ + run; ++passed_) {
    const auto number = static_cast<std::uint32_t>(passed_);
    const std::uint32_t pixel = runs_[passed_].pixel;
    of_one_[slot_of(pixel)] = number;
    if (goes_on(passed_)) of_two_[slot_of(pixel, runs_[passed_ + 1].pixel)] = number;
  }
}

std::array<PastRuns::Match, 2> PastRuns::find(std::size_t run) const {
  const std::size_t here = first_of_row_ + run;
  const std::uint32_t pixel = runs_[here].pixel;
  std::array<Match, 2> matches;
  const std::uint32_t one = of_one_[slot_of(pixel)];
  if (one != kNone) matches[0] = match(one, here);
  if (!goes_on(here)) return matches;
  const std::uint32_t two = of_two_[slot_of(pixel, runs_[here + 1].pixel)];
  if (two != kNone && two != one) matches[1] = match(two, here);
  return matches;
}

/// Whether another run of the same row follows.
bool PastRuns::goes_on(std::size_t run) const {
  if (run + 1 >= runs_.size()) return false;
  const Past& past = runs_[run];
  return runs_[run + 1].begin == past.begin + past.pixels * bytes_per_pixel_;
}

// Either both runs end together, or the past one is shorter and the match ends with it.
PastRuns::Match PastRuns::match(std::size_t past, std::size_t here) const {
  const Past& before = runs_[past];
  const Past& run = runs_[here];
  if (before.pixel != run.pixel) return {};
  const std::uint32_t common = std::min(before.pixels, run.pixels);
  const std::uint32_t place = before.begin + (before.pixels - common) * bytes_per_pixel_;
  Match match{run.begin - place, common, 1, common > 1 ? 1u : 0u};
  bool ends_together = common == run.pixels;
  while (ends_together && goes_on(past) && goes_on(here) &&
         runs_[past + 1].pixel == runs_[here + 1].pixel) {
    const std::uint32_t more = std::min(runs_[++past].pixels, runs_[++here].pixels);
    match.pixels += more;
    match.runs += 1;
    match.repeats += more > 1 ? 1 : 0;
    ends_together = runs_[past].pixels == runs_[here].pixels;
  }
  return match;
}

}  // namespace trapeze
