// Labels of real layers, at random places and scales.
//
// TRAPEZE_LABEL_PAIRS sets the number of pairs of neighbouring tiles to test instead of kPairs; a
// million takes minutes.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "core/labels/label_anchors.h"
#include "core/labels/label_placement.h"
#include "server/config/load_config.h"
#include "server/labels/label_book.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"
#include "tests/server/labels/seen_labels.h"

namespace trapeze {
namespace {

using testing::is_among;
using testing::label_places;
using testing::LabelPlace;
using testing::labels_in;
using testing::SeenLabel;

constexpr int kPairs = 2'000;  // of all layers and styles
constexpr int kLastZoom = 16;

const std::vector<std::string> kStyles = {
    "label=ATTRIBUTE",
    "label=ATTRIBUTE&label-size=9&label-halo-width=1&label-parts=all&label-overhang=40",
    "label={ATTRIBUTE} no. 1&label-max-width=40&label-size=16&label-overhang=1000",
    "label=ATTRIBUTE&label-repeat=no&label-min-size=6&label-halo-width=4&label-overhang=0",
};

struct File {
  const char* name;
  const char* attribute;
};

int wanted_pairs() {
  const char* text = std::getenv("TRAPEZE_LABEL_PAIRS");
  return text == nullptr ? kPairs : std::max(1, std::atoi(text));
}

class RealLabelsTest : public ::testing::TestWithParam<File> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    const std::string file = std::filesystem::path(data) / GetParam().name;
    dataset_ = Dataset::load(layers_of_files({file}));
  }

  const Layer& layer() const { return *dataset_->layers()[0].layer; }

  TilePlan plan_of(std::string style) const {
    const std::string attribute = "ATTRIBUTE";
    style.replace(style.find(attribute), attribute.size(), GetParam().attribute);
    const std::string target =
        "/tiles/" + dataset_->layers()[0].config.name + "/0/0/0.png?" + style;
    return *plan_tile(
        std::get<TileRequest>(*parse_tiles_target(split_target(target).value(), StyleBook())),
        dataset_);
  }

  Point random_place(std::mt19937& random) const {
    const auto vertices = layer().mesh().vertices;
    return vertices[std::uniform_int_distribution<std::size_t>(0, vertices.size() - 1)(random)];
  }

  std::shared_ptr<const Dataset> dataset_;
};

/// Whether two labels, with their halos, share a pixel.
bool overlap(const SeenLabel& a, const SeenLabel& b) {
  const TextMask& one = a.image->mask();
  const TextMask& other = b.image->mask();
  const std::int64_t left = std::max(a.left, b.left);
  const std::int64_t top = std::max(a.top, b.top);
  const std::int64_t right = std::min(a.left + one.width, b.left + other.width);
  const std::int64_t bottom = std::min(a.top + one.height, b.top + other.height);
  const auto has = [](const SeenLabel& label, std::int64_t x, std::int64_t y) {
    const TextMask& mask = label.image->mask();
    return mask.halo[static_cast<std::size_t>((y - label.top) * mask.width + x - label.left)] > 0;
  };
  for (std::int64_t y = top; y < bottom; ++y) {
    for (std::int64_t x = left; x < right; ++x) {
      if (has(a, x, y) && has(b, x, y)) return true;
    }
  }
  return false;
}

void expect_none_over_another(const std::set<SeenLabel>& labels) {
  for (auto a = labels.begin(); a != labels.end(); ++a) {
    for (auto b = std::next(a); b != labels.end(); ++b) {
      if (b->left >= a->left + a->image->mask().width) break;  // they are sorted from west to east
      EXPECT_FALSE(overlap(*a, *b));
    }
  }
}

View tile_at(Point place, int zoom, int scale) {
  const std::int64_t side = kGridSize >> zoom;
  const auto origin = [side](std::int64_t x) { return (x - kGridMin) / side * side + kGridMin; };
  View view;
  view.origin_x = origin(std::min<std::int64_t>(place.x, kGridMax - 1));
  view.origin_y = origin(std::min<std::int64_t>(place.y, kGridMax - 1));
  view.width = view.height = 256 * scale;
  view.cells_per_pixel = static_cast<double>(side) / view.width;
  return view;
}

