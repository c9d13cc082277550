#include "render/gl/gl_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "render/gl/context_search.h"
#include "render/make_renderer.h"
#include "render/software/software_renderer.h"
#include "tests/render/compare_renderers.h"
#include "tests/render/sample_mesh.h"

namespace trapeze {
namespace {

using testing::compare_masks;
using testing::compare_renderers;
using testing::Difference;
using testing::random_scatter;
using testing::random_strips;
using testing::SampleMesh;

// Runs every test once for each way to create a context.
class GlRendererTest : public ::testing::TestWithParam<ContextPath> {
 protected:
  void SetUp() override {
    std::string failures;
    for (const ContextCandidate& candidate : list_context_candidates()) {
      if (candidate.path != GetParam()) continue;
      try {
        make_renderers(open_context(candidate), 2);
        return;
      } catch (const std::runtime_error& error) {
        failures += std::string(" ") + error.what();
      }
    }
    GTEST_SKIP() << "no context by " << name_of(GetParam()) << " here:" << failures;
  }

  void make_renderers(std::unique_ptr<GlContext> first, int count) {
    {
      const CurrentContext current(*first);
      store_ = std::make_shared<GlMeshStore>(first->gl());
    }
    for (int i = 1; i < count; ++i) {
      renderers_.push_back(std::make_unique<GlRenderer>(first->create_shared(), store_));
    }
    renderers_.push_back(std::make_unique<GlRenderer>(std::move(first), store_));
  }

  void expect_like_reference(const SampleMesh& mesh, const View& view, const std::string& what) {
    const TrapezoidRange all = mesh.all();
    const Difference difference =
        compare_renderers(reference_, renderer(), mesh.view(), {&all, 1}, view);
    EXPECT_TRUE(difference.is_within_bounds()) << what << ": " << difference;
    renderer().forget(mesh.view().id);
  }

  GlRenderer& renderer() { return *renderers_.front(); }

  SoftwareRenderer reference_;
  std::shared_ptr<GlMeshStore> store_;
  std::vector<std::unique_ptr<GlRenderer>> renderers_;
};

INSTANTIATE_TEST_SUITE_P(Paths, GlRendererTest,
                         ::testing::Values(ContextPath::egl_device,
                                           ContextPath::egl_software_device,
                                           ContextPath::egl_surfaceless, ContextPath::osmesa),
                         [](const auto& path) {
                           std::string name(name_of(path.param));
                           std::erase(name, ' ');
                           return name;
                         });

TEST_P(GlRendererTest, DrawsLikeTheReferenceAtEveryZoom) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int zoom = 0; zoom <= kMaxZoom; ++zoom) {
    const TileId tile{zoom, static_cast<std::uint32_t>(random() % (1u << zoom)),
                      static_cast<std::uint32_t>(random() % (1u << zoom))};
    const Box box = View::of_tile(tile).box();
    for (const int count : {20, 2000}) {
      expect_like_reference(random_strips(random, box, count), View::of_tile(tile),
                            "strips, zoom " + std::to_string(zoom));
      expect_like_reference(random_scatter(random, box, count), View::of_tile(tile, 2),
                            "scatter, zoom " + std::to_string(zoom));
    }
  }
}

TEST_P(GlRendererTest, DrawsBandsOfStretchedPicturesLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const double stretch : {0.1, 0.9, 1.0, 1.7, 10.0}) {
    View view{-300'000'000, 200'000'000, 100'000.0 / 3, 700, 333};
    view.stretch = stretch;
    const SampleMesh strips = random_strips(random, view.box(), 2000);
    for (const int first : {0, 1, 200}) {
      expect_like_reference(strips, view.band(first, 133),
                            "stretched by " + std::to_string(stretch));
    }
  }
}

