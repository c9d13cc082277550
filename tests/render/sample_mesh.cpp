#include "tests/render/sample_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace trapeze::testing {
namespace {

std::uint64_t next_id() {
  static std::atomic<std::uint64_t> last{1'000'000};
  return ++last;
}

std::int32_t pick(std::mt19937& random, std::int64_t low, std::int64_t high) {
  return static_cast<std::int32_t>(
      std::uniform_int_distribution<std::int64_t>(low, std::max(low, high))(random));
}

std::vector<std::int32_t> pick_sorted(std::mt19937& random, int count, std::int32_t low,
                                      std::int32_t high) {
  std::vector<std::int32_t> values(static_cast<std::size_t>(count));
  for (std::int32_t& value : values) value = pick(random, low, high);
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

SampleMesh::SampleMesh() : id_(next_id()) {}

std::uint32_t SampleMesh::add_vertex(std::int32_t x, std::int32_t y) {
  vertices_.push_back({x, y});
  return static_cast<std::uint32_t>(vertices_.size() - 1);
}

std::uint32_t SampleMesh::add_edge(Point upper, Point lower) {
  const std::uint32_t from = add_vertex(upper.x, upper.y);
  edges_.push_back({from, add_vertex(lower.x, lower.y)});
  return static_cast<std::uint32_t>(edges_.size() - 1);
}

void SampleMesh::add(std::uint32_t left, std::uint32_t right, std::int32_t top,
                     std::int32_t bottom) {
  const std::uint32_t upper = add_vertex(0, top);
  trapezoids_.push_back({upper, add_vertex(0, bottom), left, right});
}

void SampleMesh::add_box(std::int32_t min_x, std::int32_t min_y, std::int32_t max_x,
                         std::int32_t max_y) {
  const std::uint32_t left = add_edge({min_x, min_y}, {min_x, max_y});
  add(left, add_edge({max_x, min_y}, {max_x, max_y}), min_y, max_y);
}

long double SampleMesh::area() const {
  const MeshView mesh = view();
  long double sum = 0;
  for (const MeshTrapezoid& t : trapezoids_) {
    const long double top = vertices_[t.top].y;
    const long double bottom = vertices_[t.bottom].y;
    if (top == bottom) continue;
    sum += (bottom - top) *
           (x_at(mesh, t.right, top) - x_at(mesh, t.left, top) + x_at(mesh, t.right, bottom) -
            x_at(mesh, t.left, bottom)) /
           2;
  }
  return sum;
}

long double x_at(const MeshView& mesh, std::uint32_t edge, long double y) {
  const Point upper = mesh.vertices[mesh.edges[edge].upper];
  const Point lower = mesh.vertices[mesh.edges[edge].lower];
  const long double share = (y - upper.y) / (static_cast<long double>(lower.y) - upper.y);
  return upper.x + share * (static_cast<long double>(lower.x) - upper.x);
}

SampleMesh random_strips(std::mt19937& random, const Box& box, int count) {
  const int strips = std::max(1, static_cast<int>(std::sqrt(2.0 * count)));
  const auto tops = pick_sorted(random, strips + 1, box.min_x, box.max_x);
  const auto bottoms = pick_sorted(random, strips + 1, box.min_x, box.max_x);
  SampleMesh mesh;
  std::vector<std::uint32_t> edges;
  for (std::size_t i = 0; i < tops.size(); ++i) {
    edges.push_back(mesh.add_edge({tops[i], box.min_y}, {bottoms[i], box.max_y}));
  }
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const auto heights = pick_sorted(random, strips, box.min_y, box.max_y);
    for (std::size_t j = 0; j + 1 < heights.size(); ++j) {
      if (pick(random, 0, 1) == 1) mesh.add(edges[i], edges[i + 1], heights[j], heights[j + 1]);
    }
  }
  return mesh;
}

SampleMesh random_scatter(std::mt19937& random, const Box& box, int count) {
  const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(count))));
  const std::int64_t width = (std::int64_t{box.max_x} - box.min_x) / side;
  const std::int64_t height = (std::int64_t{box.max_y} - box.min_y) / side;
  SampleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const std::int64_t x = box.min_x + (i % side) * width;
    const std::int64_t y = box.min_y + (i / side) * height;
    const std::int32_t top = pick(random, y, y + height - 1);
    const std::int32_t bottom = pick(random, top + 1, y + height);
    const std::int32_t middle = pick(random, x, x + width);
    const std::uint32_t left =
        mesh.add_edge({pick(random, x, middle), top}, {pick(random, x, middle), bottom});
    const std::uint32_t right = mesh.add_edge({pick(random, middle, x + width), top},
                                              {pick(random, middle, x + width), bottom});
    mesh.add(left, right, top, bottom);
  }
  return mesh;
}

}  // namespace trapeze::testing