TEST_P(RealLabelsTest, AreTheSameFromBothSidesOfBordersAndLieApart) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::vector<TilePlan> plans;
  for (const std::string& style : kStyles) plans.push_back(plan_of(style));
  const int pairs = wanted_pairs() / 3;
  std::size_t labels = 0;
  std::size_t crossing = 0;
  for (int i = 0; i < pairs; ++i) {
    const TilePlan& plan = plans[static_cast<std::size_t>(i) % plans.size()];
    const int zoom = std::uniform_int_distribution<int>(0, kLastZoom)(random);
    const int scale = 1 + static_cast<int>(random() % 2);
    const View one = tile_at(random_place(random), zoom, scale);
    View other = one;
    View both = one;
    if (random() % 2 == 0) {
      other.origin_x += kGridSize >> zoom;  // beyond the edge of the world the next one begins
      both.width *= 2;
    } else {
      other.origin_y += kGridSize >> zoom;
      both.height *= 2;
    }
    const auto of_one = labels_in(plan, one, scale);
    const auto of_other = labels_in(plan, other, scale);
    const auto of_both = labels_in(plan, both, scale);
    std::set<SeenLabel> united = of_one;
    united.insert(of_other.begin(), of_other.end());
    EXPECT_EQ(of_both, united) << plan.key() << " zoom " << zoom << " scale " << scale << " at "
                               << one.origin_x << ' ' << one.origin_y;
    expect_none_over_another(of_both);
    labels += of_both.size();
    crossing += of_one.size() + of_other.size() - united.size();
    if (HasFailure()) return;
  }
  EXPECT_GT(labels, static_cast<std::size_t>(pairs) / 4);
  EXPECT_GT(crossing, static_cast<std::size_t>(pairs) / 50);
  fmt::print("{} pairs, {} labels, {} of them over a border\n", pairs, labels, crossing);
}

TEST_P(RealLabelsTest, GoOnBeingShownWhileOneZoomsIn) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::vector<TilePlan> plans;
  for (const std::string& style : kStyles) plans.push_back(plan_of(style));
  const int places = wanted_pairs() / 24;
  constexpr int kWidth = 512;
  std::size_t labels = 0;
  for (int i = 0; i < places; ++i) {
    const TilePlan& plan = plans[static_cast<std::size_t>(i) % plans.size()];
    const Point place = random_place(random);
    std::vector<LabelPlace> before;
    double pixel_before = 0;
    for (int quarter = 0; quarter <= 4 * kLastZoom; ++quarter) {
      View view;
      view.cells_per_pixel = std::exp2(23 - quarter / 4.0);
      view.width = view.height = kWidth;
      view.origin_x = std::llround(place.x - kWidth / 2 * view.cells_per_pixel);
      view.origin_y = std::llround(place.y - kWidth / 2 * view.cells_per_pixel);
      const std::vector<LabelPlace> now = label_places(plan, view);
      const double near = (kWidth / 2 - 1) * view.cells_per_pixel;
      for (const LabelPlace& shown : before) {
        if (std::abs(shown.x - place.x) > near || std::abs(shown.y - place.y) > near) continue;
        EXPECT_TRUE(is_among(shown, now, pixel_before))
            << plan.key() << " at zoom " << quarter / 4.0 << " around " << place.x << ' '
            << place.y;
      }
      labels += now.size();
      before = now;
      pixel_before = 2 * view.cells_per_pixel;
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(labels, static_cast<std::size_t>(places));
}

// ---- which labels are shown, and where

/// Candidates as wide as their names in a font of the usual size, sorted by area.
struct Candidates {
  std::vector<LabelCandidate> all;
  std::vector<LabelAnchor> anchors;  // by number of the candidate
};

constexpr double kOverhang = 8;    // pixels
constexpr double kHalfHeight = 8;  // pixels
constexpr double kLetter = 6.5;    // pixels

Candidates candidates_of(const Layer& layer, const char* attribute) {
  const FeatureTable& features = layer.features();
  const int field = features.field_index(attribute);
  Candidates made;
  const LabelAnchors anchors(layer, LabelParts::largest);
  for (const LabelAnchor& anchor : anchors.all()) {
    const Value value = features.value(anchor.row, field);
    const auto* name = std::get_if<std::string_view>(&value);
    if (name != nullptr && !name->empty()) made.anchors.push_back(anchor);
  }
  std::ranges::sort(made.anchors, [](const LabelAnchor& a, const LabelAnchor& b) {
    return std::tuple(-a.area, a.row) < std::tuple(-b.area, b.row);
  });
  for (const LabelAnchor& anchor : made.anchors) {
    const auto name = std::get<std::string_view>(features.value(anchor.row, field));
    LabelCandidate candidate;
    candidate.x = anchor.place.x;
    candidate.y = anchor.place.y;
    candidate.half_width = static_cast<float>(kLetter / 2 * static_cast<double>(name.size()));
    candidate.half_height = kHalfHeight;
    candidate.least_scale =
        std::hypot(std::max(candidate.half_width - kOverhang, 0.0) / LabelAnchors::kSqueeze,
                   kHalfHeight - kOverhang) /
        anchor.depth;
    made.all.push_back(candidate);
  }
  return made;
}

// A label that is shown already stays, and so may displace labels that a single picture would show.
TEST_P(RealLabelsTest, AreAboutAsManyAsFitIntoAWindowByItself) {
  const Candidates made = candidates_of(layer(), GetParam().attribute);
  const LabelPlacement placement(made.all, static_cast<double>(kGridSize));
  std::mt19937 random(1);
  std::size_t shown = 0;
  std::size_t alone = 0;
  for (int zoom = 0; zoom <= kLastZoom; ++zoom) {
    const double scale = std::exp2(zoom + 8) / static_cast<double>(kGridSize);
    for (int i = 0; i < 20; ++i) {
      const Point place = random_place(random);
      const double half_width = 512 / scale;
      const double half_height = 384 / scale;
      const auto is_inside = [&](const LabelCandidate& c) {
        return std::abs(c.x - place.x) <= half_width && std::abs(c.y - place.y) <= half_height;
      };
      std::vector<LabelCandidate> taken;
      for (const LabelCandidate& c : made.all) {
        if (c.least_scale > scale || !is_inside(c)) continue;
        const bool is_free = std::ranges::none_of(taken, [&](const LabelCandidate& other) {
          return std::abs(c.x - other.x) * scale < c.half_width + other.half_width &&
                 std::abs(c.y - other.y) * scale < c.half_height + other.half_height;
        });
        if (is_free) taken.push_back(c);
      }
      alone += taken.size();
      std::vector<std::uint32_t> numbers;
      placement.find({place.x - half_width, place.y - half_height, place.x + half_width,
                      place.y + half_height},
                     scale, 0, numbers);
      shown += static_cast<std::size_t>(std::ranges::count_if(
          numbers, [&](std::uint32_t number) { return is_inside(made.all[number]); }));
    }
  }
  ASSERT_GT(alone, 100u);
  const double share = static_cast<double>(shown) / static_cast<double>(alone);
  fmt::print("{} of {}: {:.3f}\n", shown, alone, share);
  EXPECT_GE(share, 0.95);
}

/// Whether a place is inside the large rings of an outline, by the even-odd rule.
bool lies_in(double x, double y, const Rings& rings, double least_area) {
  bool is_inside = false;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const auto ring = rings[i];
    double area = 0;
    bool crosses = false;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Point a = ring[k];
      const Point b = ring[(k + 1) % ring.size()];
      area += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
      if ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (static_cast<double>(b.y) - a.y) *
                                                  (b.x - static_cast<double>(a.x))) {
        crosses = !crosses;
      }
    }
    if (std::abs(area) / 2 >= least_area) is_inside ^= crosses;
  }
  return is_inside;
}

