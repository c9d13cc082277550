#include "server/values/class_breaks.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Numbers = std::vector<double>;

Numbers breaks_of(std::string_view rule, const Numbers& numbers) {
  return class_breaks(parse_break_rule(rule).value(), spread_of(numbers, 0));
}

/// The sum over all classes of the squared distances from the mean of the class.
double cost_of(const Numbers& breaks, const Numbers& numbers) {
  double cost = 0;
  for (std::size_t i = 0; i <= breaks.size(); ++i) {
    Numbers inside;
    for (const double number : numbers) {
      const bool is_above = i == 0 || number >= breaks[i - 1];
      if (is_above && (i == breaks.size() || number < breaks[i])) inside.push_back(number);
    }
    double mean = 0;
    for (const double number : inside) mean += number / static_cast<double>(inside.size());
    for (const double number : inside) cost += (number - mean) * (number - mean);
  }
  return cost;
}

/// The least cost of any division into classes, by brute force.
double least_cost(std::size_t classes, const Numbers& values, const Numbers& numbers,
                  const Numbers& breaks = {}, std::size_t from = 1) {
  if (breaks.size() + 1 == classes) return cost_of(breaks, numbers);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = from; i < values.size(); ++i) {
    Numbers more = breaks;
    more.push_back(values[i]);
    least = std::min(least, least_cost(classes, values, numbers, more, i + 1));
  }
  return least;
}

TEST(ClassBreaksTest, HaveAsManyNumbersInEachQuantile) {
  EXPECT_THAT(breaks_of("quantile:4", {8, 7, 6, 5, 4, 3, 2, 1}), ElementsAre(3, 5, 7));
  EXPECT_THAT(breaks_of("quantile:2", {1, 2, 3}), ElementsAre(2));
  // numpy.quantile(x, [0.2, 0.4, 0.6, 0.8], method="inverted_cdf") of 0 to 99 gives 19, 39, 59, 79:
  // the last number of each class, where a break is the first number of the next.
  Numbers hundred(100);
  for (std::size_t i = 0; i < hundred.size(); ++i) hundred[i] = static_cast<double>(i);
  EXPECT_THAT(breaks_of("quantile:5", hundred), ElementsAre(20, 40, 60, 80));
}

TEST(ClassBreaksTest, AreFewerWhereNumbersAreTheSame) {
  EXPECT_THAT(breaks_of("quantile:5", {1, 1, 1, 1, 1, 1, 1, 1, 9}), ElementsAre(9));
  EXPECT_THAT(breaks_of("quantile:5", {1, 1, 1, 9, 9, 9}), ElementsAre(9));
  EXPECT_THAT(breaks_of("jenks:5", {1, 1, 4, 4, 9}), ElementsAre(4, 9));
  for (const char* rule : {"quantile:5", "equal:7", "jenks:5", "stddev", "pretty"}) {
    EXPECT_THAT(breaks_of(rule, {3, 3, 3}), IsEmpty()) << rule;
    EXPECT_THAT(breaks_of(rule, {}), IsEmpty()) << rule;
  }
}

TEST(ClassBreaksTest, AreAtEqualDistances) {
  EXPECT_THAT(breaks_of("equal:4", {-2, 0, 1, 6}), ElementsAre(0, 2, 4));
}

// Of integers, many are on a break.
TEST(ClassBreaksTest, AreAtEqualDistancesWithoutErrorsOfRounding) {
  EXPECT_THAT(breaks_of("equal:5", {1, 6}), ElementsAre(2, 3, 4, 5));
  for (const int least : {-7, 0, 1, 3, 10}) {
    for (int classes = 2; classes <= kMostRuledClasses; ++classes) {
      for (int width = 1; width <= 60; ++width) {
        Numbers expected;
        for (int i = 1; i < classes; ++i) expected.push_back(least + width * i);
        const Numbers ends = {static_cast<double>(least),
                              static_cast<double>(least + width * classes)};
        ASSERT_EQ(class_breaks({BreakMethod::equal, classes}, spread_of(ends, 0)), expected);
      }
    }
  }
}

TEST(ClassBreaksTest, AreStandardDeviationsFromTheMean) {
  // Mean 5, standard deviation 2.
  EXPECT_THAT(breaks_of("stddev", {2, 4, 4, 4, 5, 5, 7, 9}), ElementsAre(3, 5, 7, 9));
}

