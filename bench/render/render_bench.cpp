// The cost of the stages of a picture: the mask with each renderer, colour, PNG.
//
//   render_bench                          all stages
//   render_bench --benchmark_filter=draw  the renderers only
//
// Pictures are 256 x 256. "scatter" has the named number of small separate trapezoids, like
// buildings; "strips" fill half of the picture with as many slanted ones, some thin, some large,
// like land use.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "render/make_renderer.h"
#include "render/mask/mask.h"
#include "render/picture/compose.h"
#include "render/picture/png.h"

namespace trapeze {
namespace {

constexpr std::int32_t kSide = 256 * 64;  // of the picture, in cells

const View kView{0, 0, 64, 256, 256};

// A mesh of random trapezoids, the same in every run.
class BenchMesh {
 public:
  static BenchMesh scatter(int count) {
    BenchMesh mesh;
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    const int field = kSide / side;
    for (int i = 0; i < count; ++i) {
      const int x = i % side * field;
      const int y = i / side * field;
      const int half = field / 2;
      const int top = y + mesh.pick(half);
      const int bottom = y + half + 1 + mesh.pick(half - 1);
      const std::uint32_t left =
          mesh.add_edge({x + mesh.pick(half), top}, {x + mesh.pick(half), bottom});
      const std::uint32_t right =
          mesh.add_edge({x + half + mesh.pick(half), top}, {x + half + mesh.pick(half), bottom});
      mesh.add(left, right, top, bottom);
    }
    return mesh;
  }

  static BenchMesh strips(int count) {
    BenchMesh mesh;
    const int strips = std::max(2, static_cast<int>(std::sqrt(2.0 * count)));
    const std::vector<int> tops = mesh.pick_sorted(strips);
    const std::vector<int> bottoms = mesh.pick_sorted(strips);
    for (std::size_t i = 0; i + 1 < tops.size(); ++i) {
      const std::uint32_t left = mesh.add_edge({tops[i], 0}, {bottoms[i], kSide});
      const std::uint32_t right = mesh.add_edge({tops[i + 1], 0}, {bottoms[i + 1], kSide});
      const std::vector<int> rows = mesh.pick_sorted(strips);
      for (std::size_t j = 0; j + 1 < rows.size(); j += 2) {
        mesh.add(left, right, rows[j], rows[j + 1]);
      }
    }
    return mesh;
  }

  MeshView view() const {
    return {static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(vertices_.data())),
            vertices_, edges_, trapezoids_};
  }
  TrapezoidRange all() const { return {0, static_cast<std::uint32_t>(trapezoids_.size())}; }
  /// All trapezoids, in that many ranges of equal length.
  std::vector<TrapezoidRange> in_ranges(std::uint32_t count) const {
    const auto length = static_cast<std::uint32_t>(trapezoids_.size()) / count;
    std::vector<TrapezoidRange> ranges;
    for (std::uint32_t i = 0; i < count; ++i) ranges.push_back({i * length, length});
    return ranges;
  }

 private:
  int pick(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }

  std::vector<int> pick_sorted(int count) {
    std::vector<int> values(static_cast<std::size_t>(count));
    for (int& value : values) value = pick(kSide + 1);
    std::sort(values.begin(), values.end());
    return values;
  }

  std::uint32_t add_vertex(Point point) {
    vertices_.push_back(point);
    return static_cast<std::uint32_t>(vertices_.size() - 1);
  }

  std::uint32_t add_edge(Point upper, Point lower) {
    const std::uint32_t from = add_vertex(upper);
    edges_.push_back({from, add_vertex(lower)});
    return static_cast<std::uint32_t>(edges_.size() - 1);
  }

  void add(std::uint32_t left, std::uint32_t right, int top, int bottom) {
    const std::uint32_t upper = add_vertex({0, top});
    trapezoids_.push_back({upper, add_vertex({0, bottom}), left, right});
  }

