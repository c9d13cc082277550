#include "server/tiles/tile_service.h"

#include <gmock/gmock.h>

#include <atomic>
#include <functional>
#include <future>

#include "render/make_renderer.h"
#include "render/picture/png.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;

/// Draws only when it is let; counts what it draws.
class GatedRenderer final : public MaskRenderer {
 public:
  struct Gate {
    std::promise<void> opener;
    std::shared_future<void> is_open = opener.get_future().share();
    std::atomic<int> begun = 0;  // tasks
    std::atomic<int> passes = 0;
    bool gains_by_batching = false;
    std::atomic<bool> fails = false;
    std::function<void()> during_second_pass = [] {};
  };
  using MaskRenderer::draw;
  explicit GatedRenderer(Gate& gate) : gate_(gate) {}

  DrawTimes draw(std::span<const MaskTask> tasks) override {
    gate_.begun += static_cast<int>(tasks.size());
    const int pass = ++gate_.passes;
    gate_.is_open.wait();
    if (pass == 2) gate_.during_second_pass();
    if (gate_.fails) throw std::runtime_error("the device is lost");
    for (const MaskTask& task : tasks) {
      task.out->resize(task.view.width, task.view.height);
      std::fill_n(task.out->row_begin(0), task.out->pixels().size(), std::uint8_t{0});
    }
    return {};
  }
  bool gains_by_batching() const override { return gate_.gains_by_batching; }
  std::string_view name() const override { return "gated"; }
  std::string description() const override { return "gated"; }

 private:
  Gate& gate_;
};

class TileServiceTest : public ::testing::Test {
 protected:
  ~TileServiceTest() override { open(); }

  void start(TileServiceOptions options = {}) {
    std::vector<std::unique_ptr<MaskRenderer>> renderers;
    renderers.push_back(std::make_unique<GatedRenderer>(gate_));
    service_ = std::make_unique<TileService>(options, std::move(renderers));
  }

  /// A plan of which no two are equal unless the shade is.
  TilePlan plan(int shade) const {
    LayerPaint paint;
    paint.style.paints = {{{static_cast<std::uint8_t>(shade), 0, 0, 255}, {}}};
    return {dataset_, {}, 1, kTransparent, {paint}};
  }

  std::future<TileAnswer> submit(int shade) {
    auto promise = std::make_shared<std::promise<TileAnswer>>();
    auto future = promise->get_future();
    const TilePlan tile = plan(shade);
    service_->submit(tile, tile.key(),
                     [promise](const TileAnswer& answer) { promise->set_value(answer); });
    return future;
  }

  void wait_until_drawing(int count) const {
    while (gate_.begun < count) std::this_thread::sleep_for(1ms);
  }

  void open() {
    if (!is_open_) gate_.opener.set_value();
    is_open_ = true;
  }

  GatedRenderer::Gate gate_;
  bool is_open_ = false;
  const std::shared_ptr<const Dataset> dataset_ = testing::sample_dataset();
  std::unique_ptr<TileService> service_;
};

TEST_F(TileServiceTest, EqualPlansUnderWayTogetherAreDrawnOnce) {
  start();
  auto first = submit(1);
  wait_until_drawing(1);
  auto second = submit(1);
  auto third = submit(1);
  open();
  const auto png = first.get().tile.bytes;
  ASSERT_NE(png, nullptr);
  EXPECT_EQ(second.get().tile.bytes, png);
  EXPECT_EQ(third.get().tile.bytes, png);
  EXPECT_EQ(gate_.begun, 1);
  EXPECT_EQ(submit(1).get().outcome, TileOutcome::drawn);
  EXPECT_EQ(gate_.begun, 2) << "nothing is kept once it is answered";
}