TEST(ClassBreaksTest, ArePrettyNumbers) {
  EXPECT_THAT(breaks_of("pretty:5", {3, 97}), ElementsAre(20, 40, 60, 80));
  EXPECT_THAT(breaks_of("pretty:4", {0.012, 0.31}), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(breaks_of("pretty", {-1.2e6, 2.3e6}),
              ElementsAre(-1e6, -5e5, 0, 5e5, 1e6, 1.5e6, 2e6));
}

TEST(ClassBreaksTest, FindTheBestJenksClassesOfAll) {
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    std::uniform_int_distribution<int> number(0, round % 2 == 0 ? 12 : 1000);
    Numbers numbers(static_cast<std::size_t>(5 + round % 8));
    for (double& each : numbers) each = number(random) / 8.0 - 20;
    const auto spread = spread_of(numbers, 0);
    for (const int classes : {2, 3, 4}) {
      if (spread.values.size() < static_cast<std::size_t>(classes)) continue;
      const auto breaks = class_breaks({BreakMethod::jenks, classes}, spread);
      ASSERT_EQ(breaks.size() + 1, static_cast<std::size_t>(classes));
      ASSERT_NEAR(cost_of(breaks, numbers),
                  least_cost(static_cast<std::size_t>(classes), spread.values, numbers), 1e-7)
          << "round " << round << ", " << classes << " classes";
    }
  }
}

TEST(ClassBreaksTest, FindJenksClassesBesideANumberThatMeansNoData) {
  const Numbers numbers = {10, 11, 12, 40, 41, 42, 90, 91, 92};
  for (const double far : {1e20, 3.4e38, std::numeric_limits<double>::max()}) {
    Numbers below = numbers;
    below.push_back(-far);
    EXPECT_THAT(breaks_of("jenks:4", below), ElementsAre(10, 40, 90)) << -far;
    Numbers above = numbers;
    above.push_back(far);
    EXPECT_THAT(breaks_of("jenks:4", above), ElementsAre(40, 90, far)) << far;
  }
}

TEST(ClassBreaksTest, PartManyNumbersByJenksAsWellAsEqualClassesAtLeast) {
  std::mt19937 random(11);
  std::lognormal_distribution<double> number(0, 1);
  Numbers numbers(3 * kMostJenksValues);
  for (double& each : numbers) each = number(random);
  const auto jenks = breaks_of("jenks:6", numbers);
  ASSERT_EQ(jenks.size(), 5u);
  EXPECT_LT(cost_of(jenks, numbers), cost_of(breaks_of("equal:6", numbers), numbers));
  EXPECT_LT(cost_of(jenks, numbers), cost_of(breaks_of("quantile:6", numbers), numbers));
}

TEST(ClassBreaksTest, AscendWithinTheNumbersWhateverTheyAre) {
  constexpr double kMost = std::numeric_limits<double>::max();
  const std::vector<Numbers> cases = {{-kMost, kMost},           {0, 5e-324},
                                      {1, std::nextafter(1, 2)}, {kMost, std::nextafter(kMost, 0)},
                                      {-1e300, 0, 1e-300},       {1e15, 1e15 + 1, 1e15 + 2}};
  for (const Numbers& numbers : cases) {
    for (const char* rule : {"quantile:32", "equal:32", "jenks:32", "stddev", "pretty:32"}) {
      const auto spread = spread_of(numbers, 0);
      const auto breaks = class_breaks(parse_break_rule(rule).value(), spread);
      EXPECT_LE(breaks.size(), 63u);
      double before = spread.least();
      for (const double at : breaks) {
        EXPECT_GT(at, before) << rule;
        before = at;
      }
      EXPECT_LE(before, spread.greatest()) << rule;
    }
  }
}

TEST(BreakRuleTest, IsReadBackFromItsText) {
  for (const char* text : {"equal:7", "jenks:2", "pretty:32", "quantile:5", "stddev"}) {
    EXPECT_EQ(break_rule_text(parse_break_rule(text).value()), text);
  }
  EXPECT_EQ(break_rule_text(parse_break_rule("quantile").value()), "quantile:5");
  for (const char* text : {"", "quantiles:5", "quantile:", "quantile:1", "quantile:33",
                           "quantile:5.5", "quantile:-5", "stddev:3", "5", "jenks:5 ", "Jenks:5"}) {
    EXPECT_FALSE(parse_break_rule(text)) << text;
  }
}

TEST(ValueSpreadTest, CountsNumbersAndLeavesOutWhatIsNone) {
  const auto spread =
      spread_of({3, 1, std::nan(""), 3, std::numeric_limits<double>::infinity()}, 2);
  EXPECT_THAT(spread.values, ElementsAre(1, 3));
  EXPECT_THAT(spread.counts, ElementsAre(1, 2));
  EXPECT_EQ(spread.count, 3u);
  EXPECT_EQ(spread.missing, 4u);
  EXPECT_THAT(histogram(spread, 4), ElementsAre(1, 0, 0, 2));
  EXPECT_THAT(histogram(spread_of({5, 5}, 0), 2), ElementsAre(2, 0));
}

}  // namespace
}  // namespace trapeze
