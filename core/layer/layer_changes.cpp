#include "core/layer/layer_changes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <compare>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include "core/grid/digest.h"
#include "core/grid/set_hash.h"
#include "core/layer/layer_contents.h"

namespace trapeze {
namespace {

constexpr Lifespan kAlways{0, kNeverDies};

std::uint64_t word_of(Point p) {
  return std::uint64_t{static_cast<std::uint32_t>(p.x)} << 32 | static_cast<std::uint32_t>(p.y);
}

std::uint64_t hash_of(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  Digester digester;
  for (const std::uint64_t word : {a, b, c}) digester.add(word);
  return digester.digest().low;
}

std::uint64_t hash_of(std::string_view text) {
  Digester digester;
  for (const char c : text) digester.add(static_cast<unsigned char>(c));
  return digester.digest().low;
}

std::uint64_t hash_of(const Value& value) {
  if (const auto* text = std::get_if<std::string_view>(&value)) return hash_of(*text);
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return hash_of(static_cast<std::uint64_t>(*integer), 1, 1);
  }
  const auto* real = std::get_if<double>(&value);
  return real == nullptr ? 0 : hash_of(std::bit_cast<std::uint64_t>(*real), 2, 2);
}

using HashedPlaces = std::vector<std::pair<std::uint64_t, LayerChanges::Place>>;

/// The content of a layer that is compared.
class Summary {
 public:
  Summary(const LayerWithFeatures& state, Ids ids)
      : layer_(state.layer), features_(state.features) {
    hash_edges();
    hash_identities(ids);
    hash_features();
  }

  /// The features whose hashes occur more often here than there.
  std::vector<std::uint32_t> rows_without_equal(const Summary& other) const;
  /// Appends the sides of these features, with weights of that sign.
  void append_sides(std::span<const std::uint32_t> rows, bool is_after,
                    std::vector<LayerChanges::Side>& sides) const;
  /// Appends sides without height, along which only outlines are drawn, and dust, feature by
  /// feature.
  void append_places(std::span<const std::uint32_t> rows, HashedPlaces& places) const;
  /// Appends the trapezoids that represent dust shared by features.
  void append_motes(HashedPlaces& places) const;
  void append_pairs(HashedPlaces& places) const;

 private:
  struct HashedRow {
    Digest digest;
    std::uint32_t row;

    auto operator<=>(const HashedRow&) const = default;
  };

  void hash_edges();
  void hash_identities(Ids ids);
  void hash_features();
  std::vector<HashedRow> sorted_rows() const;
  std::vector<char> marked(std::span<const std::uint32_t> rows) const;
  std::size_t rows() const { return features_.size(); }
  const MeshView& mesh() const { return layer_.mesh(); }
  const LayerContents& contents() const { return layer_.contents(); }
  /// Calls visit(trapezoid) for all trapezoids of one of the kinds that exist at some level.
  template <typename Visit>
  void for_each(MeshIndex MeshSegment::*kind, const Visit& visit) const;
  std::uint64_t spans_of(std::size_t trapezoid) const;

