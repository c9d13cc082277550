#include "server/data/load_progress.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>
#include <thread>

namespace trapeze {
namespace {

using namespace std::chrono_literals;

TEST(ProgressBarTest, FitsIntoTheTerminal) {
  const std::string name = "/srv/maps/b\u00e2timents/" + std::string(60, 'x') + ".gpkg";
  for (std::size_t columns = 0; columns < 200; ++columns) {
    for (const double share : {-1.0, 0.0, 0.5, 1.0}) {
      const std::string bar = progress_bar(name, share, columns);
      EXPECT_LE(bar.size(), columns == 0 ? 0 : columns - 1);
      EXPECT_LE(progress_bar("a", share, columns).size(), columns == 0 ? 0 : columns - 1);
    }
  }
  EXPECT_EQ(progress_bar("a.fgb", 0.5, 80),
            "a.fgb [" + std::string(20, '#') + std::string(20, '.') + "]  50 %");
  EXPECT_EQ(progress_bar("/srv/maps/buildings.fgb", 0.5, 40),
            "...aps/buildings.fgb [#####.....]  50 %");
}

class StallWatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log_);
    auto logger = std::make_shared<spdlog::logger>("stalls", std::move(sink));
    logger->set_pattern("%v");
    spdlog::set_default_logger(std::move(logger));
  }
  void TearDown() override { spdlog::set_default_logger(before_); }

  std::string log() const { return log_.str(); }

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  std::ostringstream log_;
};

TEST_F(StallWatchTest, WarnsOnceOfWhatDoesNotGetOn) {
  StallWatch watch({"slow.gpkg", "PG:dbname=maps password=secret"}, 0s);
  watch.look();
  watch.look();
  EXPECT_EQ(
      log(),
      "slow.gpkg: no progress in loading for 0 s: a step takes long, or the source does not "
      "respond\n"
      "PG:dbname=maps password=***: no progress in loading for 0 s: a step takes long, or the "
      "source does not respond\n");
}

TEST_F(StallWatchTest, SaysNothingOfWhatGetsOnOrIsDone) {
  StallWatch watch({"a", "b"}, 200ms);
  watch.finish(1);
  std::this_thread::sleep_for(220ms);
  watch.got_on(0);
  watch.look();
  EXPECT_EQ(log(), "");
}

}  // namespace
}  // namespace trapeze