  std::mt19937 random_{42};
  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<MeshTrapezoid> trapezoids_;
};

using MakeMesh = BenchMesh (*)(int);

std::unique_ptr<MaskRenderer> renderer_of(RendererKind kind, benchmark::State& state) {
  try {
    auto made = make_renderer({kind, {}});
    state.SetLabel(made.renderer->description());
    return std::move(made.renderer);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    return nullptr;
  }
}

void draw(benchmark::State& state, RendererKind kind, MakeMesh make) {
  const auto renderer = renderer_of(kind, state);
  if (!renderer) return;
  const BenchMesh mesh = make(static_cast<int>(state.range(0)));
  const std::vector<TrapezoidRange> ranges =
      mesh.in_ranges(static_cast<std::uint32_t>(state.range(1)));
  Mask mask;
  renderer->draw(mesh.view(), ranges, kView, mask);  // uploads
  for (auto _ : state) {
    renderer->draw(mesh.view(), ranges, kView, mask);
    benchmark::DoNotOptimize(mask.row(0).data());
  }
  state.counters["trapezoids"] = mesh.all().count;
}

void draw_arguments(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"count", "ranges"})->Unit(benchmark::kMicrosecond);
  for (const int count : {100, 2'000, 20'000}) bench->Args({count, 1});
  bench->Args({2'000, 200});
}

BENCHMARK_CAPTURE(draw, software_scatter, RendererKind::software, BenchMesh::scatter)
    ->Apply(draw_arguments);
BENCHMARK_CAPTURE(draw, software_strips, RendererKind::software, BenchMesh::strips)
    ->Apply(draw_arguments);
BENCHMARK_CAPTURE(draw, egl_scatter, RendererKind::egl, BenchMesh::scatter)
    ->Apply(draw_arguments)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(draw, egl_strips, RendererKind::egl, BenchMesh::strips)
    ->Apply(draw_arguments)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(draw, osmesa_scatter, RendererKind::osmesa, BenchMesh::scatter)
    ->Apply(draw_arguments)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

Mask sample_mask(int count) {
  const BenchMesh mesh = BenchMesh::strips(count);
  const TrapezoidRange all = mesh.all();
  Mask mask;
  make_renderer({RendererKind::software, {}}).renderer->draw(mesh.view(), {&all, 1}, kView, mask);
  return mask;
}

void compose_layers(benchmark::State& state) {
  const Mask lower = sample_mask(100);
  const Mask upper = sample_mask(700);
  const std::vector<PaintedClass> all{{&lower, {200, 30, 30, 255}}, {&upper, {30, 30, 200, 128}}};
  const auto layers = plain_layers(std::span(all).first(static_cast<std::size_t>(state.range(0))));
  Composer composer;
  RunPicture picture;
  for (auto _ : state) {
    composer.compose(layers, 256, 256, kTransparent, Quality::bounded, picture);
    benchmark::DoNotOptimize(picture.runs.data());
  }
}
BENCHMARK(compose_layers)->ArgName("layers")->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void encode(benchmark::State& state) {
  const Mask mask = sample_mask(static_cast<int>(state.range(0)));
  const Mask other = sample_mask(33);
  const std::vector<PaintedClass> all{{&mask, {200, 30, 30, 255}}, {&other, {30, 30, 200, 128}}};
  const auto layers = plain_layers(std::span(all).first(static_cast<std::size_t>(state.range(1))));
  RunPicture picture;
  Composer().compose(layers, 256, 256, kTransparent, Quality::bounded, picture);
  PngEncoder encoder;
  std::size_t bytes = 0;
  for (auto _ : state) {
    const std::string png = encoder.encode(picture);
    bytes = png.size();
    benchmark::DoNotOptimize(png.data());
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}
BENCHMARK(encode)
    ->ArgNames({"count", "layers"})
    ->Args({0, 1})
    ->Args({100, 1})
    ->Args({2'000, 1})
    ->Args({20'000, 1})
    ->Args({2'000, 2})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace trapeze