TEST_P(GlRendererTest, TakesAreaAwayLikeTheReferenceWhereEdgesHaveChangedPlaces) {
  const View view = View::of_tile({12, 2047, 2047});
  const Box box = view.box();
  const std::int32_t step = (box.max_x - box.min_x) / 32;
  SampleMesh mesh;
  mesh.add_box(box.min_x, box.min_y, box.max_x, box.max_y);
  // Holes that cover every fraction of a pixel, up to and across all borders of the picture.
  for (int row = -1; row <= 32; ++row) {
    for (int column = -1; column <= 32; ++column) {
      const std::int32_t west = box.min_x + column * step + row;
      const std::int32_t top = box.min_y + row * step + column;
      const std::int32_t east = west + step * (row + 2) / 40;
      const std::int32_t bottom = top + step * (column + 2) / 40;
      const std::uint32_t left = mesh.add_edge({west, top}, {west + row, bottom});
      const std::uint32_t right = mesh.add_edge({east, top}, {east + row, bottom});
      mesh.add(right, left, top, bottom);
    }
  }
  expect_like_reference(mesh, view, "holes");
}

TEST_P(GlRendererTest, DrawsTrapezoidsFarLargerThanThePictureLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const Box world{kGridMin, kGridMin, kGridMax, kGridMax};
  for (const int zoom : {1, 4, 8, 12, 16, 20, 22}) {
    for (int i = 0; i < 5; ++i) {
      const SampleMesh mesh = random_strips(random, world, 5000);
      // Tiles with visible content: around the end of an edge.
      const Point place = mesh.view().vertices[random() % mesh.view().vertices.size()];
      View view = View::of_tile({zoom, 0, 0});
      view.origin_x = place.x - static_cast<std::int64_t>(100 * view.cells_per_pixel);
      view.origin_y = place.y - static_cast<std::int64_t>(128 * view.cells_per_pixel);
      expect_like_reference(mesh, view, "zoom " + std::to_string(zoom));
    }
  }
}

