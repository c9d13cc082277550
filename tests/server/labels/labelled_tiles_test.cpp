// Labels in tiles: complete across tile borders, the same at all scales, and present in everything
// that is served.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "render/picture/png.h"
#include "render/software/software_renderer.h"
#include "server/config/load_config.h"
#include "server/labels/draw_labels.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_service.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/labels/seen_labels.h"
#include "tests/server/seed/seeded_tiles.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/edited_land.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;
using testing::is_among;
using testing::label_book;
using testing::label_places;
using testing::LabelPlace;
using testing::labels_in;
using ::testing::Not;
using testing::SeenLabel;

const std::vector<std::string> kStyles = {
    "label=kind",
    "label={kind} {value}&label-parts=all&label-overhang=200",
    "label={value}&label-size=20&label-halo-width=3&label-overhang=40&label-priority=value",
    "label={kind} number {value} of many&label-max-width=60&label-repeat=no&label-overhang=1000",
};

TileRequest request_of(const std::string& target) {
  return std::get<TileRequest>(
      *parse_tiles_target(split_target("/tiles/" + target).value(), StyleBook()));
}

std::set<SeenLabel> labels_of(const TilePlan& plan) {
  return labels_in(plan, plan.view, plan.scale);
}

class LabelledTilesTest : public ::testing::Test {
 protected:
  static TilePlan plan_of(const std::string& target) {
    static const auto dataset = testing::EditedLand(7).load();
    return *plan_tile(request_of(target), dataset);
  }
};

// Two neighbouring tiles both contain every label that crosses their border, at the same pixels.
TEST_F(LabelledTilesTest, NeighboursShowTheSameLabels) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::size_t crossing = 0;
  for (int i = 0; i < 1'500; ++i) {
    const int z = std::uniform_int_distribution<int>(0, 11)(random);
    const int scale = 1 + i % 2;
    const double tiles = std::exp2(z);
    const auto at = [&](double from, double to) {
      const double share = std::uniform_real_distribution<double>(from, to)(random);
      return std::min(static_cast<int>(share * tiles), static_cast<int>(tiles) - 1);
    };
    const int x = at((-5 + 180) / 360.0, (25 + 180) / 360.0);
    const int y = at(0.45, 0.52);
    const int east = x + 1 == static_cast<int>(tiles) ? 0 : x + 1;
    const std::string& style = kStyles[static_cast<std::size_t>(i) % kStyles.size()];
    const auto plan_at = [&](int column) {
      return plan_of("land/" + std::to_string(z) + "/" + std::to_string(column) + "/" +
                     std::to_string(y) + "@" + std::to_string(scale) + "x.png?" + style);
    };
    const TilePlan left = plan_at(x);
    TilePlan right = plan_at(east);
    if (east == 0) right.view.origin_x += kGridSize;  // beyond the edge of the world
    const auto of_left = labels_of(left);
    const auto of_right = labels_of(right);
    const std::int64_t border =
        (static_cast<std::int64_t>(x) + 1 - (std::int64_t{1} << z) / 2) * 256 * scale;
    TilePlan both = left;
    both.view.width *= 2;
    std::set<SeenLabel> united = of_left;
    united.insert(of_right.begin(), of_right.end());
    EXPECT_EQ(labels_of(both), united) << left.key();
    for (const SeenLabel& label : of_left) {
      const bool is_right = of_right.contains(label);
      crossing += is_right ? 1U : 0U;
      EXPECT_LT(label.left, border);
    }
  }
  EXPECT_GT(crossing, 100u);
}

TEST_F(LabelledTilesTest, WhatIsShownIsShownAtAllLargerScales) {
  for (const std::string& style : kStyles) {
    std::vector<LabelPlace> before;
    double pixel_before = 0;
    std::size_t most = 0;
    for (double zoom = 0; zoom <= 11; zoom += 0.25) {
      TilePlan plan = plan_of("land/0/0/0.png?" + style);
      // The whole world at that zoom, a larger picture than any request.
      plan.view.cells_per_pixel = std::exp2(23 - zoom);
      plan.view.width = plan.view.height = static_cast<int>(std::exp2(8 + zoom));
      const std::vector<LabelPlace> now = label_places(plan, plan.view);
      for (const LabelPlace& shown : before) {
        EXPECT_TRUE(is_among(shown, now, pixel_before)) << style << " at zoom " << zoom;
      }
      most = std::max(most, now.size());
      before = now;
      pixel_before = 2 * plan.view.cells_per_pixel;
    }
    EXPECT_GT(most, 1u) << style;
  }
}

