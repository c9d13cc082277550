// Seedings for tests, drawn in plain C++ on one thread.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "render/software/software_renderer.h"
#include "server/seed/job_painter.h"
#include "server/seed/join.h"
#include "server/seed/seed_jobs.h"
#include "server/seed/seed_log.h"
#include "server/seed/seed_plan.h"
#include "server/seed/seeder.h"
#include "tests/server/service/sample_site.h"

namespace trapeze::testing {

inline SeedRequest seed_request(const Dataset& dataset, ZoomRange zooms, const std::string& style) {
  SeedRequest request;
  for (const ServedLayer& layer : dataset.layers()) {
    request.tile.layers.push_back(layer.config.name);
  }
  request.tile.style = style_of(style);
  request.zooms = zooms;
  return request;
}

inline TilePainter software_painter() {
  return TilePainter(std::make_unique<SoftwareRenderer>(), TilePainter::new_class_cache(),
                     std::make_shared<const Fonts>(), label_book());
}

/// The bytes that the server answers with.
inline std::string served_bytes(const SeedPlan& plan, const TileId& tile, TilePainter& painter) {
  const TilePlan of_tile = plan.plan_of(tile);
  const PaintJob job{&of_tile};
  return *painter.paint({&job, 1}).front().value().bytes;
}

/// A seeding that is kept in memory.
class SeededTiles {
 public:
  explicit SeededTiles(const SeedPlan& plan) : plan_(plan) {
    const auto classes = TilePainter::new_class_cache();
    KnownTiles known(plan, classes, label_book());
    jobs_ = divide_into_jobs(plan, known);
    JobPainter painter(plan, software_painter(), classes, label_book());
    for (std::size_t i = 0; i < jobs_.jobs.size(); ++i) {
      memory_.push_back(painter.paint(jobs_.units_of(jobs_.jobs[i])).bytes(i));
      blocks_.push_back(SeedBlock::read(memory_.back()).value());
      figures_.add(blocks_.back().figures());
    }
  }

  const SeedFigures& figures() const { return figures_; }
  const SeedJobs& jobs() const { return jobs_; }

  /// Calls visit(tile, bytes) for all tiles, in order.
  template <typename Visit>
  void for_each_tile(const Visit& visit) const {
    for (int zoom = plan_.zooms().first; zoom <= plan_.zooms().last; ++zoom) {
      for (const SeedBlock& block : blocks_) {
        for (const BlockEntry& entry : block.entries(zoom)) {
          const auto bytes = block.bytes_of(block.contents()[entry.content]);
          for (std::uint64_t i = 0; i < entry.places.count; ++i) {
            visit(tile_at_place(zoom, entry.places.first + i), bytes);
          }
        }
      }
    }
  }

 private:
  const SeedPlan& plan_;
  SeedJobs jobs_;
  std::vector<std::vector<std::byte>> memory_;
  std::vector<SeedBlock> blocks_;
  SeedFigures figures_;
};

/// Expects every tile of the plan, in order and once each, with the bytes of the server.
inline void expect_served_bytes(const SeedPlan& plan) {
  const SeededTiles seeded(plan);
  TilePainter painter = software_painter();
  std::uint64_t count = 0;
  std::uint64_t wrong = 0;
  std::uint64_t next_id = 0;
  seeded.for_each_tile([&](const TileId& tile, std::string_view bytes) {
    ++count;
    const std::uint64_t id = first_id_of_zoom(tile.z) + place_on_curve(tile);
    EXPECT_GE(id, next_id);
    next_id = id + 1;
    EXPECT_TRUE(plan.meets(tile));
    if (bytes != served_bytes(plan, tile, painter) && ++wrong < 10) {
      ADD_FAILURE() << "other bytes: " << tile.z << '/' << tile.x << '/' << tile.y;
    }
  });
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(count, plan.count());
  EXPECT_EQ(seeded.figures().tiles(), plan.count());
}

}  // namespace trapeze::testing
