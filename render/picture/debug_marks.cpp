#include "render/picture/debug_marks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "render/picture/blend.h"

namespace trapeze {
namespace {

/// A position in pixels of the picture.
struct Position {
  double x = 0;
  double y = 0;
};

Position position_of(Point p, const View& view) {
  return {static_cast<double>(p.x - view.origin_x) / view.cells_per_pixel,
          view.row_from_y(static_cast<double>(p.y))};
}

/// Clips the segment to the picture with a margin of one pixel; false if nothing is left.
bool clip(Position& a, Position& b, const Picture& picture) {
  double from = 0;
  double to = 1;
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const auto cut = [&](double direction, double distance) {
    if (direction == 0) return distance >= 0;
    const double t = distance / direction;
    if (direction < 0) {
      from = std::max(from, t);
    } else {
      to = std::min(to, t);
    }
    return from <= to;
  };
  if (!cut(-dx, a.x + 1) || !cut(dx, picture.width + 1 - a.x) || !cut(-dy, a.y + 1) ||
      !cut(dy, picture.height + 1 - a.y)) {
    return false;
  }
  const Position start = a;
  a = {start.x + from * dx, start.y + from * dy};
  b = {start.x + to * dx, start.y + to * dy};
  return true;
}

/// A line one pixel wide: at every step along its longer side, it is shared by two pixels.
void draw_line(Position a, Position b, Rgba colour, Picture& picture) {
  if (!clip(a, b, picture)) return;
  const bool is_steep = std::abs(b.y - a.y) > std::abs(b.x - a.x);
  if (is_steep) {
    std::swap(a.x, a.y);
    std::swap(b.x, b.y);
  }
  if (a.x > b.x) std::swap(a, b);
  const double slope = b.x > a.x ? (b.y - a.y) / (b.x - a.x) : 0;
  for (int step = static_cast<int>(std::floor(a.x)); step <= static_cast<int>(std::floor(b.x));
       ++step) {
    const double along = std::clamp(step + 0.5, a.x, b.x);
    const double across = a.y + (along - a.x) * slope - 0.5;
    const int first = static_cast<int>(std::floor(across));
    const double share = across - first;
    for (const int k : {0, 1}) {
      const double part = k == 0 ? 1 - share : share;
      blend(picture, is_steep ? first + k : step, is_steep ? step : first + k, colour, part);
    }
  }
}

/// Where an edge reaches the height of a vertex, in pixels.
Position on_edge(const MeshView& mesh, std::uint32_t edge, std::uint32_t vertex, const View& view) {
  const Point a = mesh.vertices[mesh.edges[edge].upper];
  const Point b = mesh.vertices[mesh.edges[edge].lower];
  const std::int32_t y = mesh.vertices[vertex].y;
  const double share =
      a.y == b.y ? 0 : (static_cast<double>(y) - a.y) / (static_cast<double>(b.y) - a.y);
  return {(static_cast<double>(a.x - view.origin_x) + share * (static_cast<double>(b.x) - a.x)) /
              view.cells_per_pixel,
          view.row_from_y(static_cast<double>(y))};
}

template <class Visit>
void for_each(std::span<const TrapezoidRange> ranges, const MeshView& mesh, const Visit& visit) {
  for (const TrapezoidRange& range : ranges) {
    for (const MeshTrapezoid& t : mesh.trapezoids.subspan(range.first, range.count)) visit(t);
  }
}

constexpr std::uint8_t kTintOpacity = 190;

/// Hues in steps of the golden section around the circle, so that consecutive numbers have very
/// different hues and none recurs soon; alternately light and dark.
Rgba tint_of(std::uint32_t feature) {
  constexpr double kGoldenSection = 0.6180339887498949;
  const double hue = 6 * std::fmod(feature * kGoldenSection, 1.0);
  const double least = feature % 2 == 0 ? 0.15 : 0.5;
  const double most = feature % 3 == 0 ? 0.75 : 1.0;
  const auto channel = [&](double peak) {
    const double off = std::abs(std::remainder(hue - peak, 6.0));
    const double share = std::clamp(2 - off, 0.0, 1.0);
    return static_cast<std::uint8_t>(std::lround(255 * (least + (most - least) * share)));
  };
  return {channel(0), channel(2), channel(4), kTintOpacity};
}

/// Premultiplied colours of a row of pixels, with the coverage of each pixel.
struct Tinted {
  double r = 0;
  double g = 0;
  double b = 0;
  double share = 0;
};

/// Sums tints in proportion to the areas that they cover: exact along scan lines, of which there
/// are several per pixel. For some rows of a picture, which bounds its memory.
class TintSum {
 public:
  TintSum(int width, int first_row, int rows)
      : width_(width),
        first_row_(first_row),
        height_(rows),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows)) {}