TEST_P(RealLabelsTest, ReachNoFartherOutOfTheirPolygonsThanTheyMay) {
  const Candidates made = candidates_of(layer(), GetParam().attribute);
  const LabelPlacement placement(made.all, static_cast<double>(kGridSize));
  std::mt19937 random(1);
  std::size_t looked_at = 0;
  for (int i = 0; i < 1'000; ++i) {
    const auto number = std::uniform_int_distribution<std::uint32_t>(
        0, static_cast<std::uint32_t>(made.all.size()) - 1)(random);
    const int step = placement.first_step_of(number);
    if (step == LabelPlacement::kSteps) continue;
    const LabelCandidate& c = made.all[number];
    const double scale = LabelPlacement::pixels_per_cell_of(step);
    const double half_width = std::max(c.half_width - kOverhang, 0.0) / scale;
    const double half_height = std::max(c.half_height - kOverhang, 0.0) / scale;
    Rings rings;
    layer().append_outline(made.anchors[number].row, rings);
    const double small = LabelAnchors::kSmallShare * made.anchors[number].area;
    for (const double x : {c.x - half_width, c.x, c.x + half_width}) {
      for (const double y : {c.y - half_height, c.y, c.y + half_height}) {
        EXPECT_TRUE(lies_in(x, y, rings, small)) << "row " << made.anchors[number].row;
      }
    }
    ++looked_at;
  }
  EXPECT_GT(looked_at, 500u);
}

INSTANTIATE_TEST_SUITE_P(Files, RealLabelsTest,
                         ::testing::Values(File{"us_counties.fgb", "name"},
                                           File{"malta_landuse.fgb", "type"},
                                           File{"shenzhen_buildings.fgb", "type"}),
                         [](const auto& named) {
                           return std::filesystem::path(named.param.name).stem().string();
                         });

}  // namespace
}  // namespace trapeze
