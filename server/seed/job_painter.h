// Runs one job of a seeding: finds the tiles that are known without drawing, and draws the others.
//
// Thread-safety: one thread at a time; every thread has its own painter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "server/seed/known_tiles.h"
#include "server/seed/seed_block.h"
#include "server/seed/seed_jobs.h"
#include "server/seed/seed_plan.h"
#include "server/tiles/tile_painter.h"

namespace trapeze {

class JobPainter {
 public:
  /// The bytes of a tile with that fingerprint, if they are known from an earlier archive.
  using FindKnown = std::function<std::optional<std::string>(const Digest& fingerprint)>;

  /// `plan` must outlive it.
  JobPainter(const SeedPlan& plan, TilePainter painter,
             const std::shared_ptr<FeatureClassCache>& classes,
             const std::shared_ptr<LabelBook>& labels, FindKnown find_known = {});

  /// The tiles of the units. Throws the errors of drawing.
  SeedBlockBuilder paint(std::span<const SeedUnit> units);

  /// How many of the tiles counted as drawn were not, because their bytes were known from an
  /// earlier archive.
  std::uint64_t reused() const { return reused_; }

 private:
  struct Painted {
    std::string bytes;
    TileHint hint = TileHint::none;
  };

  void approach(const TileId& tile);
  void visit(const TileId& tile);
  void add_all_below(const TileId& tile);
  void add_known(const TileId& tile, const PlaceRange& places, int zoom, const TileLook& look);
  void paint_tile(const TileId& tile);
  Painted paint_whole(const TilePlan& plan, std::string& fingerprint,
                      const std::function<bool(const std::string&)>& is_wanted);
  bool is_empty(const TilePlan& plan, const std::string& bytes) const;

  const SeedPlan& plan_;
  TilePainter painter_;
  KnownTiles known_;
  FindKnown find_known_;
  std::uint64_t reused_ = 0;
  std::vector<std::optional<TileId>> approached_;  // by zoom
  std::map<TileLook, std::string> looks_;          // the tile of each look
  std::string empty_;                              // a tile that shows nothing
  SeedBlockBuilder block_;
  std::map<TileLook, std::uint64_t> contents_;  // content numbers of the block, by look
  std::set<std::uint64_t> of_one_colour_;       // contents of the block
  std::set<Digest> as_they_were_;  // fingerprints in the block that were found by find_known_
};

}  // namespace trapeze