TEST_P(GlRendererTest, PlacesLongEdgesOfAllSlopesLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  // Lines through a point near the middle of a tile of zoom 22, at all angles, with ends near and
  // far.
  const View view{1'000'000'000, -700'000'000, 2, 256, 256};
  for (const double reach : {1e2, 1e4, 1e6, 7e7}) {
    for (int i = 0; i < 40; ++i) {
      const double angle = std::uniform_real_distribution<double>(1e-9, M_PI - 1e-9)(random);
      const double flat = i % 4 == 0 ? 1e-5 : 1;  // one line in four is nearly horizontal
      const double dx = reach * std::cos(angle);
      const double dy = reach * std::sin(angle) * flat + 1;
      const auto at = [&](double share) {
        return Point{static_cast<std::int32_t>(1'000'000'256 + share * dx),
                     static_cast<std::int32_t>(-699'999'744 + share * dy)};
      };
      const Point upper = at(-1);
      const Point lower = at(0.9);
      if (upper.y >= lower.y) continue;
      SampleMesh mesh;
      const std::uint32_t edge = mesh.add_edge(upper, lower);
      const std::uint32_t east = mesh.add_edge({kGridMax, upper.y}, {kGridMax, lower.y});
      const std::uint32_t west = mesh.add_edge({kGridMin, upper.y}, {kGridMin, lower.y});
      mesh.add(i % 2 == 0 ? edge : west, i % 2 == 0 ? east : edge, upper.y, lower.y);
      expect_like_reference(mesh, view,
                            "reach " + std::to_string(reach) + ", angle " + std::to_string(angle));
    }
  }
}

TEST_P(GlRendererTest, DrawsSliversThinnerThanAPixelLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  SampleMesh mesh;
  const auto pick = [&](int limit) { return static_cast<std::int32_t>(random() % limit); };
  for (int i = 0; i < 300; ++i) {
    const Point upper{pick(1 << 16), pick(1 << 15)};
    const Point lower{pick(1 << 16), upper.y + 1 + pick(1 << 15)};
    const std::int32_t width = 1 + pick(60);
    const std::uint32_t left = mesh.add_edge(upper, lower);
    mesh.add(left, mesh.add_edge({upper.x + width, upper.y}, {lower.x + pick(60), lower.y}),
             upper.y, lower.y);
  }
  expect_like_reference(mesh, {0, 0, 256, 256, 256}, "slivers of at most a quarter of a pixel");
}

TEST_P(GlRendererTest, DrawsTrianglesOfAllShapesLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const View view{0, 0, 64, 128, 128};
  const int side = 128 * 64;
  for (const int reach : {200, 2'000, 20'000, 2'000'000, 200'000'000}) {  // of the sides, in cells
    for (int i = 0; i < 60; ++i) {
      const auto about = [&](int middle) {
        return middle + static_cast<std::int32_t>(random() % (2u * static_cast<unsigned>(reach))) -
               reach;
      };
      const Point apex{static_cast<std::int32_t>(random() % side),
                       static_cast<std::int32_t>(random() % side)};
      const std::int32_t height = 1 + static_cast<std::int32_t>(random() % 4'000);
      const auto [west, east] = std::minmax({about(apex.x), about(apex.x)});
      SampleMesh mesh;
      if (i % 2 == 0) {
        const std::uint32_t left = mesh.add_edge(apex, {west, apex.y + height});
        mesh.add(left, mesh.add_edge(apex, {east, apex.y + height}), apex.y, apex.y + height);
      } else {
        const std::uint32_t left = mesh.add_edge({west, apex.y - height}, apex);
        mesh.add(left, mesh.add_edge({east, apex.y - height}, apex), apex.y - height, apex.y);
      }
      expect_like_reference(mesh, view,
                            "reach " + std::to_string(reach) + ", triangle " + std::to_string(i));
    }
  }
}

TEST_P(GlRendererTest, SumsTensOfThousandsOfTrapezoidsInAPixelLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const Box city{1'000'003, 2'000'001, 1'040'000, 2'050'000};
  const SampleMesh mesh = random_scatter(random, city, 60'000);
  for (const double cells_per_pixel : {100'000.0, 30'000.0, 5'000.0}) {
    expect_like_reference(mesh, {900'000, 1'900'000, cells_per_pixel, 64, 64}, "city");
  }
}

// Would overflow 32 bits if everything were summed up before anything is read back.
TEST_P(GlRendererTest, StacksTensOfThousandsOfTrapezoids) {
  SampleMesh mesh;
  for (int i = 0; i < 40'000; ++i) mesh.add_box(3, 2, 9, 13);
  expect_like_reference(mesh, {0, 0, 1, 16, 16}, "whole pixels");
  expect_like_reference(mesh, {0, 0, 4, 16, 16}, "parts of pixels");
}

TEST_P(GlRendererTest, DrawsTheSameBytesInWhateverOrder) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const SampleMesh mesh = random_strips(random, {-500, -400, 9000, 8000}, 3000);
  std::vector<TrapezoidRange> ranges;
  for (std::uint32_t i = 0; i < mesh.size(); ++i) ranges.push_back({i, 1});
  const View view{0, 0, 30, 256, 256};
  Mask first;
  renderer().draw(mesh.view(), ranges, view, first);
  Mask shuffled;
  for (int i = 0; i < 5; ++i) {
    std::shuffle(ranges.begin(), ranges.end(), random);
    renderer().draw(mesh.view(), ranges, view, shuffled);
    ASSERT_EQ(shuffled, first);
  }
}

TEST_P(GlRendererTest, DrawsTheSameBytesWhereverInTheMesh) {
  SampleMesh alone;
  SampleMesh behind_others;
  for (int i = 0; i < 12'345; ++i) behind_others.add_box(-900, -i, -800, 40);
  for (SampleMesh* mesh : {&alone, &behind_others}) {
    for (int i = 0; i < 3000; ++i) mesh->add_box(i, i * 2, i + 7 * (i % 9 + 1), i * 2 + 3);
  }
  const View view{0, 0, 23.7, 256, 256};
  const TrapezoidRange all = alone.all();
  Mask expected;
  renderer().draw(alone.view(), {&all, 1}, view, expected);
  const TrapezoidRange last{12'345, 3000};
  Mask mask;
  renderer().draw(behind_others.view(), {&last, 1}, view, mask);
  EXPECT_EQ(mask, expected);
  EXPECT_FALSE(expected.is_all(0));
}

// Three pictures; the second has more pixels than one pass draws.
TEST_P(GlRendererTest, DrawsSeveralAndLargePicturesLikeTheReference) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const SampleMesh mesh = random_strips(random, {-50, -40, 9000, 8000}, 2000);
  const TrapezoidRange all = mesh.all();
  const MeshPart part{mesh.view(), {&all, 1}};
  Mask small;
  Mask large;
  Mask narrow;
  const MaskTask tasks[] = {{{&part, 1}, {0, 0, 30, 256, 256}, &small},
                            {{&part, 1}, {0, 0, 3.5, 2500, 2300}, &large},
                            {{&part, 1}, {700, 90, 9, 33, 301}, &narrow}};
  for (const bool together : {true, false}) {
    renderer().set_batching(together);
    renderer().draw(tasks);
    for (const MaskTask& task : tasks) {
      Mask expected;
      reference_.draw(task.parts, task.view, expected);
      const Difference difference = compare_masks(expected, *task.out);
      EXPECT_TRUE(difference.is_within_bounds()) << together << ", " << difference;
    }
  }
}

TEST_P(GlRendererTest, IgnoresTrapezoidsWithoutHeightOrOutsideOfThePicture) {
  SampleMesh mesh;
  const std::uint32_t left = mesh.add_edge({0, 0}, {0, 64});
  const std::uint32_t right = mesh.add_edge({64, 0}, {64, 64});
  const std::uint32_t horizontal = mesh.add_edge({0, 30}, {64, 30});
  mesh.add(left, right, 30, 30);
  mesh.add(horizontal, horizontal, 30, 30);
  mesh.add_box(-100, 0, 0, 64);
  mesh.add_box(64, 0, 100, 64);
  mesh.add_box(0, -100, 64, 0);
  mesh.add_box(0, 64, 64, 100);
  Mask mask;
  const TrapezoidRange all = mesh.all();
  renderer().draw(mesh.view(), {&all, 1}, {0, 0, 1, 64, 64}, mask);
  EXPECT_TRUE(mask.is_all(0));
}

TEST_P(GlRendererTest, DrawsAcrossChunksOfALargeMesh) {
  // Rows of unit boxes, enough for two chunks; nearly every range crosses a border of a row or
  // chunk.
  constexpr int kWidth = 1024;
  constexpr int kHeight = 300;
  SampleMesh mesh;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) mesh.add_box(x, y, x + 1, y + 1);
  }
  const std::vector<TrapezoidRange> ranges{
      {0, 1}, {5, 100'000}, {200'000, 100'000}, {300'001, 7'000}};
  const View view{0, 0, 2, kWidth / 2, kHeight / 2};
  const Difference difference =
      compare_renderers(reference_, renderer(), mesh.view(), ranges, view);
  EXPECT_EQ(difference.worst, 0) << difference;
}

TEST_P(GlRendererTest, DrawsSeveralMeshesAsIfTheyWereOne) {
  SampleMesh west;
  west.add_box(0, 0, 3, 8);
  SampleMesh east;
  east.add_box(3, 0, 6, 8);
  const TrapezoidRange one{0, 1};
  const MeshPart parts[] = {{west.view(), {&one, 1}}, {east.view(), {&one, 1}}};
  Mask mask;
  renderer().draw(parts, {0, 0, 8, 1, 1}, mask);
  EXPECT_EQ(mask.at(0, 0), 191);
}

TEST_P(GlRendererTest, NeighbouringPicturesPutTogetherEqualOneLargePicture) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const SampleMesh mesh = random_strips(random, {-5000, -4000, 9000, 8000}, 500);
  const TrapezoidRange all = mesh.all();
  Mask large;
  renderer().draw(mesh.view(), {&all, 1}, {0, 0, 16, 512, 512}, large);
  Mask small;
  for (int tile = 0; tile < 4; ++tile) {
    const int column = tile % 2 * 256;
    const int row = tile / 2 * 256;
    renderer().draw(mesh.view(), {&all, 1}, {column * 16, row * 16, 16, 256, 256}, small);
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        ASSERT_LE(std::abs(small.at(x, y) - large.at(column + x, row + y)), 1);
      }
    }
  }
}

TEST_P(GlRendererTest, TwoThreadsDrawTheSameBytesAsOne) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::vector<SampleMesh> meshes;
  std::vector<Mask> expected(6);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    meshes.push_back(random_strips(random, {-5000, -4000, 9000, 8000}, 300));
  }
  const View view{0, 0, 16, 256, 256};
  const auto draw = [&](GlRenderer& with, std::size_t mesh, Mask& out) {
    const TrapezoidRange all = meshes[mesh].all();
    with.draw(meshes[mesh].view(), {&all, 1}, view, out);
  };
  for (std::size_t i = 0; i < expected.size(); ++i) draw(renderer(), i, expected[i]);
  for (const SampleMesh& mesh : meshes) renderer().forget(mesh.view().id);

  // Uploads race here, too: from time to time one thread forgets a mesh that the other is using.
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (auto& with : renderers_) {
    threads.emplace_back([&, &with = *with] {
      Mask mask;
      for (std::size_t i = 0; i < 60; ++i) {
        const std::size_t mesh = i % expected.size();
        draw(with, mesh, mask);
        if (!(mask == expected[mesh])) ++wrong;
        if (i % 10 == 9) with.forget(meshes[mesh].view().id);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST_P(GlRendererTest, DrawsAgainWhatWasForgotten) {
  SampleMesh mesh;
  mesh.add_box(0, 0, 8, 8);
  const TrapezoidRange all = mesh.all();
  Mask mask;
  for (int i = 0; i < 3; ++i) {
    renderer().draw(mesh.view(), {&all, 1}, {0, 0, 1, 8, 8}, mask);
    EXPECT_TRUE(mask.is_all(255));
    renderer().forget(mesh.view().id);
  }
}

TEST_P(GlRendererTest, DrawsAgainAfterItsMemoryWasReleased) {
  SampleMesh mesh;
  mesh.add_box(0, 0, 8, 8);
  const TrapezoidRange all = mesh.all();
  Mask mask;
  for (int i = 0; i < 3; ++i) {
    for (const auto& renderer : renderers_) {  // the first one uploads for all
      renderer->draw(mesh.view(), {&all, 1}, {0, 0, 1, 8, 8}, mask);
      EXPECT_TRUE(mask.is_all(255));
    }
    renderers_[static_cast<std::size_t>(i) % renderers_.size()]->release_memory();
  }
}

TEST_P(GlRendererTest, ReleasesChunksThatItUploadedAndKeepsThoseOfOthers) {
  SampleMesh own;
  own.add_box(0, 0, 8, 8);
  SampleMesh of_other;
  of_other.add_box(0, 0, 8, 8);
  GlContext& context = renderer().context();
  const TrapezoidRange all = own.all();
  Mask mask;
  const View view{0, 0, 1, 8, 8};
  renderers_[1]->draw(of_other.view(), {&all, 1}, view, mask);
  renderer().draw(own.view(), {&all, 1}, view, mask);
  const auto buffer_of = [&](const SampleMesh& mesh) {
    const CurrentContext current(context);
    return store_->chunk(context.gl(), mesh.view(), 0, nullptr);
  };
  const auto kept = buffer_of(of_other);
  const std::weak_ptr<const GlMeshStore::Chunk> released = buffer_of(own);
  renderer().release_memory();
  EXPECT_EQ(buffer_of(of_other), kept);
  EXPECT_TRUE(released.expired());
}

TEST_P(GlRendererTest, KeepsDrawingAfterAnImpossibleRequest) {
  SampleMesh mesh;
  mesh.add_box(0, 0, 8, 8);
  const TrapezoidRange all = mesh.all();
  Mask mask;
  EXPECT_THROW(renderer().draw(mesh.view(), {&all, 1}, {0, 0, 1, -8, 8}, mask),
               std::invalid_argument);
  for (int side = 1; side < 12; ++side) {  // more sizes than there are cached targets
    renderer().draw(mesh.view(), {&all, 1}, {0, 0, 1, side, side}, mask);
    EXPECT_EQ(mask.at(0, 0), 255);
  }
}

}  // namespace
}  // namespace trapeze