  const Layer& layer_;
  const FeatureTable& features_;
  std::vector<std::uint64_t> edge_hashes_;
  std::vector<std::uint64_t> outlines_;    // by edge, see LayerChanges::Side::outline
  std::vector<std::uint64_t> identities_;  // by row: of attributes, and of ids if they matter
  std::vector<SetHash> hashes_;            // by row
  std::vector<Box> boxes_;                 // by row
};

void Summary::hash_edges() {
  const OutlineView& outline = layer_.outline();
  std::vector<std::uint64_t> along(mesh().vertices.size(), 0);  // by vertex
  for (std::size_t v = 0; v < std::min(along.size(), outline.milestone_ends.size()); ++v) {
    const std::uint32_t begin = v == 0 ? 0 : outline.milestone_ends[v - 1];
    for (std::uint32_t i = begin; i < outline.milestone_ends[v]; ++i) {
      along[v] = hash_of(along[v], outline.milestones[i], outline.milestone_levels[i]);
    }
  }
  edge_hashes_.reserve(mesh().edges.size());
  outlines_.reserve(mesh().edges.size());
  for (std::uint32_t e = 0; e < mesh().edges.size(); ++e) {
    const MeshEdge& edge = mesh().edges[e];
    outlines_.push_back(hash_of(along[edge.upper], along[edge.lower], outline.loop_size(e)));
    edge_hashes_.push_back(hash_of(word_of(mesh().vertices[edge.upper]),
                                   word_of(mesh().vertices[edge.lower]), outlines_.back()));
  }
}

void Summary::hash_identities(Ids ids) {
  std::vector<std::uint64_t> names;
  for (const Field& field : features_.fields())
    names.push_back(hash_of(std::string_view(field.name)));
  identities_.reserve(rows());
  for (std::uint32_t row = 0; row < rows(); ++row) {
    SetHash hash;
    if (ids == Ids::matter) hash.add({static_cast<std::uint64_t>(features_.id(row)), 0, 0});
    for (std::size_t i = 0; i < names.size(); ++i) {
      hash.add({names[i], hash_of(features_.value(row, static_cast<int>(i))), 1});
    }
    identities_.push_back(hash.digest().low | 1);  // no multiple of it is 0, except that by 2^64
  }
}

template <typename Visit>
void Summary::for_each(MeshIndex MeshSegment::*kind, const Visit& visit) const {
  for (const auto& segment : contents().segments) {
    const TrapezoidRange range = ((*segment).*kind).range();
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      const Lifespan lifespan = contents().lifespans[i];
      if (lifespan.born < lifespan.dies) visit(i);
    }
  }
}

/// The heights of a trapezoid, and its lifespan.
std::uint64_t Summary::spans_of(std::size_t trapezoid) const {
  const MeshTrapezoid& t = mesh().trapezoids[trapezoid];
  const Lifespan lifespan = contents().lifespans[trapezoid];
  const auto y = [this](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(mesh().vertices[vertex].y);
  };
  return hash_of(y(t.top), y(t.bottom),
                 std::uint64_t{lifespan.born} << 32 | std::uint64_t{lifespan.dies});
}

void Summary::hash_features() {
  hashes_.resize(rows());
  boxes_.resize(rows());
  for (std::uint32_t row = 0; row < rows(); ++row) hashes_[row].add({identities_[row], 0, 0});
  const auto add = [this](std::uint32_t i) {
    const std::uint32_t row = contents().feature_of[i];
    if (row >= rows()) return;
    const MeshTrapezoid& t = mesh().trapezoids[i];
    hashes_[row].add({edge_hashes_[t.left], edge_hashes_[t.right], spans_of(i)});
    for (const std::uint32_t edge : {t.left, t.right}) {
      boxes_[row].include(mesh().vertices[mesh().edges[edge].upper]);
      boxes_[row].include(mesh().vertices[mesh().edges[edge].lower]);
    }
  };
  for_each(&MeshSegment::polygons, add);
  for_each(&MeshSegment::horizontal_edges, add);
  for (const FeatureGrain& grain : layer_.grains().grains()) {
    if (grain.row >= rows()) continue;
    hashes_[grain.row].add(
        {word_of(grain.from), word_of(grain.to),
         hash_of(static_cast<std::uint64_t>(grain.doubled_area), grain.born, 2)});
    boxes_[grain.row].include(grain.box());
  }
}

std::vector<Summary::HashedRow> Summary::sorted_rows() const {
  std::vector<HashedRow> sorted;
  sorted.reserve(rows());
  for (std::uint32_t row = 0; row < rows(); ++row) {
    sorted.push_back({hashes_[row].digest(), row});
  }
  std::ranges::sort(sorted);
  return sorted;
}

std::vector<std::uint32_t> Summary::rows_without_equal(const Summary& other) const {
  const std::vector<HashedRow> here = sorted_rows();
  const std::vector<HashedRow> there = other.sorted_rows();
  std::vector<std::uint32_t> without;
  auto equal = there.begin();
  for (const HashedRow& one : here) {
    while (equal != there.end() && equal->digest < one.digest) ++equal;
    if (equal != there.end() && equal->digest == one.digest) {
      ++equal;
    } else {
      without.push_back(one.row);
    }
  }
  return without;
}

std::vector<char> Summary::marked(std::span<const std::uint32_t> rows) const {
  std::vector<char> is_marked(this->rows(), 0);
  for (const std::uint32_t row : rows) is_marked[row] = 1;
  return is_marked;
}