/// The number of pixels that differ between two pictures.
std::size_t differences(const Picture& a, const Picture& b, int column_of_a, int column_of_b,
                        int columns) {
  std::size_t count = 0;
  for (int row = 0; row < a.height; ++row) {
    for (int i = 0; i < columns; ++i) {
      if (a.at(column_of_a + i, row) != b.at(column_of_b + i, row)) ++count;
    }
  }
  return count;
}

TEST_F(LabelledTilesTest, ALabelLooksTheSameFromBothSidesOfABorder) {
  // A picture with only the labels, on a transparent background.
  const auto draw = [](const TilePlan& plan) {
    Picture blank{plan.view.width, plan.view.height,
                  std::vector<Rgba>(static_cast<std::size_t>(plan.view.width) *
                                    static_cast<std::size_t>(plan.view.height))};
    RunPicture runs = to_runs(blank);
    draw_labels(label_book()->find({*plan.dataset, plan.labels, plan.view, plan.scale}), runs);
    return to_pixels(runs);
  };
  for (const std::string& style : kStyles) {
    for (const char* tile : {"4/8/7", "5/16/15", "6/33/31", "7/65/62"}) {
      const TilePlan left = plan_of("land/" + std::string(tile) + ".png?" + style);
      TilePlan right = left;
      right.view.origin_x += static_cast<std::int64_t>(256 * left.view.cells_per_pixel);
      TilePlan both = left;
      both.view.width = 512;
      const Picture whole = draw(both);
      EXPECT_EQ(differences(whole, draw(left), 0, 0, 256), 0u) << style;
      EXPECT_EQ(differences(whole, draw(right), 256, 0, 256), 0u) << style;
      EXPECT_GT(to_runs(whole).colours.size(), 3u) << "nothing is drawn";
    }
  }
}

TEST_F(LabelledTilesTest, LabelsDoNotOverlap) {
  for (const std::string& style : kStyles) {
    for (const char* tile : {"3/4/3", "5/16/15", "6/33/31", "8/130/125"}) {
      const TilePlan plan = plan_of("land/" + std::string(tile) + "@2x.png?" + style);
      std::vector<int> covered(static_cast<std::size_t>(plan.view.width) *
                               static_cast<std::size_t>(plan.view.height));
      for (const auto& label :
           label_book()->find({*plan.dataset, plan.labels, plan.view, plan.scale})) {
        const TextMask& mask = label.image->mask();
        for (int row = 0; row < mask.height; ++row) {
          for (int column = 0; column < mask.width; ++column) {
            const int x = label.left + column;
            const int y = label.top + row;
            if (x < 0 || y < 0 || x >= plan.view.width || y >= plan.view.height) continue;
            const auto i = static_cast<std::size_t>(row * mask.width + column);
            if (mask.halo[i] == 0) continue;
            EXPECT_EQ(++covered[static_cast<std::size_t>(y * plan.view.width + x)], 1)
                << style << ' ' << tile;
          }
        }
      }
    }
  }
}

