#include "server/data/load_progress.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/io/source/source_name.h"

namespace trapeze {
namespace {

constexpr auto kBarInterval = std::chrono::milliseconds(100);
constexpr auto kLineInterval = std::chrono::seconds(5);
constexpr std::size_t kBarWidth = 40;
constexpr std::size_t kUsualColumns = 80;

std::size_t columns_of_terminal() {
  winsize size = {};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kUsualColumns;
  return size.ws_col;
}

/// The end of a name, in at most that many bytes, which begins with "..." if it is not all of it.
std::string end_of_name(const std::string& name, std::size_t most) {
  constexpr std::string_view kCut = "...";
  if (name.size() <= most) return name;
  if (most <= kCut.size()) return {};
  std::size_t begin = name.size() - (most - kCut.size());
  const auto is_within_letter = [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
  };
  while (begin < name.size() && is_within_letter(name[begin])) ++begin;
  return std::string(kCut) + name.substr(begin);
}

}  // namespace

std::string progress_bar(const std::string& name, double share, std::size_t columns) {
  constexpr std::string_view kRest = " [] 100 %";
  constexpr std::size_t kLeastBar = 10;
  const std::string percent = share < 0 ? "  ? %" : fmt::format("{:3.0f} %", share * 100);
  // A line that reaches the last column may wrap.
  if (columns <= kRest.size() + kLeastBar) return percent.size() < columns ? percent : "";
  const std::size_t room = columns - 1 - kRest.size();
  const std::size_t bar = std::clamp(room - std::min(name.size(), room), kLeastBar, kBarWidth);
  const auto full =
      static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * static_cast<double>(bar));
  return fmt::format("{} [{}{}] {}", end_of_name(name, room - bar), std::string(full, '#'),
                     std::string(bar - full, '.'), percent);
}

LoadProgress::LoadProgress(const std::string& name)
    : name_(name_of_source(name)),
      is_terminal_(isatty(STDERR_FILENO) != 0),
      begin_(Clock::now()),
      next_(begin_ + (is_terminal_ ? Clock::duration(kBarInterval) : kLineInterval)) {}

LoadProgress::~LoadProgress() {
  if (is_bar_shown_) std::fputs("\r\x1b[K", stderr);
}

void LoadProgress::show(double share) {
  const auto now = Clock::now();
  if (now < next_) return;
  if (is_terminal_) {
    next_ = now + kBarInterval;
    draw_bar(share);
    is_bar_shown_ = true;
  } else {
    next_ = now + kLineInterval;
    log_line(share);
  }
}

void LoadProgress::draw_bar(double share) const {
  fmt::print(stderr, "\r\x1b[K{}", progress_bar(name_, share, columns_of_terminal()));
  std::fflush(stderr);
}

void LoadProgress::log_line(double share) const {
  const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  if (share < 0) {
    spdlog::info(fmt::format("loading {}: {:.0f} s so far", name_, seconds));
  } else {
    spdlog::info(fmt::format("loading {}: {:.0f} % after {:.0f} s", name_, share * 100, seconds));
  }
}

void LayersToRead::begin(std::vector<LayerProgress> layers) {
  const std::lock_guard lock(mutex_);
  layers_ = std::move(layers);
}

// The steps after everything has been read and built take time, too.
void LayersToRead::show(std::size_t layer, double share) {
  constexpr double kLastPercent = 99;
  const std::lock_guard lock(mutex_);
  if (share < 0) {
    layers_[layer].percent.reset();
  } else {
    layers_[layer].percent = static_cast<int>(std::clamp(share * 100, 0.0, kLastPercent));
  }
}

void LayersToRead::finish(std::size_t layer) {
  const std::lock_guard lock(mutex_);
  layers_[layer].percent = 100;
}

std::vector<LayerProgress> LayersToRead::get() const {
  const std::lock_guard lock(mutex_);
  return layers_;
}

StallWatch::StallWatch(const std::vector<std::string>& sources, Clock::duration patience)
    : patience_(patience) {
  for (const std::string& source : sources) {
    sources_.push_back({name_of_source(source), Clock::now()});
  }
}

void StallWatch::look() {
  const auto now = Clock::now();
  for (Source& source : sources_) {
    if (!source.is_watched || now - source.last < patience_) continue;
    source.is_watched = false;
    spdlog::warn(fmt::format(
        "{}: no progress in loading for {:.0f} s: a step takes long, or the source does not "
        "respond",
        source.name, std::chrono::duration<double>(now - source.last).count()));
  }
}

}  // namespace trapeze