TEST_F(TileServiceTest, WhatWaitsIsDrawnInOnePassWhereThatIsFaster) {
  gate_.gains_by_batching = true;
  start({.batch = 3});
  std::vector<std::future<TileAnswer>> answers;
  answers.push_back(submit(0));
  wait_until_drawing(1);
  for (int shade = 1; shade <= 7; ++shade) answers.push_back(submit(shade));
  open();
  for (auto& answer : answers) EXPECT_EQ(answer.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(gate_.begun, 8);
  EXPECT_EQ(gate_.passes, 4) << "one alone, then three, three and one";
}

TEST_F(TileServiceTest, AFullQueueTurnsAwayAtOnce) {
  start({2, 10s});
  auto drawing = submit(0);
  wait_until_drawing(1);
  auto waiting = submit(1);
  auto waiting_too = submit(2);
  auto turned_away = submit(3);
  ASSERT_EQ(turned_away.wait_for(0s), std::future_status::ready);
  EXPECT_EQ(turned_away.get().outcome, TileOutcome::saturated);
  open();
  EXPECT_EQ(drawing.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(waiting.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(waiting_too.get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, WhatWaitsPastItsDeadlineIsNotDrawn) {
  start({8, 50ms});
  auto drawing = submit(0);
  wait_until_drawing(1);
  auto waiting = submit(1);
  std::this_thread::sleep_for(100ms);
  open();
  EXPECT_EQ(waiting.get().outcome, TileOutcome::late);
  EXPECT_EQ(gate_.begun, 1);
}

TEST_F(TileServiceTest, WhoJoinsWhatIsLateWaitsOnAndDoesNotShareItsDeadline) {
  gate_.gains_by_batching = true;
  std::future<TileAnswer> joined;
  gate_.during_second_pass = [&] { joined = submit(1); };
  start({8, 1s, 2});
  auto drawing = submit(0);
  wait_until_drawing(1);
  auto late = submit(1);
  std::this_thread::sleep_for(1100ms);
  auto company = submit(2);  // in one pass with the late one, which is given up before it is drawn
  open();
  if (company.get().outcome == TileOutcome::late) GTEST_SKIP() << "the machine stood still";
  ASSERT_TRUE(joined.valid());
  EXPECT_EQ(joined.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(late.get().outcome, TileOutcome::drawn) << "it has waited anyway";
}

TEST_F(TileServiceTest, AFailingRendererFailsTheRequestAndNotTheWorker) {
  gate_.fails = true;
  open();
  start();
  EXPECT_EQ(submit(0).get().outcome, TileOutcome::failed);
  gate_.fails = false;
  EXPECT_EQ(submit(0).get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, StoppingAnswersEverybody) {
  start();
  auto drawing = submit(0);
  wait_until_drawing(1);
  auto waiting = submit(1);
  std::thread stopper([this] { service_.reset(); });
  std::this_thread::sleep_for(20ms);
  open();
  stopper.join();
  EXPECT_EQ(drawing.get().outcome, TileOutcome::drawn);
  const auto outcome = waiting.get().outcome;
  EXPECT_TRUE(outcome == TileOutcome::saturated || outcome == TileOutcome::drawn);
}

TEST_F(TileServiceTest, DifferentTilesAreDrawnAtTheSameTimeAsIfOneByOne) {
  TileService service({}, make_renderers({RendererKind::software, {}}, 4).renderers);
  std::vector<std::promise<TileAnswer>> answers(64);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    TilePlan plan = this->plan(static_cast<int>(i) * 4);
    std::string key = plan.key();
    service.submit(std::move(plan), std::move(key),
                   [&answers, i](const TileAnswer& answer) { answers[i].set_value(answer); });
  }
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const TileAnswer answer = answers[i].get_future().get();
    ASSERT_EQ(answer.outcome, TileOutcome::drawn);
    const Picture picture = decode_png(*answer.tile.bytes);
    EXPECT_EQ(picture.at(80, 80), (Rgba{static_cast<std::uint8_t>(i * 4), 0, 0, 255}));
  }
}

}  // namespace
}  // namespace trapeze