// The oracle of pictures applies to the pixels around labels.
TEST_F(LabelledTilesTest, AroundLabelsATileIsWhatItIsWithoutThem) {
  TilePainter painter = testing::software_painter();
  const auto paint = [&painter](const TilePlan& plan) {
    const PaintJob job{&plan};
    return decode_png(*painter.paint({&job, 1}).front().value().bytes);
  };
  for (const std::string& style : kStyles) {
    std::size_t around = 0;
    std::size_t changed = 0;
    for (const char* tile : {"4/8/7", "5/16/15", "6/33/31", "8/130/125"}) {
      const std::string base = "land/" + std::string(tile) +
                               "@2x.png?quality=exact&stroke=black&color-by=kind&" +
                               "classes=a:red,*:beige";
      const TilePlan labelled = plan_of(base + "&" + style);
      const Picture plain = paint(plan_of(base));
      const Picture picture = paint(labelled);
      std::vector<bool> is_masked(picture.pixels.size());
      for (const DrawnLabel& label : label_book()->find(
               {*labelled.dataset, labelled.labels, labelled.view, labelled.scale})) {
        const TextMask& mask = label.image->mask();
        for (int row = 0; row < mask.height; ++row) {
          for (int column = 0; column < mask.width; ++column) {
            const int x = label.left + column;
            const int y = label.top + row;
            if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) continue;
            const auto i = static_cast<std::size_t>(row * mask.width + column);
            if (mask.halo[i] > 0) is_masked[static_cast<std::size_t>(y * picture.width + x)] = true;
          }
        }
      }
      for (std::size_t i = 0; i < is_masked.size(); ++i) {
        const bool is_same = picture.pixels[i] == plain.pixels[i];
        if (!is_masked[i]) {
          EXPECT_TRUE(is_same) << style << " " << tile << " pixel " << i;
        }
        around += is_masked[i] ? 0U : 1U;
        changed += is_same ? 0U : 1U;
      }
    }
    EXPECT_GT(around, 100'000u);
    EXPECT_GT(changed, 100u) << style;
  }
}

TEST_F(LabelledTilesTest, SeedingKnowsOfLabels) {
  const auto dataset = testing::EditedLand(7).load();
  for (const std::string& style : {kStyles[1], std::string("label=kind&label-overhang=1000")}) {
    const auto plan = SeedPlan::make(testing::seed_request(*dataset, {0, 7}, style), dataset);
    ASSERT_TRUE(plan);
    testing::expect_served_bytes(*plan);
  }
}

/// So many squares, each with a number, that it takes a second and more to place their labels.
std::shared_ptr<const Dataset> many_squares() {
  constexpr int kColumns = 300;
  constexpr int kRows = 100;
  std::string features;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const double x = 0.1 * (i % kColumns);
    const double y = 0.1 * (i / kColumns);
    features += fmt::format(
        R"({}{{"type":"Feature","properties":{{"n":{}}},"geometry":{{"type":"Polygon",)"
        R"("coordinates":[[[{:.2f},{:.2f}],[{:.2f},{:.2f}],[{:.2f},{:.2f}],[{:.2f},{:.2f}]]]}}}})",
        i == 0 ? "" : ",", i, x, y, x + 0.09, y, x + 0.09, y + 0.09, x, y);
  }
  const TemporaryFolder folder;
  const std::string file = folder.write(
      "squares.geojson", R"({"type":"FeatureCollection","features":[)" + features + "]}");
  return Dataset::load(layers_of_files({file}));
}

TEST(LabelPlacingTest, KeepsNobodyLongerThanTheDeadlineAndNoWorkerAtAll) {
  const auto dataset = many_squares();
  const auto book = std::make_shared<LabelBook>(FontChoice{open_fonts({})});
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  renderers.push_back(std::make_unique<SoftwareRenderer>());
  TileServiceOptions options;
  options.deadline = std::chrono::milliseconds(100);
  options.labels = book;
  TileService service(options, std::move(renderers));
  const auto submit = [&](const TilePlan& plan, TileService::Cost cost) {
    auto promise = std::make_shared<std::promise<TileAnswer>>();
    service.submit({plan, plan.key(), cost},
                   [promise](const TileAnswer& answer) { promise->set_value(answer); });
    return promise->get_future();
  };
  const TilePlan labelled = *plan_tile(request_of("squares/12/2080/2030.png?label=n"), dataset);
  const TilePlan plain = *plan_tile(request_of("squares/12/2080/2030.png"), dataset);
  auto first = submit(labelled, TileService::Cost::dear);
  const auto draw_plain = [&] {
    return submit(plain, TileService::Cost::cheap).get().outcome == TileOutcome::drawn;
  };
  for (int i = 0; i < 20 && !draw_plain(); ++i) continue;
  EXPECT_TRUE(draw_plain());
  EXPECT_FALSE(book->has_placed({*dataset, labelled.labels, labelled.view, labelled.scale}))
      << "the only worker draws what has no labels meanwhile";
  EXPECT_EQ(first.get().outcome, TileOutcome::placing);
  TileAnswer answer;
  for (int i = 0; i < 1'000 && !answer.is_known(); ++i) {
    answer = submit(labelled, TileService::Cost::dear).get();
  }
  EXPECT_EQ(answer.outcome, TileOutcome::drawn) << "placing goes on when nobody waits for it";
}

