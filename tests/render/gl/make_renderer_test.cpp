#include "render/make_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/render/sample_mesh.h"

namespace trapeze {
namespace {

void expect_draws(MaskRenderer& renderer) {
  testing::SampleMesh mesh;
  mesh.add_box(0, 0, 8, 8);
  const TrapezoidRange all = mesh.all();
  Mask mask;
  renderer.draw(mesh.view(), {&all, 1}, {0, 0, 1, 8, 8}, mask);
  EXPECT_TRUE(mask.is_all(255));
  EXPECT_FALSE(renderer.description().empty());
}

TEST(MakeRendererTest, AutomaticAlwaysDraws) {
  const MadeRenderer made = make_renderer();
  ASSERT_NE(made.renderer, nullptr);
  expect_draws(*made.renderer);
}

TEST(MakeRendererTest, SoftwareIsSoftware) {
  const MadeRenderer made = make_renderer({RendererKind::software, ""});
  EXPECT_EQ(made.renderer->name(), "software");
  EXPECT_TRUE(made.failures.empty());
  expect_draws(*made.renderer);
}

TEST(MakeRendererTest, AnExplicitKindIsThatKindOrThrowsWithReasons) {
  for (const auto& [kind, name] :
       {std::pair{RendererKind::egl, "egl"}, std::pair{RendererKind::osmesa, "osmesa"}}) {
    try {
      const MadeRenderer made = make_renderer({kind, ""});
      EXPECT_EQ(made.renderer->name(), name);
      expect_draws(*made.renderer);
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("no OpenGL context to draw with: "));
      EXPECT_THAT(error.what(),
                  ::testing::AnyOf(::testing::HasSubstr("EGL surfaceless: "),
                                   ::testing::HasSubstr("EGL: this program was built"),
                                   ::testing::HasSubstr("OSMesa: ")));
    }
  }
}

TEST(MakeRendererTest, RenderersOfOneCallShareTheirMeshes) {
  MadeRenderers made = make_renderers({}, 3);
  ASSERT_EQ(made.renderers.size(), 3u);
  for (auto& renderer : made.renderers) expect_draws(*renderer);
  made.renderers.front().reset();
  expect_draws(*made.renderers.back());
}

TEST(MakeRendererTest, RefusesToMakeNone) {
  EXPECT_THROW(make_renderers({}, 0), std::invalid_argument);
}

TEST(MakeRendererTest, ReadsTheWordsOfTheConfiguration) {
  EXPECT_EQ(kRendererNames.find("auto"), RendererKind::automatic);
  EXPECT_EQ(kRendererNames.find("osmesa"), RendererKind::osmesa);
  EXPECT_EQ(kRendererNames.find("EGL"), std::nullopt);
  EXPECT_EQ(kRendererNames.find(""), std::nullopt);
}

}  // namespace
}  // namespace trapeze