void Summary::append_sides(std::span<const std::uint32_t> rows, bool is_after,
                           std::vector<LayerChanges::Side>& sides) const {
  const std::vector<char> is_wanted = marked(rows);
  for_each(&MeshSegment::polygons, [&](std::uint32_t i) {
    const std::uint32_t row = contents().feature_of[i];
    if (row >= is_wanted.size() || is_wanted[row] == 0) return;
    const MeshTrapezoid& t = mesh().trapezoids[i];
    const std::int32_t top = mesh().vertices[t.top].y;
    const std::int32_t bottom = mesh().vertices[t.bottom].y;
    if (top == bottom) return;
    const std::uint64_t weight = is_after ? identities_[row] : -identities_[row];
    for (const bool is_right : {false, true}) {
      const std::uint32_t edge = is_right ? t.right : t.left;
      const MeshEdge& ends = mesh().edges[edge];
      sides.push_back({mesh().vertices[ends.upper], mesh().vertices[ends.lower], top, bottom,
                       contents().lifespans[i], outlines_[edge], is_right ? -weight : weight});
    }
  });
}

void Summary::append_places(std::span<const std::uint32_t> rows, HashedPlaces& places) const {
  const std::vector<char> is_wanted = marked(rows);
  for_each(&MeshSegment::horizontal_edges, [&](std::uint32_t i) {
    const std::uint32_t row = contents().feature_of[i];
    if (row >= is_wanted.size() || is_wanted[row] == 0) return;
    const MeshEdge& ends = mesh().edges[mesh().trapezoids[i].left];
    Box box;
    box.include(mesh().vertices[ends.upper]);
    box.include(mesh().vertices[ends.lower]);
    places.emplace_back(
        hash_of(edge_hashes_[mesh().trapezoids[i].left], spans_of(i), identities_[row]),
        LayerChanges::Place{box, contents().lifespans[i]});
  });
  for (const FeatureGrain& grain : layer_.grains().grains()) {
    if (grain.row >= is_wanted.size() || is_wanted[grain.row] == 0) continue;
    const std::uint64_t axis = hash_of(word_of(grain.from), word_of(grain.to), grain.born);
    places.emplace_back(
        hash_of(axis, static_cast<std::uint64_t>(grain.doubled_area), identities_[grain.row]),
        LayerChanges::Place{grain.box(), {static_cast<Level>(grain.born), kNeverDies}});
  }
}

void Summary::append_motes(HashedPlaces& places) const {
  const auto add = [&](std::uint32_t i) {
    const MeshTrapezoid& t = mesh().trapezoids[i];
    places.emplace_back(hash_of(edge_hashes_[t.left], edge_hashes_[t.right], spans_of(i)),
                        LayerChanges::Place{box_of(mesh(), t), contents().lifespans[i], true});
  };
  for_each(&MeshSegment::motes, add);
  for_each(&MeshSegment::merged_motes, add);
}

void Summary::append_pairs(HashedPlaces& places) const {
  for (const FeatureOverlap& pair : layer_.overlaps().pairs()) {
    if (pair.row > pair.other) continue;  // the one above
    places.emplace_back(hash_of(hashes_[pair.row].digest().low, hashes_[pair.other].digest().low,
                                std::uint64_t{pair.width} << 32 | pair.along),
                        LayerChanges::Place{boxes_[pair.row], kAlways, false, boxes_[pair.other]});
  }
}

/// Appends the places that one of the states has more often than the other.
void append_different(HashedPlaces& before, HashedPlaces& after,
                      std::vector<LayerChanges::Place>& places) {
  const auto hash = [](const auto& item) { return item.first; };
  std::ranges::sort(before, {}, hash);
  std::ranges::sort(after, {}, hash);
  auto a = before.begin();
  auto b = after.begin();
  while (a != before.end() || b != after.end()) {
    if (b == after.end() || (a != before.end() && a->first < b->first)) {
      places.push_back((a++)->second);
    } else if (a == before.end() || b->first < a->first) {
      places.push_back((b++)->second);
    } else {
      ++a;
      ++b;
    }
  }
}

/// A piece of an edge along which something differs.
struct Piece {
  Point upper;
  Point lower;
  std::int64_t top;
  std::int64_t bottom;
  std::uint64_t weight;