  void add(const MeshView& mesh, const MeshTrapezoid& t, const View& view, Rgba tint) {
    const Position top = position_of(mesh.vertices[t.top], view);
    const Position bottom = position_of(mesh.vertices[t.bottom], view);
    const double least = static_cast<double>(first_row_) * kRowsPerPixel;
    const double most = least + static_cast<double>(height_) * kRowsPerPixel;
    // Scan lines whose middles are between top and bottom.
    const auto first = std::clamp(std::ceil(top.y * kRowsPerPixel - 0.5), least, most);
    const auto end = std::clamp(std::ceil(bottom.y * kRowsPerPixel - 0.5), least, most);
    for (int row = static_cast<int>(first); row < static_cast<int>(end); ++row) {
      const double y = (row + 0.5) / kRowsPerPixel;
      add_run(row / kRowsPerPixel - first_row_, x_at(mesh, t.left, y, view),
              x_at(mesh, t.right, y, view), tint);
    }
  }

  void blend_into(Picture& picture) const {
    for (int row = 0; row < height_; ++row) {
      for (int column = 0; column < width_; ++column) {
        const Tinted& tinted = pixels_[index(row, column)];
        if (tinted.share <= 0) continue;
        const auto mean = [&](double sum) {
          return static_cast<std::uint8_t>(std::lround(sum / tinted.share));
        };
        const Rgba colour{mean(tinted.r), mean(tinted.g), mean(tinted.b), kTintOpacity};
        blend(picture, column, first_row_ + row, colour, std::min(tinted.share, 1.0));
      }
    }
  }

 private:
  static constexpr int kRowsPerPixel = 4;

  static double x_at(const MeshView& mesh, std::uint32_t edge, double y, const View& view) {
    const Position a = position_of(mesh.vertices[mesh.edges[edge].upper], view);
    const Position b = position_of(mesh.vertices[mesh.edges[edge].lower], view);
    return a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
  }

  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }

  void add_run(int row, double from, double to, Rgba tint) {
    from = std::clamp(from, 0.0, static_cast<double>(width_));
    to = std::clamp(to, 0.0, static_cast<double>(width_));
    for (int column = static_cast<int>(from); column < to; ++column) {
      const double share =
          (std::min(to, column + 1.0) - std::max<double>(from, column)) / kRowsPerPixel;
      Tinted& tinted = pixels_[index(row, column)];
      tinted.r += tint.r * share;
      tinted.g += tint.g * share;
      tinted.b += tint.b * share;
      tinted.share += share;
    }
  }

  int width_;
  int first_row_;
  int height_;
  std::vector<Tinted> pixels_;
};

/// A key and one of its values; when sorted, the values of a key are consecutive.
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

void sort_and_unite(Pairs& pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

/// Calls visit(number, its pairs) for every number. The pairs must be sorted.
template <class Visit>
void for_each_number(const Pairs& pairs, const Visit& visit) {
  for (auto begin = pairs.begin(); begin != pairs.end();) {
    const auto is_another = [&](const auto& pair) { return pair.first != begin->first; };
    const auto end = std::find_if(begin, pairs.end(), is_another);
    visit(begin->first, std::span(begin, end));
    begin = end;
  }
}

/// The vertices, ascending, where three or more features meet. Every edge has different features on
/// its two sides; if only one was found, the other side is outside.
std::vector<std::uint32_t> junctions_of(const MeshView& mesh, Pairs features_by_edge) {
  constexpr std::uint32_t kOutsideOfAll = 0xffffffff;
  sort_and_unite(features_by_edge);
  Pairs features_by_vertex;
  for_each_number(features_by_edge, [&](std::uint32_t edge, std::span<const Pairs::value_type> of) {
    for (const std::uint32_t v : {mesh.edges[edge].upper, mesh.edges[edge].lower}) {
      for (const auto& [same, feature] : of) features_by_vertex.emplace_back(v, feature);
      if (of.size() == 1) features_by_vertex.emplace_back(v, kOutsideOfAll);
    }
  });
  sort_and_unite(features_by_vertex);
  std::vector<std::uint32_t> junctions;
  for_each_number(features_by_vertex, [&](std::uint32_t v, std::span<const Pairs::value_type> of) {
    if (of.size() >= 3) junctions.push_back(v);
  });
  return junctions;
}

}  // namespace

