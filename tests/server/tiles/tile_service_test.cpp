#include "server/tiles/tile_service.h"

#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <future>

#include "render/make_renderer.h"
#include "render/picture/channels.h"
#include "render/picture/png.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/tile_painter.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;

/// Draws only once the gate is open; counts its tasks.
class GatedRenderer final : public MaskRenderer {
 public:
  struct Gate {
    std::promise<void> opener;
    std::shared_future<void> is_open = opener.get_future().share();
    std::atomic<int> begun = 0;  // tasks
    std::atomic<int> passes = 0;
    bool gains_by_batching = false;
    std::atomic<bool> fails = false;
    bool heeds_cancellation = true;
  };
  using MaskRenderer::draw;
  explicit GatedRenderer(Gate& gate) : gate_(gate) {}

  DrawTimes draw(std::span<const MaskTask> tasks) override {
    gate_.begun += static_cast<int>(tasks.size());
    ++gate_.passes;
    while (gate_.is_open.wait_for(1ms) != std::future_status::ready) {
      if (!gate_.heeds_cancellation) continue;
      for (const MaskTask& task : tasks) task.cancellation->check();
    }
    if (gate_.fails) throw std::runtime_error("the device is lost");
    for (const MaskTask& task : tasks) {
      *task.out = Mask(task.view.width, task.view.height);
    }
    return {};
  }
  bool gains_by_batching() const override { return gate_.gains_by_batching; }
  std::string_view name() const override { return "gated"; }
  std::string description() const override { return "gated"; }

 private:
  Gate& gate_;
};

TileService::Order order_of(const TilePlan& plan, TileService::Cost cost) {
  return {plan, plan.key(), cost};
}

class TileServiceTest : public ::testing::Test {
 protected:
  ~TileServiceTest() override { open(); }

  void start(TileServiceOptions options = {}, int workers = 1) {
    std::vector<std::unique_ptr<MaskRenderer>> renderers;
    for (int i = 0; i < workers; ++i) renderers.push_back(std::make_unique<GatedRenderer>(gate_));
    service_ = std::make_unique<TileService>(options, std::move(renderers));
  }

  /// Plans are equal only if their shades are.
  TilePlan plan(int shade) const {
    LayerPaint paint;
    paint.style.paints = {{{static_cast<std::uint8_t>(shade), 0, 0, 255}, {}}};
    return {dataset_, View::of_tile({}), 1, kTransparent, {paint}};
  }

  std::future<TileAnswer> submit(const TilePlan& plan,
                                 TileService::Cost cost = TileService::Cost::cheap) {
    auto promise = std::make_shared<std::promise<TileAnswer>>();
    auto future = promise->get_future();
    ticket_ = service_->submit(order_of(plan, cost),
                               [promise](const TileAnswer& answer) { promise->set_value(answer); });
    return future;
  }
  std::future<TileAnswer> submit(int shade, TileService::Cost cost = TileService::Cost::cheap) {
    return submit(plan(shade), cost);
  }
  std::future<TileAnswer> submit_dear(int shade) { return submit(shade, TileService::Cost::dear); }

  void wait_until_drawing(int count) const {
    while (gate_.begun < count) std::this_thread::sleep_for(1ms);
  }

  void open() {
    if (!is_open_) gate_.opener.set_value();
    is_open_ = true;
  }

  /// For a client that has every tile; records the requested fingerprint.
  std::string asked_;
  const TileService::Holds holds_all_ = [this](const std::string& fingerprint) {
    asked_ = fingerprint;
    return true;
  };
  GatedRenderer::Gate gate_;
  bool is_open_ = false;
  const std::shared_ptr<const Dataset> dataset_ = testing::sample_dataset();
  std::unique_ptr<TileService> service_;
  TileService::Ticket ticket_;  // of the last request
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
  gate_.heeds_cancellation = false;
  start({8, 50ms});
  auto drawing = submit(0);
  wait_until_drawing(1);
  auto waiting = submit(1);
  std::this_thread::sleep_for(100ms);
  open();
  EXPECT_EQ(waiting.get().outcome, TileOutcome::late);
  EXPECT_EQ(gate_.begun, 1);
}

