#include "server/values/class_breaks.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace trapeze {
namespace {

/// Sorted, without duplicates and without breaks that do not divide the numbers.
std::vector<double> parting(std::vector<double> breaks, const ValueSpread& spread) {
  std::erase_if(breaks,
                [&spread](double at) { return !(at > spread.least() && at <= spread.greatest()); });
  std::ranges::sort(breaks);
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

/// As near to the true breaks as doubles are: of 1 to 6 in five classes, one is 3, not slightly
/// more, so that a 3 is in the class that begins there.
std::vector<double> equal_breaks(int classes, const ValueSpread& spread) {
  const long double least = spread.least();
  const long double width = spread.greatest() - least;
  std::vector<double> breaks;
  for (int i = 1; i < classes; ++i) {
    breaks.push_back(static_cast<double>(least + width * i / classes));
  }
  return breaks;
}

/// Each break is at the first number of the class above it.
std::vector<double> quantile_breaks(int classes, const ValueSpread& spread) {
  std::vector<double> breaks;
  std::size_t value = 0;
  std::size_t before = 0;  // how many numbers are less than that value
  for (int i = 1; i < classes; ++i) {
    const std::size_t rank =
        static_cast<std::size_t>(i) * spread.count / static_cast<std::size_t>(classes);
    while (before + spread.counts[value] <= rank) before += spread.counts[value++];
    // There is nothing below the least number: it occurs so often that it fills a class.
    const std::size_t next = std::max<std::size_t>(value, 1);
    if (next < spread.values.size()) breaks.push_back(spread.values[next]);
  }
  return breaks;
}

std::vector<double> stddev_breaks(const ValueSpread& spread) {
  constexpr int kMostDeviations = 3;
  const auto count = static_cast<long double>(spread.count);
  long double sum = 0;
  for (std::size_t i = 0; i < spread.values.size(); ++i) {
    sum += static_cast<long double>(spread.values[i]) * spread.counts[i];
  }
  const long double mean = sum / count;
  long double squares = 0;
  for (std::size_t i = 0; i < spread.values.size(); ++i) {
    const long double distance = spread.values[i] - mean;
    squares += distance * distance * spread.counts[i];
  }
  const long double deviation = std::sqrt(squares / count);
  std::vector<double> breaks;
  for (int i = -kMostDeviations; i <= kMostDeviations; ++i) {
    breaks.push_back(static_cast<double>(mean + i * deviation));
  }
  return breaks;
}

std::vector<double> pretty_breaks(int classes, const ValueSpread& spread) {
  const double width = (spread.greatest() / 2 - spread.least() / 2) / classes * 2;
  if (!(width > 0)) return {};
  auto exponent = static_cast<int>(std::floor(std::log10(width)));
  double digit = 1;
  double nearest = std::numeric_limits<double>::infinity();
  for (const double candidate : {1.0, 2.0, 5.0, 10.0}) {
    const double distance =
        std::abs(std::log10(candidate) - (std::log10(width) - static_cast<double>(exponent)));
    if (distance < nearest) digit = candidate;
    nearest = std::min(nearest, distance);
  }
  if (digit == 10) {
    digit = 1;
    ++exponent;
  }
  // 3 / 10 is 0.3, but 3 * 0.1 is not.
  const double power = std::pow(10.0, std::abs(exponent));
  const auto multiple = [&](double count) {
    return exponent < 0 ? count * digit / power : count * digit * power;
  };
  std::vector<double> breaks;
  const double first = std::floor(spread.least() / multiple(1));
  for (double i = 0; i <= 2 * classes + 2; ++i) breaks.push_back(multiple(first + i));
  return breaks;
}

/// Numbers in ascending groups, with running sums that give the cost of a class of consecutive
/// groups.
class JenksGroups {
 public:
  explicit JenksGroups(const ValueSpread& spread) {
    const std::size_t count = std::min(spread.values.size(), kMostJenksValues);
    const auto begin_of = [&](std::size_t group) { return group * spread.values.size() / count; };
    for (std::size_t group = 0; group < count; ++group) {
      first_.push_back(spread.values[begin_of(group)]);
    }
    weights_.resize(count + 1);
    sums_.resize(count + 1);
    squares_.resize(count + 1);
    // To keep precision for numbers that are close to each other and far from 0, or from a few
    // others, such as -1e38 for "no data": sums grow from the middle towards both ends, so that
    // those of a class contain no number that is further out.
    const std::size_t middle = count / 2;
    const long double origin = first_[middle];
    const auto add = [&](std::size_t group, std::size_t from, std::size_t to, long double sign) {
      long double weight = 0;
      long double sum = 0;
      for (std::size_t i = begin_of(group); i < begin_of(group + 1); ++i) {
        weight += spread.counts[i];
        sum += spread.counts[i] * (spread.values[i] - origin);
      }
      weights_[to] = weights_[from] + sign * weight;
      sums_[to] = sums_[from] + sign * sum;
      squares_[to] = squares_[from] + sign * sum * (sum / weight);
    };
    for (std::size_t group = middle; group < count; ++group) add(group, group, group + 1, 1);
    for (std::size_t group = middle; group-- > 0;) add(group, group + 1, group, -1);
  }

  std::size_t size() const { return first_.size(); }
  double first_value(std::size_t group) const { return first_[group]; }
  /// The sum of squared distances of the numbers in groups `begin` to `end` - 1 from their mean.
  long double cost(std::size_t begin, std::size_t end) const {
    if (end - begin == 1) return 0;  // exactly, however large the numbers are
    const long double sum = sums_[end] - sums_[begin];
    return squares_[end] - squares_[begin] - sum * (sum / (weights_[end] - weights_[begin]));
  }

 private:
  std::vector<double> first_;
  std::vector<long double> weights_;  // from the middle to the beginning of each group
  std::vector<long double> sums_;
  std::vector<long double> squares_;
};

/// Fisher's dynamic programming: the best divisions of each initial run of groups, with one more
/// class in each step. The last class of a longer run never begins earlier than that of a shorter
/// one, so solving the middle one first halves the search range of the others.
class JenksClasses {
 public:
  JenksClasses(const JenksGroups& groups, int classes) : groups_(groups) {
    const std::size_t count = groups.size();
    for (std::size_t end = 0; end <= count; ++end)
      best_.push_back(end == 0 ? 0 : groups.cost(0, end));
    for (int i = 1; i < classes; ++i) {
      begins_.emplace_back(count + 1, 0);
      next_ = best_;
      search(static_cast<std::size_t>(i) + 1, count, static_cast<std::size_t>(i), count - 1);
      best_ = next_;
    }
  }

  /// The first numbers of all classes except the lowest one.
  std::vector<double> breaks() const {
    std::vector<double> breaks;
    std::size_t end = groups_.size();
    for (auto begins = begins_.rbegin(); begins != begins_.rend(); ++begins) {
      end = (*begins)[end];
      breaks.push_back(groups_.first_value(end));
    }
    return breaks;
  }

 private:
  /// For runs of `first` to `last` groups, whose last class begins between `least` and `greatest`.
  void search(std::size_t first, std::size_t last, std::size_t least, std::size_t greatest) {
    if (first > last) return;
    const std::size_t middle = first + (last - first) / 2;
    long double lowest = std::numeric_limits<long double>::infinity();
    std::size_t best = least;
    for (std::size_t begin = least; begin <= std::min(greatest, middle - 1); ++begin) {
      const long double cost = best_[begin] + groups_.cost(begin, middle);
      if (cost >= lowest) continue;
      lowest = cost;
      best = begin;
    }
    next_[middle] = lowest;
    begins_.back()[middle] = static_cast<std::uint32_t>(best);
    search(first, middle - 1, least, best);
    search(middle + 1, last, best, greatest);
  }

  const JenksGroups& groups_;
  std::vector<long double> best_;  // by the number of groups divided
  std::vector<long double> next_;
  std::vector<std::vector<std::uint32_t>> begins_;  // of the last class; by classes, then as best_
};

std::vector<double> jenks_breaks(int classes, const ValueSpread& spread) {
  const JenksGroups groups(spread);
  const auto most = static_cast<int>(std::min<std::size_t>(groups.size(), kMostRuledClasses));
  return JenksClasses(groups, std::min(classes, most)).breaks();
}

}  // namespace

std::optional<BreakRule> parse_break_rule(std::string_view text) {
  const std::size_t colon = text.find(':');
  const auto method = kBreakMethodNames.find(text.substr(0, colon));
  if (!method) return std::nullopt;
  BreakRule rule{*method};
  if (colon == std::string_view::npos) return rule;
  const std::string_view count = text.substr(colon + 1);
  const auto [end, error] =
      std::from_chars(count.data(), count.data() + count.size(), rule.classes);
  const bool is_count = error == std::errc() && end == count.data() + count.size() &&
                        rule.classes >= 2 && rule.classes <= kMostRuledClasses;
  if (!is_count || *method == BreakMethod::stddev) return std::nullopt;
  return rule;
}

std::string break_rule_text(const BreakRule& rule) {
  const std::string_view name = kBreakMethodNames.name_of(rule.method);
  if (rule.method == BreakMethod::stddev) return std::string(name);
  return fmt::format("{}:{}", name, rule.classes);
}

std::vector<double> class_breaks(const BreakRule& rule, const ValueSpread& spread) {
  if (spread.is_empty()) return {};
  switch (rule.method) {
    case BreakMethod::equal:
      return parting(equal_breaks(rule.classes, spread), spread);
    case BreakMethod::jenks:
      return parting(jenks_breaks(rule.classes, spread), spread);
    case BreakMethod::pretty:
      return parting(pretty_breaks(rule.classes, spread), spread);
    case BreakMethod::quantile:
      return parting(quantile_breaks(rule.classes, spread), spread);
    case BreakMethod::stddev:
      return parting(stddev_breaks(spread), spread);
  }
  return {};
}

}  // namespace trapeze