void mark_mesh(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
               Rgba colour, Picture& picture) {
  for_each(ranges, mesh, [&](const MeshTrapezoid& t) {
    const Position top_left = on_edge(mesh, t.left, t.top, view);
    const Position top_right = on_edge(mesh, t.right, t.top, view);
    const Position bottom_left = on_edge(mesh, t.left, t.bottom, view);
    const Position bottom_right = on_edge(mesh, t.right, t.bottom, view);
    draw_line(top_left, bottom_left, colour, picture);
    draw_line(top_right, bottom_right, colour, picture);
    draw_line(bottom_left, bottom_right, colour, picture);
    draw_line(top_left, top_right, colour, picture);
  });
}

void mark_vertices(const MeshView& mesh, std::span<const TrapezoidRange> ranges, const View& view,
                   Rgba colour, Picture& picture) {
  std::vector<std::uint32_t> ends;
  for_each(ranges, mesh, [&](const MeshTrapezoid& t) {
    for (const std::uint32_t e : {t.left, t.right}) {
      ends.push_back(mesh.edges[e].upper);
      ends.push_back(mesh.edges[e].lower);
    }
  });
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  for (const std::uint32_t v : ends) {
    const Position p = position_of(mesh.vertices[v], view);
    if (!(p.x > -2 && p.y > -2 && p.x < picture.width + 2 && p.y < picture.height + 2)) continue;
    const int column = static_cast<int>(std::floor(p.x));
    const int row = static_cast<int>(std::floor(p.y));
    for (const int dy : {-1, 0, 1}) {
      for (const int dx : {-1, 0, 1}) blend(picture, column + dx, row + dy, colour, 1);
    }
  }
}

void mark_faces(const MeshView& mesh, std::span<const TrapezoidRange> ranges,
                const FeatureOf& feature_of, const View& view, Picture& picture) {
  constexpr int kRows = 256;
  for (int first = 0; first < picture.height; first += kRows) {
    TintSum sum(picture.width, first, std::min(kRows, picture.height - first));
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      sum.add(mesh, mesh.trapezoids[i], view, tint_of(feature_of(i)));
    });
    sum.blend_into(picture);
  }
}

void mark_junctions(const MeshView& mesh, std::span<const TrapezoidRange> ranges,
                    std::span<const TrapezoidRange> horizontal_edges, const FeatureOf& feature_of,
                    const View& view, Rgba colour, Picture& picture) {
  Pairs features_by_edge;
  for (const auto some : {ranges, horizontal_edges}) {
    for_each_trapezoid(some, [&](std::uint32_t i) {
      for (const std::uint32_t edge : {mesh.trapezoids[i].left, mesh.trapezoids[i].right}) {
        features_by_edge.emplace_back(edge, feature_of(i));
      }
    });
  }
  for (const std::uint32_t v : junctions_of(mesh, std::move(features_by_edge))) {
    const Position p = position_of(mesh.vertices[v], view);
    if (!(p.x > -3 && p.y > -3 && p.x < picture.width + 3 && p.y < picture.height + 3)) continue;
    const int column = static_cast<int>(std::floor(p.x));
    const int row = static_cast<int>(std::floor(p.y));
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        if (std::abs(dx) + std::abs(dy) < 3) blend(picture, column + dx, row + dy, colour, 1);
      }
    }
  }
}

void mark_border(Rgba colour, Picture& picture) {
  for (int i = 0; i < picture.width; ++i) {
    blend(picture, i, 0, colour, 1);
    blend(picture, i, picture.height - 1, colour, 1);
  }
  for (int i = 1; i + 1 < picture.height; ++i) {
    blend(picture, 0, i, colour, 1);
    blend(picture, picture.width - 1, i, colour, 1);
  }
}

}  // namespace trapeze
