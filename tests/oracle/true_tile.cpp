#include "tests/oracle/true_tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace trapeze::oracle {
namespace {

// Points around the tile are sampled, too: edges there may be hidden, and have lines that reach
// into the tile.
constexpr int kMargin = 3 * kPerPixel;
constexpr int kPoints = kPixels * kPerPixel + 2 * kMargin;  // along a side
// Hidden lines are determined at every second point.
constexpr int kTopStep = 2;
constexpr int kTops = kPoints / kTopStep;

// In points from the north-western corner of the sampled area; point k lies at k + 0.5.
struct Edge {
  Place from;
  Place to;
};

/// The first point that does not lie before a position.
int first_from(double place) {
  return static_cast<int>(std::clamp(std::ceil(place - 0.5), 0.0, static_cast<double>(kPoints)));
}

/// Calls visit(row, begin, end) for the points of rows 0 to `rows` that are within `radius` of an
/// edge; columns may lie outside.
template <typename Visit>
void visit_around(const Edge& edge, double radius, int rows, const Visit& visit) {
  const double dx = edge.to.x - edge.from.x;
  const double dy = edge.to.y - edge.from.y;
  const double length = std::sqrt(dx * dx + dy * dy);
  const double top = std::min(edge.from.y, edge.to.y) - radius;
  const double bottom = std::max(edge.from.y, edge.to.y) + radius;
  const int first = std::max(0, static_cast<int>(std::ceil(std::max(top, 0.0) - 0.5)));
  const int last = static_cast<int>(std::floor(std::min(bottom, rows + 1.0) - 0.5));
  // The corners of the rectangle around the edge, in order.
  const double nx = length > 0 ? -dy / length * radius : 0;
  const double ny = length > 0 ? dx / length * radius : 0;
  const std::array<Place, 4> corners = {
      Place{edge.from.x + nx, edge.from.y + ny}, Place{edge.to.x + nx, edge.to.y + ny},
      Place{edge.to.x - nx, edge.to.y - ny}, Place{edge.from.x - nx, edge.from.y - ny}};
  for (int row = first; row <= std::min(last, rows - 1); ++row) {
    const double y = row + 0.5;
    double west = std::numeric_limits<double>::infinity();
    double east = -west;
    const auto include = [&](double x) {
      west = std::min(west, x);
      east = std::max(east, x);
    };
    for (const Place end : {edge.from, edge.to}) {
      const double height = y - end.y;
      if (std::abs(height) > radius) continue;
      const double half = std::sqrt(radius * radius - height * height);
      include(end.x - half);
      include(end.x + half);
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Place a = corners[i];
      const Place b = corners[(i + 1) % corners.size()];
      if ((a.y <= y) != (b.y <= y)) include(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    if (west <= east) visit(row, west, east);
  }
}

PixelSum premultiplied(const Colour& colour, double share = 1) {
  const double a = colour.a * share;
  return {colour.r * a, colour.g * a, colour.b * a, a};
}

PixelSum over(const PixelSum& above, const PixelSum& below) {
  PixelSum sum;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = above[i] + below[i] * (1 - above[3]);
  return sum;
}

/// Adds up the points of pixels, in memory provided by the caller.
class Sums {
 public:
  explicit Sums(std::vector<PixelSum>& sums) : sums_(sums) { sums.assign(2 * kSize, PixelSum{}); }

  /// Adds points of a row that have the same colour.
  void add(int row, int begin, int end, const PixelSum& colour) {
    row -= kMargin;
    begin = std::max(begin - kMargin, 0);
    end = std::min(end - kMargin, kPixels * kPerPixel);
    if (begin >= end || row < 0 || row >= kPixels * kPerPixel) return;
    PixelSum* const line = sums_.data() + static_cast<std::size_t>(row / kPerPixel) * kColumns;
    PixelSum* const steps = line + kSize;
    const auto first = static_cast<std::size_t>(begin / kPerPixel);
    const auto last = static_cast<std::size_t>(end / kPerPixel);
    for (std::size_t i = 0; i < colour.size(); ++i) {
      line[first][i] -= begin % kPerPixel * colour[i];
      line[last][i] += end % kPerPixel * colour[i];
      steps[first][i] += kPerPixel * colour[i];
      steps[last][i] -= kPerPixel * colour[i];
    }
  }

  TruePicture finish() const {
    TruePicture picture;
    picture.pixels.resize(static_cast<std::size_t>(kPixels) * kPixels);
    for (std::size_t row = 0; row < kPixels; ++row) {
      PixelSum whole{};
      for (std::size_t column = 0; column < kPixels; ++column) {
        const std::size_t at = row * kColumns + column;
        PixelSum& pixel = picture.pixels[row * kPixels + column];
        for (std::size_t i = 0; i < whole.size(); ++i) {
          whole[i] += sums_[kSize + at][i];
          pixel[i] = (whole[i] + sums_[at][i]) / (kPerPixel * kPerPixel);
        }
      }
    }
    return picture;
  }

 private:
  static constexpr std::size_t kColumns = kPixels + 1;
  static constexpr std::size_t kSize = kColumns * kPixels;
  // First the values of pixels at the ends of spans, then those of all pixels from there on.
  std::vector<PixelSum>& sums_;
};

/// The ink of every point, from 0 to 255.
using Ink = std::vector<std::uint8_t>;
/// The number of the topmost opaque feature at every second point, counted from 1; 0 if there is
/// none.
using Top = std::vector<std::uint32_t>;

std::size_t index_of(int row, int column) {
  return static_cast<std::size_t>(row) * kPoints + static_cast<std::size_t>(column);
}

/// Where an outline enters or leaves a part, ordered by row, then by column.
struct Crossing {
  std::uint32_t row_and_column;
  std::uint32_t part;

  int row() const { return static_cast<int>(row_and_column >> 16); }
  int column() const { return static_cast<int>(row_and_column & 0xffff); }
  friend auto operator<=>(const Crossing&, const Crossing&) = default;
};

Crossing crossing(int row, int column, std::uint32_t part) {
  return {static_cast<std::uint32_t>(row) << 16 | static_cast<std::uint32_t>(column), part};
}

}  // namespace

struct TrueTile::Scene {
  struct Feature {
    const TrueFeature* source;
    std::size_t layer;
  };
  /// The fills of the features in a style.
  struct Fills {
    struct Fill {
      PixelSum colour;
      bool is_drawn;
      bool is_raised;
    };
    std::vector<Fill> by_feature;
  };
  /// The features at a point, by layer.
  using Actives = std::vector<std::vector<std::uint32_t>>;

  Window window;
  std::size_t layer_count;
  std::vector<Feature> features;          // those of one layer after those of the one below
  std::vector<std::uint32_t> feature_of;  // by part
  std::vector<Crossing> crossings;

  double scale() const { return kPixels * kPerPixel / window.side; }

  Place to_points(Place p) const {
    return {(p.x - window.corner.x) * scale() + kMargin,
            (p.y - window.corner.y) * scale() + kMargin};
  }

  Bounds bounds() const {
    const double margin = window.side * kMargin / (kPixels * kPerPixel);
    return {window.corner.x - margin, window.corner.y - margin,
            window.corner.x + window.side + margin, window.corner.y + window.side + margin};
  }

  template <typename Visit>
  void visit_edges(const TrueRing& ring, const Visit& visit) const {
    if (ring.places.empty()) return;
    const Place last = ring.places.back();
    Place from = to_points(last);
    Place source_from = last;
    for (const Place place : ring.places) {
      const Place to = to_points(place);
      visit(Edge{from, to}, source_from, place);
      from = to;
      source_from = place;
    }
  }

  void add_part(const TruePart& part, std::uint32_t number) {
    std::vector<bool> is_inside_from_west(kPoints, false);
    for (const TrueRing& ring : part.rings) {
      visit_edges(ring, [&](Edge edge, Place, Place) {
        auto [from, to] = edge;
        if (from.y > to.y) std::swap(from, to);
        if (to.y < 0 || from.y > kPoints || std::min(from.x, to.x) > kPoints) return;
        const int end = first_from(to.y);
        const double slope = (to.x - from.x) / (to.y - from.y);
        for (int row = first_from(from.y); row < end; ++row) {
          const int column = first_from(from.x + (row + 0.5 - from.y) * slope);
          if (column == 0) {
            is_inside_from_west[static_cast<std::size_t>(row)].flip();
          } else if (column < kPoints) {
            crossings.push_back(crossing(row, column, number));
          }
        }
      });
    }
    for (int row = 0; row < kPoints; ++row) {
      if (is_inside_from_west[static_cast<std::size_t>(row)]) {
        crossings.push_back(crossing(row, 0, number));
      }
    }
  }

  /// Calls visit(row, begin, end, features) for all spans of points that lie in the same features,
  /// or in none.
  template <typename Visit>
  void visit_spans(const Visit& visit) const {
    std::vector<bool> is_in_part(feature_of.size(), false);
    std::vector<std::uint32_t> parts_around(features.size(), 0);
    Actives actives(layer_count);
    std::size_t i = 0;
    for (int row = 0; row < kPoints; ++row) {
      const std::size_t row_begin = i;
      int begin = 0;
      const auto is_in_row = [&] { return i < crossings.size() && crossings[i].row() == row; };
      while (is_in_row()) {
        const int column = crossings[i].column();
        if (column > begin) visit(row, begin, column, actives);
        begin = column;
        for (; is_in_row() && crossings[i].column() == column; ++i) {
          cross(crossings[i].part, is_in_part, parts_around, actives);
        }
      }
      visit(row, begin, kPoints, actives);
      for (std::size_t k = row_begin; k < i; ++k) {
        is_in_part[crossings[k].part] = false;
        parts_around[feature_of[crossings[k].part]] = 0;
      }
      for (auto& some : actives) some.clear();
    }
  }

  void cross(std::uint32_t part, std::vector<bool>& is_in_part,
             std::vector<std::uint32_t>& parts_around, Actives& actives) const {
    const std::uint32_t feature = feature_of[part];
    std::vector<std::uint32_t>& some = actives[features[feature].layer];
    const auto at = std::ranges::lower_bound(some, feature);
    is_in_part[part] = !is_in_part[part];
    if (is_in_part[part]) {
      if (parts_around[feature]++ == 0) some.insert(at, feature);
    } else if (--parts_around[feature] == 0) {
      some.erase(at);
    }
  }

  Fills fills_of(const std::vector<TruePaint>& paints) const {
    if (paints.size() != layer_count) throw std::invalid_argument("a paint for every layer");
    Fills fills;
    for (const Feature& feature : features) {
      const TrueFill fill = paints[feature.layer].fill_of(*feature.source);
      fills.by_feature.push_back({premultiplied(fill.colour), fill.is_drawn, fill.is_raised});
    }
    return fills;
  }

  static PixelSum fill_at(const std::vector<std::uint32_t>& some, const Fills& fills) {
    PixelSum sum{};
    for (const bool is_raised : {false, true}) {
      for (const std::uint32_t number : some) {
        const Fills::Fill& fill = fills.by_feature[number];
        if (fill.is_drawn && fill.is_raised == is_raised) sum = over(fill.colour, sum);
      }
    }
    return sum;
  }

  /// For the features of one layer.
  void find_top(std::size_t layer, const Fills& fills, Top& top) const {
    top.assign(static_cast<std::size_t>(kTops) * kTops, 0);
    visit_spans([&](int row, int begin, int end, const Actives& actives) {
      if (row % kTopStep != 0) return;
      std::uint32_t topmost = 0;
      for (const bool is_raised : {false, true}) {
        for (const std::uint32_t number : actives[layer]) {
          const Fills::Fill& fill = fills.by_feature[number];
          const bool counts = fill.is_drawn && fill.is_raised == is_raised && fill.colour[3] == 1;
          if (counts) topmost = number + 1;
        }
      }
      if (topmost == 0) return;
      const auto line = top.begin() + static_cast<std::ptrdiff_t>(row / kTopStep) * kTops;
      std::fill(line + (begin + 1) / kTopStep, line + (end + 1) / kTopStep, topmost);
    });
  }

  void draw_lines(std::size_t layer, const TruePaint& paint, const Fills& fills, Top& top,
                  Ink& ink) const {
    find_top(layer, fills, top);
    ink.assign(static_cast<std::size_t>(kPoints) * kPoints, 0);
    for (std::uint32_t number = 0; number < features.size(); ++number) {
      if (features[number].layer != layer || !fills.by_feature[number].is_drawn) continue;
      const Fills::Fill& own = fills.by_feature[number];
      // Whether an opaque feature lies over this one at a point.
      const auto is_over = [&](double x, double y) {
        const auto column = static_cast<int>(std::floor(x / kTopStep));
        const auto row = static_cast<int>(std::floor(y / kTopStep));
        if (row < 0 || column < 0 || row >= kTops || column >= kTops) return true;
        const std::uint32_t other =
            top[static_cast<std::size_t>(row) * kTops + static_cast<std::size_t>(column)];
        if (own.colour[3] < 1 || other == 0) return false;
        const bool is_raised = fills.by_feature[other - 1].is_raised;
        return is_raised == own.is_raised ? other - 1 > number : is_raised;
      };
      for (const TruePart& part : features[number].source->parts) {
        for (const TrueRing& ring : part.rings) {
          const double extent = ring.extent * scale() / kPerPixel;
          const double share = std::min(extent / (4 * paint.line_width), 1.0);
          const auto value = static_cast<std::uint8_t>(std::lround(255 * share));
          visit_edges(ring, [&](const Edge& edge, Place from, Place to) {
            if (value == 0 || is_on_edge_of_world(from, to)) return;
            const double radius = paint.line_width * kPerPixel / 2;
            visit_seen(edge, radius, is_over,
                       [&](const Edge& seen) { draw_line(seen, radius, value, ink); });
          });
        }
      }
    }
  }

  static bool is_on_edge_of_world(Place a, Place b) {
    const double pole = place_of_lonlat(0, 85.045).y;
    const auto is_pole = [pole](Place p) { return p.y <= pole || p.y >= 1 - pole; };
    return (a.x == b.x && (a.x == 0 || a.x == 1)) || (is_pole(a) && is_pole(b));
  }

  /// Calls visit(edge) for the visible pieces of an edge: those where is_over(x, y) is false on at
  /// least one side.
  template <typename IsOver, typename Visit>
  static void visit_seen(const Edge& edge, double radius, const IsOver& is_over,
                         const Visit& visit) {
    const double dx = edge.to.x - edge.from.x;
    const double dy = edge.to.y - edge.from.y;
    const double length = std::sqrt(dx * dx + dy * dy);
    double begin = 0;
    double end = 1;
    const auto clip = [&](double at, double by) {
      const double low = (-radius - at) / by;
      const double high = (kPoints + radius - at) / by;
      begin = std::max(begin, std::min(low, high));
      end = std::min(end, std::max(low, high));
    };
    const auto is_off = [radius](double a, double b) {
      return std::max(a, b) < -radius || std::min(a, b) > kPoints + radius;
    };
    if (is_off(edge.from.x, edge.to.x) || is_off(edge.from.y, edge.to.y)) return;
    if (std::abs(dx) > 1e-9) clip(edge.from.x, dx);
    if (std::abs(dy) > 1e-9) clip(edge.from.y, dy);
    if (begin > end || length == 0) return;
    const auto at = [&](double share) {
      return Place{edge.from.x + share * dx, edge.from.y + share * dy};
    };
    const double nx = -dy / length * kTopStep;
    const double ny = dx / length * kTopStep;
    const auto is_seen = [&](double share) {
      const Place p = at(share);
      return !is_over(p.x + nx, p.y + ny) || !is_over(p.x - nx, p.y - ny);
    };
    const int steps = std::max(1, static_cast<int>(std::ceil(length * (end - begin))));
    const double step = (end - begin) / steps;
    int seen_from = -1;
    for (int i = 0; i <= steps; ++i) {
      const bool seen = i < steps && is_seen(begin + (i + 0.5) * step);
      if (seen && seen_from < 0) seen_from = i;
      if (!seen && seen_from >= 0) {
        visit(Edge{at(begin + seen_from * step), at(begin + i * step)});
        seen_from = -1;
      }
    }
  }

  static void draw_line(const Edge& edge, double radius, std::uint8_t value, Ink& ink) {
    visit_around(edge, radius, kPoints, [&](int row, double west, double east) {
      const int begin = first_from(west);
      const int end = first_from(east);
      std::uint8_t* const line = ink.data() + index_of(row, 0);
      for (int column = begin; column < end; ++column) {
        line[column] = std::max(line[column], value);
      }
    });
  }
};

// A picture of one style while it is painted.
class TrueTile::Painting {
 public:
  /// `inks` counts those that other paintings need; one is added for each layer with lines.
  Painting(const Scene& scene, const std::vector<TruePaint>& paints, Workspace& workspace,
           std::size_t& inks, std::vector<PixelSum>& sums)
      : paints_(paints), fills_(scene.fills_of(paints)), sums_(sums) {
    for (std::size_t layer = 0; layer < paints.size(); ++layer) {
      ink_.push_back(nullptr);
      if (paints[layer].line_width == 0) continue;
      has_lines_ = true;
      if (inks == workspace.ink.size()) workspace.ink.emplace_back();
      Ink& ink = workspace.ink[inks++];
      scene.draw_lines(layer, paints[layer], fills_, workspace.top, ink);
      ink_.back() = ink.data();
    }
  }

  void add(int row, int begin, int end, const Scene::Actives& actives) {
    bool is_empty = true;
    std::vector<PixelSum>& fills = fills_at_;
    fills.clear();
    for (const std::vector<std::uint32_t>& some : actives) {
      fills.push_back(Scene::fill_at(some, fills_));
      is_empty = is_empty && fills.back()[3] == 0;
    }
    if (!has_lines_) {
      if (!is_empty) sums_.add(row, begin, end, laid_together(fills, row, begin));
      return;
    }
    while (begin < end) {
      const int next = end_of_run(row, begin, end);
      sums_.add(row, begin, next, laid_together(fills, row, begin));
      begin = next;
    }
  }

  TruePicture finish() const { return sums_.finish(); }

 private:
  PixelSum laid_together(const std::vector<PixelSum>& fills, int row, int column) const {
    PixelSum sum{};
    for (std::size_t layer = 0; layer < fills.size(); ++layer) {
      PixelSum colour = fills[layer];
      if (ink_[layer] != nullptr) {
        const double share = ink_[layer][index_of(row, column)] / 255.0;
        colour = over(premultiplied(paints_[layer].line, share), colour);
      }
      for (double& value : colour) value *= paints_[layer].opacity;
      sum = over(colour, sum);
    }
    return sum;
  }

  /// The end of the run of points that have the same ink as the first one.
  int end_of_run(int row, int begin, int end) const {
    for (const std::uint8_t* const ink : ink_) {
      if (ink == nullptr) continue;
      const std::uint8_t* const line = ink + index_of(row, 0);
      int next = begin + 1;
      // Compares eight points at a time as long as they are equal.
      const std::uint64_t same = line[begin] * std::uint64_t{0x0101010101010101};
      for (std::uint64_t eight = same; next + 8 <= end; next += 8) {
        std::memcpy(&eight, line + next, sizeof eight);
        if (eight != same) break;
      }
      while (next < end && line[next] == line[begin]) ++next;
      end = next;
    }
    return end;
  }

  const std::vector<TruePaint>& paints_;
  Scene::Fills fills_;
  bool has_lines_ = false;
  std::vector<const std::uint8_t*> ink_;  // by layer; null without a line
  Sums sums_;
  std::vector<PixelSum> fills_at_;
};

Window window_of(TileName name) {
  const double side = std::exp2(-name.zoom);
  return {{name.x * side, name.y * side}, side};
}

TrueTile::TrueTile(std::span<const TrueLayer* const> layers, TileName name)
    : TrueTile(layers, window_of(name)) {}

TrueTile::TrueTile(std::span<const TrueLayer* const> layers, const Window& window)
    : scene_(std::make_unique<Scene>()) {
  scene_->window = window;
  scene_->layer_count = layers.size();
  const Bounds bounds = scene_->bounds();
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    for (const TrueFeature& feature : layers[layer]->features) {
      if (!feature.bounds.meets(bounds)) continue;
      const auto number = static_cast<std::uint32_t>(scene_->features.size());
      scene_->features.push_back({&feature, layer});
      for (const TruePart& part : feature.parts) {
        if (!part.bounds.meets(bounds)) continue;
        scene_->feature_of.push_back(number);
        scene_->add_part(part, static_cast<std::uint32_t>(scene_->feature_of.size() - 1));
      }
    }
  }
  std::ranges::sort(scene_->crossings);
}

TrueTile::~TrueTile() = default;
TrueTile::TrueTile(TrueTile&&) noexcept = default;

std::vector<TruePicture> TrueTile::paint(std::span<const std::vector<TruePaint>> styles,
                                         Workspace& workspace) const {
  std::vector<Painting> paintings;
  std::size_t inks = 0;
  workspace.ink.reserve(styles.size() * scene_->layer_count);  // pointers to them stay valid
  if (workspace.sums.size() < styles.size()) workspace.sums.resize(styles.size());
  for (std::size_t i = 0; i < styles.size(); ++i) {
    paintings.emplace_back(*scene_, styles[i], workspace, inks, workspace.sums[i]);
  }
  scene_->visit_spans([&](int row, int begin, int end, const Scene::Actives& actives) {
    for (Painting& painting : paintings) painting.add(row, begin, end, actives);
  });
  std::vector<TruePicture> pictures;
  for (const Painting& painting : paintings) pictures.push_back(painting.finish());
  return pictures;
}

std::vector<bool> TrueTile::near_edges(double distance) const {
  std::vector<bool> near(static_cast<std::size_t>(kPixels) * kPixels, false);
  const auto to_pixels = [](Place p) {
    return Place{(p.x - kMargin) / kPerPixel, (p.y - kMargin) / kPerPixel};
  };
  const auto mark = [&](int row, double west, double east) {
    const int begin = static_cast<int>(std::ceil(std::max(west, 0.0) - 0.5));
    const int end = static_cast<int>(std::floor(std::min(east, kPixels + 0.0) + 0.5));
    for (int column = begin; column < end; ++column) {
      near[static_cast<std::size_t>(row) * kPixels + static_cast<std::size_t>(column)] = true;
    }
  };
  for (const Scene::Feature& feature : scene_->features) {
    for (const TruePart& part : feature.source->parts) {
      for (const TrueRing& ring : part.rings) {
        scene_->visit_edges(ring, [&](const Edge& edge, Place, Place) {
          visit_around({to_pixels(edge.from), to_pixels(edge.to)}, distance, kPixels, mark);
        });
      }
    }
  }
  return near;
}

std::vector<const TrueFeature*> TrueTile::features(std::size_t layer) const {
  std::vector<bool> is_inside(scene_->features.size(), false);
  for (const Crossing& one : scene_->crossings) is_inside[scene_->feature_of[one.part]] = true;
  std::vector<const TrueFeature*> some;
  for (std::size_t i = 0; i < is_inside.size(); ++i) {
    const Scene::Feature& feature = scene_->features[i];
    if (is_inside[i] && feature.layer == layer) some.push_back(feature.source);
  }
  return some;
}

}  // namespace trapeze::oracle