TEST_F(TileServiceTest, WhoAsksForWhatIsLateDoesNotShareItsDeadline) {
  gate_.heeds_cancellation = false;
  start({.deadline = 1s});
  auto late = submit(0);
  wait_until_drawing(1);
  std::this_thread::sleep_for(1100ms);
  auto asked_afterwards = submit(0);
  open();
  EXPECT_EQ(asked_afterwards.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(gate_.begun, 2);
}

TEST_F(TileServiceTest, DearTilesLeaveHalfOfTheWorkersToCheapOnes) {
  start({}, 4);
  std::vector<std::future<TileAnswer>> dear;
  for (int shade = 1; shade <= 3; ++shade) dear.push_back(submit_dear(shade));
  wait_until_drawing(2);
  auto cheap = submit(10);
  auto cheap_too = submit(11);
  wait_until_drawing(4);
  const TileService::Figures figures = service_->figures();
  EXPECT_EQ(figures.drawing, 4u);
  EXPECT_EQ(figures.waiting, 1u) << "the third of the dear ones";
  open();
  for (auto& answer : dear) EXPECT_EQ(answer.get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, ASingleWorkerDrawsCheapTilesFirst) {
  start();
  auto first = submit(0);
  wait_until_drawing(1);
  auto dear = submit_dear(1);
  auto cheap = submit(2);
  open();
  EXPECT_EQ(cheap.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(dear.get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, ADeadlineEndsWhatIsBeingDrawn) {
  start({.deadline = 50ms});
  auto drawing = submit(0);
  wait_until_drawing(1);
  EXPECT_EQ(drawing.get().outcome, TileOutcome::late) << "though its gate was never opened";
  open();
  EXPECT_EQ(submit(1).get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, WhatNobodyWantsAnyLongerIsNotDrawn) {
  start();
  auto drawing = submit(0);
  wait_until_drawing(1);
  const TileService::Ticket of_drawing = ticket_;
  auto waiting = submit(1);
  service_->withdraw(ticket_);
  EXPECT_EQ(waiting.get().outcome, TileOutcome::withdrawn);
  EXPECT_EQ(service_->figures().waiting, 0u);
  service_->withdraw(of_drawing);
  EXPECT_EQ(drawing.get().outcome, TileOutcome::withdrawn);
  service_->withdraw(of_drawing);  // the second call does nothing
  auto next = submit(2);
  wait_until_drawing(2);  // although the gate is shut
  open();
  EXPECT_EQ(next.get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, WhatNobodyWantsAnyLongerIsObservedAsWithdrawnAndNotAsLate) {
  std::array<std::promise<TileOutcome>, 2> observed;
  auto next = observed.begin();
  TileServiceOptions options;
  options.observe = [&](const TileAnswer& answer) { (next++)->set_value(answer.outcome); };
  start(options);
  auto drawing = submit(0);
  wait_until_drawing(1);
  const TileService::Ticket of_drawing = ticket_;
  auto waiting = submit(1);
  service_->withdraw(ticket_);
  EXPECT_EQ(observed[0].get_future().get(), TileOutcome::withdrawn) << "though no worker has it";
  service_->withdraw(of_drawing);
  EXPECT_EQ(observed[1].get_future().get(), TileOutcome::withdrawn);
  service_.reset();
}

TEST_F(TileServiceTest, WhatAnotherStillWantsIsDrawnForHim) {
  start();
  auto one = submit(0);
  wait_until_drawing(1);
  auto other = submit(0);
  service_->withdraw(ticket_);
  EXPECT_EQ(other.get().outcome, TileOutcome::withdrawn);
  open();
  EXPECT_EQ(one.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(gate_.begun, 1);
}

TEST_F(TileServiceTest, StoppingAnswersEverybodyAndEndsWhatIsBeingDrawn) {
  start();
  auto drawing = submit(0);
  wait_until_drawing(1);
  auto waiting = submit(1);
  auto waiting_too = submit_dear(2);
  service_.reset();  // with the gate shut
  for (auto* answer : {&drawing, &waiting, &waiting_too}) {
    EXPECT_EQ(answer->get().outcome, TileOutcome::saturated);
  }
}

TEST_F(TileServiceTest, AFailingRendererFailsTheRequestAndNotTheWorker) {
  gate_.fails = true;
  open();
  start();
  EXPECT_EQ(submit(0).get().outcome, TileOutcome::failed);
  gate_.fails = false;
  EXPECT_EQ(submit(0).get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, AnAnswerThatCannotBeSentDoesNotKeepOthersWaiting) {
  start();
  service_->submit(order_of(plan(0), TileService::Cost::cheap),
                   [](const TileAnswer&) { throw std::bad_alloc(); });
  std::future<TileAnswer> same = submit(0);
  std::future<TileAnswer> next = submit(1);
  open();
  EXPECT_EQ(same.get().outcome, TileOutcome::drawn);
  EXPECT_EQ(next.get().outcome, TileOutcome::drawn);
}

TEST_F(TileServiceTest, AnObserverThatFailsDoesNotKeepTilesFromBeingAnswered) {
  TileServiceOptions options;
  options.observe = [](const TileAnswer&) { throw std::bad_alloc(); };
  open();
  start(options);
  EXPECT_EQ(submit(0).get().outcome, TileOutcome::drawn);
  EXPECT_EQ(submit(1).get().outcome, TileOutcome::drawn);
}

/// A tile with many features.
TilePlan busy_plan(TileId tile, int scale) {
  TileRequest request;
  request.layers = {"rings", "west"};
  request.tile = tile;
  request.scale = scale;
  request.style = testing::style_of("quality=exact&opacity=0.8");
  return *plan_tile(request, testing::sample_dataset());
}

std::string bytes_of(TileService& service, const TilePlan& plan) {
  std::promise<TileAnswer> promise;
  service.submit(order_of(plan, TileService::Cost::dear),
                 [&promise](const TileAnswer& answer) { promise.set_value(answer); });
  const TileAnswer answer = promise.get_future().get();
  return answer.outcome == TileOutcome::drawn ? *answer.tile.bytes : std::string();
}

TEST_F(TileServiceTest, ALargeTileHasTheSameBytesHoweverManyWorkersThereAre) {
  const TilePlan plan = busy_plan({1, 0, 0}, 4);
  ASSERT_GT(TilePainter::bands_of(plan), 1);
  TileService one({}, make_renderers({RendererKind::software, {}}, 1).renderers);
  TileService several({}, make_renderers({RendererKind::software, {}}, 4).renderers);
  const std::string bytes = bytes_of(one, plan);
  ASSERT_FALSE(bytes.empty());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(bytes_of(several, plan), bytes);
}

TEST_F(TileServiceTest, ALargeTileIsWithinTheBoundsOfTheExactOne) {
  TilePlan plan = busy_plan({1, 0, 0}, 4);
  TileService service({}, make_renderers({RendererKind::software, {}}, 2).renderers);
  const Picture exact = decode_png(bytes_of(service, plan));
  plan.quality = Quality::bounded;
  const Picture bounded = decode_png(bytes_of(service, plan));
  ASSERT_EQ(bounded.pixels.size(), exact.pixels.size());
  int most = 0;
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
    most = std::max(most,
                    difference(channels_of(exact.pixels[i]), channels_of(bounded.pixels[i])).most);
  }
  EXPECT_LE(most, kMostChange);
}

TEST_F(TileServiceTest, ALargeTileIsThatOfItsFourChildren) {
  TileService service({}, make_renderers({RendererKind::software, {}}, 2).renderers);
  const Picture large = decode_png(bytes_of(service, busy_plan({1, 0, 0}, 4)));
  ASSERT_EQ(large.width, 1024);
  ASSERT_EQ(large.height, 1024);
  int most = 0;
  for (std::uint32_t child = 0; child < 4; ++child) {
    const int column = static_cast<int>(child % 2) * 512;
    const int row = static_cast<int>(child / 2) * 512;
    const TilePlan plan = busy_plan({2, child % 2, child / 2}, 2);
    ASSERT_EQ(TilePainter::bands_of(plan), 1);
    const Picture quarter = decode_png(bytes_of(service, plan));
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) {
        const Rgba here = quarter.at(x, y);
        const Rgba there = large.at(column + x, row + y);
        most = std::max({most, std::abs(here.r - there.r), std::abs(here.a - there.a)});
      }
    }
  }
  EXPECT_LE(most, 1);
}

TEST_F(TileServiceTest, AFailingBandFailsTheTileAndNotTheWorkers) {
  gate_.fails = true;
  open();
  start({}, 3);
  const TilePlan large = busy_plan({1, 0, 0}, 4);
  EXPECT_EQ(bytes_of(*service_, large), "");
  gate_.fails = false;
  EXPECT_NE(bytes_of(*service_, large), "");
}

TEST_F(TileServiceTest, StoppingEndsTheBandsOfALargeTile) {
  start({}, 3);
  std::promise<TileAnswer> promise;
  const TilePlan large = busy_plan({0, 0, 0}, 4);
  service_->submit(order_of(large, TileService::Cost::dear),
                   [&promise](const TileAnswer& answer) { promise.set_value(answer); });
  wait_until_drawing(3);
  service_.reset();  // with the gate shut
  EXPECT_EQ(promise.get_future().get().outcome, TileOutcome::saturated);
}

TEST_F(TileServiceTest, ATileThatIsKeptIsNotDrawn) {
  open();
  const auto bytes = std::make_shared<const std::string>("kept");
  std::string asked;
  TileServiceOptions options;
  options.find_kept = [&](const std::string& fingerprint) {
    asked = fingerprint;
    return TileCache::Tile{bytes, TileHint::full};
  };
  start(options);
  const TileAnswer answer = submit(1).get();
  EXPECT_EQ(answer.outcome, TileOutcome::kept);
  EXPECT_EQ(answer.tile.bytes, bytes);
  EXPECT_EQ(answer.tile.hint, TileHint::full);
  EXPECT_EQ(answer.tile.fingerprint, asked);
  EXPECT_EQ(gate_.begun, 0);
}

TEST_F(TileServiceTest, WhatAllHoldWhoAskIsNotDrawn) {
  open();
  start();
  const auto ask = [this](const TilePlan& plan, TileService::Holds holds) {
    auto promise = std::make_shared<std::promise<TileAnswer>>();
    service_->submit(
        order_of(plan, TileService::Cost::dear),
        [promise](const TileAnswer& answer) { promise->set_value(answer); }, std::move(holds));
    return promise->get_future().get();
  };
  for (const TilePlan& tile : {plan(1), busy_plan({1, 0, 0}, 4)}) {  // the second one in bands
    const TileAnswer drawn = ask(tile, {});
    EXPECT_EQ(drawn.outcome, TileOutcome::drawn);
    const int begun = gate_.begun;
    const auto holds = [&](const std::string& fingerprint) {
      return fingerprint == drawn.tile.fingerprint;
    };
    const TileAnswer held = ask(tile, holds);
    EXPECT_EQ(held.outcome, TileOutcome::held);
    EXPECT_EQ(held.tile.bytes, nullptr);
    EXPECT_EQ(held.tile.fingerprint, drawn.tile.fingerprint);
    EXPECT_EQ(gate_.begun, begun);
    const TileAnswer again = ask(tile, [](const std::string&) { return false; });
    EXPECT_EQ(again.outcome, TileOutcome::drawn);
    EXPECT_EQ(*again.tile.bytes, *drawn.tile.bytes);
  }
}

TEST_F(TileServiceTest, CheapTilesThatAreHeldAreAnsweredWithoutAWorker) {
  constexpr std::uint64_t kCheap = 10'000;
  std::vector<TileOutcome> told;
  TileServiceOptions options;
  options.observe = [&told](const TileAnswer& answer) { told.push_back(answer.outcome); };
  start(options);
  const TilePlan tile = plan(1);
  const auto waiting = submit(2);  // for which the gate stays shut
  std::string asked;
  const auto not_held = [&asked](const std::string& fingerprint) {
    asked = fingerprint;
    return false;
  };
  EXPECT_FALSE(service_->answer_at_once(tile, kCheap, not_held));
  EXPECT_FALSE(asked.empty());
  const auto holds = [&asked](const std::string& fingerprint) { return fingerprint == asked; };
  const auto held = service_->answer_at_once(tile, kCheap, holds);
  ASSERT_TRUE(held);
  EXPECT_EQ(held->outcome, TileOutcome::held);
  EXPECT_EQ(held->tile.fingerprint, asked);
  EXPECT_FALSE(service_->answer_at_once(plan(3), kCheap, holds));
  EXPECT_EQ(told, std::vector{TileOutcome::held});
  open();
  EXPECT_EQ(submit(tile).get().tile.fingerprint, asked);
  service_.reset();  // before `told` is destroyed
}

TEST_F(TileServiceTest, TilesInClassesAreAnsweredWithoutAWorkerOnceTheClassesAreKnown) {
  constexpr std::uint64_t kCheap = 10'000;
  start();
  open();
  TilePlan tile = plan(1);
  tile.layers.front().style.classing.ids = {1};
  EXPECT_FALSE(service_->answer_at_once(tile, kCheap, holds_all_));
  EXPECT_TRUE(asked_.empty());
  const std::string fingerprint = submit(tile).get().tile.fingerprint;
  EXPECT_TRUE(service_->answer_at_once(tile, kCheap, holds_all_));
  EXPECT_EQ(asked_, fingerprint);
  tile.layers.front().style.classing.ids = {1, 2};
  EXPECT_FALSE(service_->answer_at_once(tile, kCheap, holds_all_)) << "other classes";
}

TEST_F(TileServiceTest, TilesWithLabelsAreAnsweredWithoutAWorkerOnceTheseArePlaced) {
  constexpr std::uint64_t kCheap = 10'000;
  TileServiceOptions options;
  options.labels = std::make_shared<LabelBook>(FontChoice{open_fonts({})});
  start(options);
  open();
  TileRequest request;
  request.layers = {"rings"};
  request.tile = {1, 1, 0};  // a label reaches into it
  request.style = testing::style_of("label=name");
  const TilePlan tile = *plan_tile(request, dataset_);
  EXPECT_FALSE(service_->answer_at_once(tile, kCheap, holds_all_));
  EXPECT_TRUE(asked_.empty());
  const std::string fingerprint = submit(tile).get().tile.fingerprint;
  EXPECT_TRUE(service_->answer_at_once(tile, kCheap, holds_all_));
  EXPECT_EQ(asked_, fingerprint);
  request.style = testing::style_of("label=name&label-color=red");  // at the same places
  EXPECT_TRUE(service_->answer_at_once(*plan_tile(request, dataset_), kCheap, holds_all_));
  EXPECT_NE(asked_, fingerprint);
  request.style = testing::style_of("label=name&label-size=20");
  EXPECT_FALSE(service_->answer_at_once(*plan_tile(request, dataset_), kCheap, holds_all_));
}

TEST_F(TileServiceTest, CheapTilesThatAreKeptAreAnsweredWithoutAWorker) {
  const auto bytes = std::make_shared<const std::string>("bytes");
  TileServiceOptions options;
  options.find_kept = [&](const std::string&) { return TileCache::Tile{bytes, TileHint::full}; };
  start(options);
  const auto kept =
      service_->answer_at_once(plan(1), 10'000, [](const std::string&) { return false; });
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->outcome, TileOutcome::kept);
  EXPECT_EQ(kept->tile.bytes, bytes);
  EXPECT_EQ(kept->tile.hint, TileHint::full);
}

TEST_F(TileServiceTest, OthersAreNotAnsweredAtOnce) {
  constexpr std::uint64_t kCheap = 10'000;
  const auto holds = [](const std::string&) { return true; };
  start();
  EXPECT_FALSE(service_->answer_at_once(plan(1), 1'000'000, holds));
  TileRequest request;
  request.layers = {"rings"};
  for (const char* style : {"color-by=name&classes=a:red", "label=name", "debug=tile"}) {
    request.style = testing::style_of(style);
    EXPECT_FALSE(service_->answer_at_once(*plan_tile(request, dataset_), kCheap, holds)) << style;
  }
  request.style = testing::style_of("stroke=black");
  EXPECT_TRUE(service_->answer_at_once(*plan_tile(request, dataset_), kCheap, holds));
}

TEST_F(TileServiceTest, DifferentTilesAreDrawnAtTheSameTimeAsIfOneByOne) {
  TileService service({}, make_renderers({RendererKind::software, {}}, 4).renderers);
  std::vector<std::promise<TileAnswer>> answers(64);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    service.submit(order_of(plan(static_cast<int>(i) * 4), TileService::Cost::cheap),
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
