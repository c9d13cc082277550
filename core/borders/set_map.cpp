#include "core/borders/set_map.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "core/grid/item_count.h"
#include "core/sweep/noding.h"
#include "core/sweep/owned_segments.h"

namespace trapeze {
namespace {

/// A segment that occurs twice in a feature is no border of it: both its sides are inside, or both
/// are outside.
Borders unite_pieces(const LargeArray<OwnedSegment>& pieces, FeatureSets& sets) {
  Borders borders;
  borders.segments.reserve(pieces.size());
  borders.owners.reserve(pieces.size());
  std::vector<std::uint32_t> owners;
  for (std::size_t i = 0; i < pieces.size();) {
    const Segment& segment = pieces[i].segment;
    const std::size_t begin = i;
    while (i < pieces.size() && pieces[i].segment == segment) ++i;
    std::uint32_t set = 0;
    if (i == begin + 1) {
      set = sets.number_of_one(pieces[begin].owner);
    } else {
      owners.clear();
      for (std::size_t k = begin; k < i; ++k) {
        if (!owners.empty() && owners.back() == pieces[k].owner) {
          owners.pop_back();
        } else {
          owners.push_back(pieces[k].owner);
        }
      }
      if (owners.empty()) continue;
      set = sets.number(owners);
    }
    borders.segments.push_back(segment);
    borders.owners.push_back(set);
  }
  return borders;
}

/// Pieces of borders in order of place, each with its set of features as its owner.
LargeArray<OwnedSegment> in_order(const std::vector<Piece>& pieces, const Borders& borders) {
  LargeArray<OwnedSegment> ordered;
  ordered.reserve(pieces.size());
  for (const Piece& piece : pieces)
    ordered.push_back({piece.segment, borders.owners[piece.source]});
  sort_by_place(ordered);
  return ordered;
}

}  // namespace

std::uint32_t FeatureSets::number(const std::vector<std::uint32_t>& features) {
  if (is_full()) return 0;
  const auto [found, is_new] =
      numbers_.try_emplace(features, static_cast<std::uint32_t>(sets_.size()));
  if (is_new) {
    sets_.push_back(features);
    members_ += features.size();
  }
  return found->second;
}

std::uint32_t FeatureSets::number_of_one(std::uint32_t feature) {
  std::uint32_t& known = of_one_[feature];
  if (known == kUnknown) known = number({feature});
  return known;
}

std::uint32_t FeatureSets::toggled(std::uint32_t a, std::uint32_t b) {
  if (is_full()) return 0;
  const std::uint64_t key = std::uint64_t{a} << 32 | b;
  const auto [found, is_new] = toggled_.try_emplace(key, 0);
  if (is_new) {
    std::vector<std::uint32_t> result;
    std::ranges::set_symmetric_difference(sets_[a], sets_[b], std::back_inserter(result));
    found->second = number(result);
  }
  return found->second;
}

SetMap::SetMap(std::span<const Rings* const> features, unsigned threads)
    : threads_(threads), sets_(features.size()) {
  LargeArray<OwnedSegment> pieces = segments_of(features);
  sort_by_place(pieces, threads);
  borders_ = unite_pieces(pieces, sets_);
}

void SetMap::fail_to_node() {
  failure_ = "their borders cross more than " +
             std::to_string(most_meetings(borders_.segments.size())) + " times";
}

bool SetMap::sweep(Boundary& boundary, Trapezoidation& trapezoidation, TrapezoidalGraph& graph,
                   HotCells cells) {
  // As for a single polygon, see GraphBuilder. If nothing crosses, nothing has to be noded.
  constexpr int kQuickPasses = 3;
  constexpr int kMaxPasses = 6;
  const FaceBeyond toggle = [this](EdgeId e, FaceId left) {
    return sets_.toggled(left, borders_.owners[e.value]);
  };
  if (cells == HotCells::crossings_and_vertices && !borders_.segments.empty()) {
    is_noded_ = true;
    boundary.assign_sorted(borders_.segments, threads_);
    if (!node_borders(boundary, cells)) {
      fail_to_node();
      return false;
    }
  }
  for (int pass = 0; pass <= kMaxPasses; ++pass) {
    if (pass > 0) {
      is_noded_ = true;
      const HotCells of_pass =
          pass <= kQuickPasses ? HotCells::crossings : HotCells::crossings_and_vertices;
      if (!node_borders(boundary, of_pass)) {
        fail_to_node();
        return false;
      }
    }
    if (borders_.segments.size() > kMostSegments) {
      failure_ = too_many_words(borders_.segments.size(), "pieces of borders", kMostSegments);
      return false;
    }
    if (borders_.segments.empty()) return false;
    boundary.assign_sorted(borders_.segments, threads_);
    const bool is_noded = trapezoidation.build(boundary, toggle, graph, threads_);
    if (sets_.is_full()) {
      failure_ = kTooManyOverEachOther;
      return false;
    }
    if (is_noded) return true;
  }
  failure_ = "its borders still cross after " + std::to_string(kMaxPasses) + " passes of noding";
  return false;
}

/// The edges of `boundary` are the borders. False if they meet too often.
bool SetMap::node_borders(const Boundary& boundary, HotCells cells) {
  const std::optional<Noding> noding = node(borders_.segments, boundary, cells, threads_);
  if (!noding) return false;
  const LargeArray<OwnedSegment> pieces = in_order(noding->pieces, borders_);
  // Segments that stay and the pieces of others, in order of place; coinciding ones are toggled.
  Borders noded;
  noded.segments.reserve(borders_.segments.size() + pieces.size());
  noded.owners.reserve(borders_.segments.size() + pieces.size());
  const auto append = [&](const Segment& segment, std::uint32_t owners) {
    if (!noded.segments.empty() && noded.segments.back() == segment) {
      noded.owners.back() = sets_.toggled(noded.owners.back(), owners);
    } else {
      if (!noded.owners.empty() && noded.owners.back() == 0) {
        noded.owners.pop_back();
        noded.segments.pop_back();
      }
      noded.segments.push_back(segment);
      noded.owners.push_back(owners);
    }
  };
  auto piece = pieces.begin();
  auto cut = noding->cut.begin();
  for (std::uint32_t i = 0; i < borders_.segments.size(); ++i) {
    if (cut != noding->cut.end() && *cut == i) {
      ++cut;
      continue;
    }
    const Segment& segment = borders_.segments[i];
    for (; piece != pieces.end() && !precedes(segment, piece->segment); ++piece) {
      append(piece->segment, piece->owner);
    }
    append(segment, borders_.owners[i]);
  }
  for (; piece != pieces.end(); ++piece) append(piece->segment, piece->owner);
  if (!noded.owners.empty() && noded.owners.back() == 0) {
    noded.owners.pop_back();
    noded.segments.pop_back();
  }
  borders_ = std::move(noded);
  return true;
}

}  // namespace trapeze
