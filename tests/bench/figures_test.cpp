#include "bench/measure/figures.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace trapeze {
namespace {

TEST(FiguresTest, APercentileIsTheLeastValueThatSoManyDoNotExceed) {
  std::vector<double> values(200);
  std::iota(values.rbegin(), values.rend(), 1.0);  // 200 down to 1
  const Percentiles p = percentiles_of(values);
  EXPECT_EQ(p.count, 200u);
  EXPECT_EQ(p.p50, 100);
  EXPECT_EQ(p.p95, 190);
  EXPECT_EQ(p.p99, 198);
  EXPECT_EQ(p.max, 200);
}

TEST(FiguresTest, OneValueIsEveryPercentile) {
  const Percentiles p = percentiles_of({7});
  EXPECT_EQ(p.p50, 7);
  EXPECT_EQ(p.p99, 7);
  EXPECT_EQ(p.max, 7);
}

TEST(FiguresTest, TheRateIsThatOfTheMiddleRunAndTheProcessorTimeThatOfTheLeast) {
  Figure figure("a");
  const std::vector<TileTime> two_tiles{{3, 10, 500}, {4, 20, 100}};
  figure.add({1, 0.2, two_tiles});
  figure.add({4, 0.1, two_tiles});
  figure.add({2, 0.4, two_tiles});
  EXPECT_DOUBLE_EQ(figure.tiles_per_second(), 1);
  EXPECT_DOUBLE_EQ(figure.best_tiles_per_second(), 2);
  EXPECT_DOUBLE_EQ(figure.cpu_ms_per_tile(), 50);
  EXPECT_DOUBLE_EQ(figure.bytes_per_tile(), 300);
}

TEST(FiguresTest, ZoomsAreToldApart) {
  Figure figure("a");
  figure.add({1, 0, {{3, 10}, {4, 20}, {4, 30}}});
  const auto zooms = figure.percentiles_by_zoom();
  ASSERT_EQ(zooms.size(), 2u);
  EXPECT_EQ(zooms.at(3).max, 10);
  EXPECT_EQ(zooms.at(4).p50, 20);
  EXPECT_EQ(zooms.at(4).max, 30);
}

}  // namespace
}  // namespace trapeze