TEST(LabelPlacingTest, KeepsTheFirstNoLongerUnderLoadOrIfOthersJoinIt) {
  const auto dataset = many_squares();
  const auto book = std::make_shared<LabelBook>(FontChoice{open_fonts({})});
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  renderers.push_back(std::make_unique<SoftwareRenderer>());
  TileServiceOptions options;
  options.deadline = std::chrono::milliseconds(100);
  options.labels = book;
  TileService service(options, std::move(renderers));
  const auto submit = [&](const TilePlan& plan, std::string key) {
    auto promise = std::make_shared<std::promise<TileAnswer>>();
    service.submit({plan, std::move(key)},
                   [promise](const TileAnswer& answer) { promise->set_value(answer); });
    return promise->get_future();
  };
  const TilePlan labelled = *plan_tile(request_of("squares/12/2080/2030.png?label=n"), dataset);
  const TilePlan plain = *plan_tile(request_of("squares/12/2080/2030.png"), dataset);
  auto first = submit(labelled, labelled.key());
  for (int i = 0; first.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready; ++i) {
    for (int k = 0; k < 20; ++k) submit(plain, fmt::format("{} {}", i, k));  // as if they differed
    if (i % 10 == 0) submit(labelled, labelled.key());
  }
  EXPECT_EQ(first.get().outcome, TileOutcome::placing);
  EXPECT_FALSE(book->has_placed({*dataset, labelled.labels, labelled.view, labelled.scale}));
}

TEST(LabelRequestsTest, WrongOnesAreTold) {
  testing::SampleSite site;
  const auto answer = [&site](const std::string& query) {
    return site.get("/tiles/rings/0/0/0.png?" + query);
  };
  EXPECT_EQ(answer("label=name").status, 200);
  for (const char* wrong :
       {"label=", "label={", "label=nothing", "label={name} {nothing}", "label=name&label-size=5",
        "label=name&label-font=nothing", "label=name&label-priority=name",
        "label=name&label-parts=some", "label=name&label-repeat=maybe"}) {
    const HttpResponse response = answer(wrong);
    EXPECT_EQ(response.status, 400) << wrong;
    EXPECT_THAT(*response.body, HasSubstr("label")) << wrong;
  }
}

TEST(LabelRequestsTest, ATileWithALabelIsNeitherFullNorTheSame) {
  testing::SampleSite site;
  const HttpResponse plain = site.get("/tiles/rings/0/0/0.png");
  const HttpResponse labelled = site.get("/tiles/rings/0/0/0.png?label=name&label-overhang=500");
  EXPECT_EQ(labelled.status, 200);
  EXPECT_NE(plain.header("ETag"), labelled.header("ETag"));
}

TEST(LabelRequestsTest, AHaloWithoutAWidthHasNoColour) {
  testing::SampleSite site;
  const std::string bare = "/tiles/rings/0/0/0.png?label=name&label-overhang=500&label-halo-width=";
  const HttpResponse red = site.get(bare + "0&label-halo-color=red");
  const HttpResponse none = site.get(bare + "0&label-halo-color=transparent");
  EXPECT_EQ(red.status, 200);
  EXPECT_EQ(*red.body, *none.body);
  EXPECT_EQ(red.header("ETag"), none.header("ETag"));
  EXPECT_NE(*red.body, *site.get(bare + "1&label-halo-color=red").body);
}

}  // namespace
}  // namespace trapeze