  double x_at(double y) const { return EdgeLine(upper, lower).x_at(y); }
};

/// The pieces of edges at a level that only one of the states has.
std::vector<Piece> pieces_at(const LayerChanges& changes, Level level) {
  using Side = LayerChanges::Side;
  std::vector<const Side*> alive;
  for (const Side& side : changes.sides) {
    if (side.lifespan.contains(level)) alive.push_back(&side);
  }
  const auto edge_of = [](const Side* side) {
    return std::tuple(side->upper.y, side->upper.x, side->lower.y, side->lower.x, side->outline);
  };
  std::ranges::sort(alive, {}, edge_of);
  std::vector<Piece> pieces;
  std::vector<std::pair<std::int32_t, std::uint64_t>> steps;
  for (auto begin = alive.begin(); begin != alive.end();) {
    const auto end = std::find_if(
        begin, alive.end(), [&](const Side* side) { return edge_of(side) != edge_of(*begin); });
    steps.clear();
    for (auto side = begin; side != end; ++side) {
      steps.emplace_back((*side)->top, (*side)->weight);
      steps.emplace_back((*side)->bottom, -(*side)->weight);
    }
    std::ranges::sort(steps);
    std::uint64_t weight = 0;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
      weight += steps[i].second;
      if (weight == 0 || steps[i].first == steps[i + 1].first) continue;
      pieces.push_back(
          {(*begin)->upper, (*begin)->lower, steps[i].first, steps[i + 1].first, weight});
    }
    begin = end;
  }
  return pieces;
}

/// Marks tiles of one zoom.
class TileMarks {
 public:
  TileMarks(const TileDrawing& drawing, std::size_t most)
      : zoom_(drawing.zoom),
        reach_(drawing.reach),
        side_(TileId{drawing.zoom, 0, 0}.side()),
        last_((std::int64_t{1} << drawing.zoom) - 1),
        most_(most) {}

