#include "core/borders/set_map.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "core/grid/item_count.h"
#include "core/sweep/noding.h"

namespace trapeze {
namespace {

/// None if they meet too often.
std::optional<std::vector<OwnedSegment>> node(const std::vector<OwnedSegment>& segments,
                                              HotCells cells) {
  std::vector<Segment> alone;
  alone.reserve(segments.size());
  for (const OwnedSegment& s : segments) alone.push_back(s.segment);
  const std::optional<std::vector<Piece>> noded = node_pieces(alone, cells);
  if (!noded) return std::nullopt;
  std::vector<OwnedSegment> pieces;
  pieces.reserve(noded->size());
  for (const Piece& piece : *noded) {
    pieces.push_back({piece.segment, segments[piece.source].owner});
  }
  return pieces;
}

/// A segment that a feature has twice is inside it on both sides, or outside on both.
Borders unite(std::vector<OwnedSegment>& pieces, FeatureSets& sets) {
  sort_by_place(pieces);
  Borders borders;
  std::vector<std::uint32_t> owners;
  for (std::size_t i = 0; i < pieces.size();) {
    const Segment& segment = pieces[i].segment;
    owners.clear();
    for (; i < pieces.size() && pieces[i].segment == segment; ++i) {
      if (!owners.empty() && owners.back() == pieces[i].owner) {
        owners.pop_back();
      } else {
        owners.push_back(pieces[i].owner);
      }
    }
    if (owners.empty()) continue;
    borders.segments.push_back(segment);
    borders.owners.push_back(sets.number(owners));
  }
  return borders;
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

bool SetMap::sweep(Boundary& boundary, Trapezoidation& trapezoidation, TrapezoidalGraph& graph) {
  // As of a single polygon, see GraphBuilder; where nothing crosses, there is nothing to node.
  constexpr int kQuickPasses = 3;
  constexpr int kMaxPasses = 6;
  const FaceBeyond toggle = [this](EdgeId e, FaceId left) {
    return sets_.toggled(left, borders_.owners[e.value]);
  };
  for (int pass = 0; pass <= kMaxPasses; ++pass) {
    if (pass > 0) {
      is_noded_ = true;
      std::optional<std::vector<OwnedSegment>> noded = node(
          pieces_, pass <= kQuickPasses ? HotCells::crossings : HotCells::crossings_and_vertices);
      if (!noded) {
        failure_ = "their borders cross more than " +
                   std::to_string(most_meetings(pieces_.size())) + " times";
        return false;
      }
      pieces_ = std::move(*noded);
    }
    if (pieces_.size() > kMostSegments) {
      failure_ = too_many_words(pieces_.size(), "pieces of borders", kMostSegments);
      return false;
    }
    borders_ = unite(pieces_, sets_);
    if (borders_.segments.empty()) return false;
    boundary.assign(borders_.segments);
    const bool is_noded = trapezoidation.build(boundary, toggle, graph);
    if (sets_.is_full()) {
      failure_ = kTooManyOverEachOther;
      return false;
    }
    if (is_noded) return true;
  }
  failure_ = "its borders still cross after " + std::to_string(kMaxPasses) + " passes of noding";
  return false;
}

void SetMap::leave_out(const std::vector<std::uint32_t>& features) {
  std::erase_if(pieces_, [&features](const OwnedSegment& piece) {
    return std::binary_search(features.begin(), features.end(), piece.owner);
  });
}

}  // namespace trapeze