  /// Marks the tiles of the place and those near it.
  void mark(const LayerChanges::Place& place) {
    Range range = range_of(place.box);
    if (!place.other.is_empty()) {
      const Range other = range_of(place.other);
      range = {std::max(range.first_row, other.first_row), std::min(range.last_row, other.last_row),
               std::max(range.first_column, other.first_column),
               std::min(range.last_column, other.last_column)};
    }
    for (std::int64_t row = range.first_row; row <= range.last_row; ++row) {
      mark_row(row, range.first_column, range.last_column);
    }
  }
  /// Marks the tiles that the piece comes near to.
  void mark(const Piece& piece) {
    const std::int64_t last_row = tile_at(static_cast<double>(piece.bottom) + reach_);
    for (std::int64_t row = tile_at(static_cast<double>(piece.top) - reach_); row <= last_row;
         ++row) {
      const double north = static_cast<double>(north_of(row)) - reach_;
      const double south = static_cast<double>(north_of(row + 1)) + reach_;
      const double from = piece.x_at(std::max(north, static_cast<double>(piece.top)));
      const double to = piece.x_at(std::min(south, static_cast<double>(piece.bottom)));
      mark_row(row, tile_at(std::min(from, to) - reach_), tile_at(std::max(from, to) + reach_));
    }
  }
  /// Determines from which tile on, in the rows that it passes, the piece counts for everything
  /// east of it.
  void cover(const Piece& piece) {
    const std::int64_t last_row = tile_at(static_cast<double>(piece.bottom - 1));
    for (std::int64_t row = tile_at(static_cast<double>(piece.top)); row <= last_row; ++row) {
      const std::int64_t from = std::max(north_of(row), piece.top);
      const std::int64_t to = std::min(north_of(row + 1), piece.bottom);
      if (from >= to) continue;
      const double east =
          std::max(piece.x_at(static_cast<double>(from)), piece.x_at(static_cast<double>(to)));
      steps_.push_back({row, tile_at(east), piece.weight * static_cast<std::uint64_t>(to - from)});
    }
  }
  std::vector<TileId> take() {
    mark_covered();
    sort_and_part();
    std::vector<TileId> tiles;
    tiles.reserve(keys_.size());
    for (const std::uint64_t key : keys_) {
      tiles.push_back(
          {zoom_, static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
    }
    return tiles;
  }

 private:
  struct Step {
    std::int64_t row;
    std::int64_t column;
    std::uint64_t weight;
  };

  struct Range {
    std::int64_t first_row;
    std::int64_t last_row;
    std::int64_t first_column;
    std::int64_t last_column;
  };

  Range range_of(const Box& box) const {
    return {tile_at(box.min_y - reach_), tile_at(box.max_y + reach_), tile_at(box.min_x - reach_),
            tile_at(box.max_x + reach_)};
  }
  std::int64_t tile_at(double cells) const {
    const auto tile =
        static_cast<std::int64_t>(std::floor((cells - kGridMin) / static_cast<double>(side_)));
    return std::clamp<std::int64_t>(tile, 0, last_);
  }
  std::int64_t north_of(std::int64_t row) const { return kGridMin + row * side_; }

  void mark_row(std::int64_t row, std::int64_t first, std::int64_t last) {
    if (last < first) return;
    if (static_cast<std::size_t>(last - first) >= 2 * most_) throw_too_many();
    for (std::int64_t column = first; column <= last; ++column) {
      keys_.push_back(static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint64_t>(column));
    }
    if (keys_.size() > 4 * most_ + 4096) {
      sort_and_part();
      if (keys_.size() > most_) throw_too_many();
    }
  }
  void mark_covered() {
    std::ranges::sort(steps_, {},
                      [](const Step& step) { return std::pair(step.row, step.column); });
    std::uint64_t weight = 0;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      weight = i > 0 && steps_[i - 1].row == steps_[i].row ? weight : 0;
      weight += steps_[i].weight;
      const bool goes_on = i + 1 < steps_.size() && steps_[i + 1].row == steps_[i].row;
      const std::int64_t end = goes_on ? steps_[i + 1].column : steps_[i].column;
      if (weight != 0) mark_row(steps_[i].row, steps_[i].column + 1, end);
    }
  }
  void sort_and_part() {
    std::ranges::sort(keys_);
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    if (keys_.size() > most_) throw_too_many();
  }
  [[noreturn]] void throw_too_many() const {
    throw std::length_error("more tiles of zoom " + std::to_string(zoom_) +
                            " may have changed than " + std::to_string(most_));
  }

  int zoom_;
  double reach_;
  std::int64_t side_;
  std::int64_t last_;
  std::size_t most_;
  std::vector<std::uint64_t> keys_;
  std::vector<Step> steps_;
};

}  // namespace

LayerChanges changes_between(const Layer& before, const Layer& after, Ids ids) {
  return changes_between(LayerWithFeatures{before, before.features()},
                         LayerWithFeatures{after, after.features()}, ids);
}

LayerChanges changes_between(const LayerWithFeatures& before, const LayerWithFeatures& after,
                             Ids ids) {
  LayerChanges changes;
  const Summary of_before(before, ids);
  const Summary of_after(after, ids);
  const auto rows_before = of_before.rows_without_equal(of_after);
  const auto rows_after = of_after.rows_without_equal(of_before);
  of_before.append_sides(rows_before, false, changes.sides);
  of_after.append_sides(rows_after, true, changes.sides);
  HashedPlaces places_before;
  HashedPlaces places_after;
  of_before.append_places(rows_before, places_before);
  of_after.append_places(rows_after, places_after);
  of_before.append_motes(places_before);
  of_after.append_motes(places_after);
  of_before.append_pairs(places_before);
  of_after.append_pairs(places_after);
  append_different(places_before, places_after, changes.places);
  return changes;
}

std::vector<TileId> tiles_with_changes(const LayerChanges& changes, const TileDrawing& drawing,
                                       std::size_t most) {
  TileMarks marks(drawing, most);
  for (const Piece& piece : pieces_at(changes, drawing.level)) {
    marks.mark(piece);
    marks.cover(piece);
  }
  const Level resolution = std::min(drawing.level, drawing.pixel_level);
  for (const LayerChanges::Place& place : changes.places) {
    if (!place.lifespan.contains(place.is_dust ? resolution : drawing.level)) continue;
    if (!place.box.is_empty()) marks.mark(place);
  }
  return marks.take();
}

}  // namespace trapeze
