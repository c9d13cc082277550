#include "server/changes/changed_tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/grid/for_each_in_parallel.h"
#include "core/grid/grid.h"
#include "core/layer/layer_changes.h"
#include "render/software/software_renderer.h"
#include "render/text/fonts.h"
#include "server/tiles/tile_painter.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {
namespace {

/// How far away dust is collected, and how far enlarged small polygons reach, in pixels.
constexpr double kReachOfDust = 3;

/// The changes for styles in which an overlap affects the drawing of a whole feature: overlapping
/// features have no rounded corners and do not grow, and their lines are joined only with each
/// other.
LayerChanges with_all_of_pairs(LayerChanges changes) {
  std::vector<LayerChanges::Place> others;
  for (LayerChanges::Place& place : changes.places) {
    if (place.other.is_empty()) continue;
    others.push_back({std::exchange(place.other, {}), place.lifespan, place.is_dust});
  }
  changes.places.insert(changes.places.end(), others.begin(), others.end());
  return changes;
}

/// The states of one layer of the request, and what may look different between them.
struct ComparedLayer {
  std::string name;
  LayerChanges changes;
  LayerChanges untested;  // without the topology test, in states that have that
};

/// The layer, or all parts of a layer in parts; throws if one cannot be opened.
std::vector<const Layer*> layers_of(const ServedLayer& served) {
  if (served.parts == nullptr) return {served.layer.get()};
  std::vector<const Layer*> layers;
  for (const auto& part : served.parts->parts()) {
    layers.push_back(part->layer().get());  // kept alive by the part
    if (layers.back() == nullptr) throw std::runtime_error(part->problem());
  }
  return layers;
}

/// Compares only those corresponding parts that are not the same. A feature that moved to another
/// part is removed from one and added to the other, which is no change of both together. If the
/// layers are divided differently, everything in each is compared with nothing, which gives the
/// same result.
LayerChanges changes_of_parts(const ServedLayer& old, const ServedLayer& now, Ids ids) {
  LayerChanges all;
  const auto add = [&](const Layer& before, const Layer& after) {
    LayerChanges changes = changes_between(before, after, ids);
    all.sides.insert(all.sides.end(), changes.sides.begin(), changes.sides.end());
    all.places.insert(all.places.end(), changes.places.begin(), changes.places.end());
  };
  if (old.parts != nullptr && now.parts != nullptr &&
      old.parts->parts().size() == now.parts->parts().size()) {
    for (std::size_t i = 0; i < now.parts->parts().size(); ++i) {
      const PreparedPart& before = *old.parts->parts()[i];
      const PreparedPart& after = *now.parts->parts()[i];
      if (before.summary().revision == after.summary().revision) continue;
      const auto layer_before = before.layer();
      const auto layer_after = after.layer();
      if (layer_before == nullptr) throw std::runtime_error(before.problem());
      if (layer_after == nullptr) throw std::runtime_error(after.problem());
      add(*layer_before, *layer_after);
    }
    return all;
  }
  const Layer& nothing = old.parts != nullptr ? *old.layer : *now.layer;
  for (const Layer* layer : layers_of(old)) add(*layer, nothing);
  for (const Layer* layer : layers_of(now)) add(nothing, *layer);
  return all;
}

class Comparison {
 public:
  Comparison(const ChangeRequest& request, std::shared_ptr<const Dataset> before,
             std::shared_ptr<const Dataset> after)
      : request_(request), before_(std::move(before)), after_(std::move(after)) {
    const auto classes = TilePainter::new_class_cache();
    const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
    for (std::size_t i = 0; i < threads; ++i) {
      painters_.emplace_back(std::make_unique<SoftwareRenderer>(), classes,
                             request.labels->usual_fonts(), request.labels);
    }
    for (const std::string& name : request.tile.layers) add_layer(name);
  }

  Result<ChangedTiles> find() {
    ChangedTiles found;
    found.zooms = request_.zooms;
    for (int zoom = request_.zooms.first; zoom <= request_.zooms.last; ++zoom) {
      TileRequest tile = request_.tile;
      tile.tile = {zoom, 0, 0};
      std::vector<TileId> tiles;
      try {
        for (; tile.scale <= std::max(request_.tile.scale, request_.most_scale); ++tile.scale) {
          const auto before = plan_tile(tile, before_);
          if (!before) return before.problem();
          const auto after = plan_tile(tile, after_);
          if (!after) return after.problem();
          const auto more = changed(candidates(zoom, *before, *after), *before, *after);
          tiles.insert(tiles.end(), more.begin(), more.end());
        }
        leave_one_of_each(tiles);
        found.tiles.insert(found.tiles.end(), tiles.begin(), tiles.end());
      } catch (const std::length_error&) {
        found.zooms.last = zoom - 1;
        found.is_complete = false;
        break;
      }
    }
    return found;
  }

 private:
  void add_layer(const std::string& name) {
    const auto before = before_->find(name);
    const auto after = after_->find(name);
    if (!before || !after) return;  // plan_tile() reports it
    const ServedLayer& old = before_->layers()[*before];
    const ServedLayer& now = after_->layers()[*after];
    const StyleQuery& style = request_.tile.style;
    const bool names_ids = style.value_for(name, ParameterId::ids).has_value() ||
                           style.value_for(name, ParameterId::highlight).has_value();
    const Ids ids = names_ids ? Ids::matter : Ids::do_not_matter;
    ComparedLayer compared;
    compared.name = name;
    if (now.last_step != nullptr && now.last_step->since == old.revision) {
      compared.changes = now.last_step->changes;
    } else if (old.parts != nullptr || now.parts != nullptr) {
      compared.changes = changes_of_parts(old, now, ids);
    } else if (old.layer != now.layer) {
      compared.changes = changes_between(*old.layer, *now.layer, ids);
    }
    if (old.untested != nullptr || now.untested != nullptr) {
      // The layer without the topology test has the same rows, but no table of features.
      const auto untested_of = [](const ServedLayer& served) {
        return LayerWithFeatures{served.untested != nullptr ? *served.untested : *served.layer,
                                 served.layer->features()};
      };
      compared.untested = changes_between(untested_of(old), untested_of(now), ids);
    }
    layers_.push_back(std::move(compared));
  }

  static const std::string& name_of(const TilePlan& plan, const LayerPaint& paint) {
    return plan.dataset->layers_on_all_grids()[paint.layer].config.name;
  }

  const LayerChanges* changes_of(const TilePlan& plan, const LayerPaint& paint) const {
    const auto found = std::ranges::find(layers_, name_of(plan, paint), &ComparedLayer::name);
    if (found == layers_.end()) return nullptr;
    return paint.topology == Topology::strict ? &found->changes : &found->untested;
  }

  /// Whether a rule for class breaks gives other numbers, or other values are joined: then features
  /// that have not changed themselves may have other colours. So they may in debug marks, which
  /// colour features by their rows.
  static bool has_other_classes(const std::string& name, const TilePlan& before,
                                const TilePlan& after) {
    const auto paint_in = [&name](const TilePlan& plan) -> const LayerPaint* {
      const auto found = std::ranges::find_if(
          plan.layers, [&](const LayerPaint& paint) { return name_of(plan, paint) == name; });
      return found == plan.layers.end() ? nullptr : &*found;
    };
    const LayerPaint* old = paint_in(before);
    const LayerPaint* now = paint_in(after);
    if (old == nullptr || now == nullptr) return false;
    const auto revision = [](const TilePlan& plan, const LayerPaint& paint) {
      return plan.dataset->layers_on_all_grids()[paint.layer].revision;
    };
    if (before.debug.faces && revision(before, *old) != revision(after, *now)) return true;
    const auto joined = [](const LayerPaint& paint) {
      const auto& values = paint.style.classing.joined;
      return values == nullptr ? std::string() : values->key();
    };
    return old->style.classing.breaks != now->style.classing.breaks || joined(*old) != joined(*now);
  }

  /// All places of the layers for which that holds.
  static LayerChanges all_of_reclassed(const TilePlan& before, const TilePlan& after) {
    LayerChanges changes;
    for (const TilePlan* plan : {&before, &after}) {
      for (const LayerPaint& paint : plan->layers) {
        if (!has_other_classes(name_of(*plan, paint), before, after)) continue;
        changes.places.push_back({plan->layer_of(paint).bounds(), {}});
      }
    }
    return changes;
  }

  /// Whether the labels of a plan may differ between the states. They are placed together, so one
  /// that changes makes room for others, or takes it.
  bool may_labels_differ(const TilePlan& plan) const {
    return std::ranges::any_of(plan.labels, [&](const LabelledLayer& labelled) {
      const std::string& name = plan.dataset->layers_on_all_grids()[labelled.layer].config.name;
      return before_->layers()[before_->find(name).value()].revision !=
             after_->layers()[after_->find(name).value()].revision;
    });
  }

  /// Appends the tiles of the labels that are shown in one of the states only.
  void add_tiles_of_labels(int zoom, const TilePlan& before, const TilePlan& after,
                           std::vector<TileId>& tiles) const {
    if (!may_labels_differ(before) && !may_labels_differ(after)) return;
    const auto labels_of = [&](const TilePlan& plan) {
      auto labels =
          request_.labels->all_at_scale_of({*plan.dataset, plan.labels, plan.view, plan.scale});
      std::ranges::sort(labels);
      return labels;
    };
    std::vector<PlacedLabel> differing;
    std::ranges::set_symmetric_difference(labels_of(before), labels_of(after),
                                          std::back_inserter(differing));
    const std::int64_t count = std::int64_t{1} << zoom;
    const double side = static_cast<double>(kGridSize) / static_cast<double>(count);
    const auto number_at = [side](double cells) {
      return static_cast<std::int64_t>(std::floor((cells - kGridMin) / side));
    };
    const std::size_t most = tiles.size() + request_.most_tiles;
    for (const PlacedLabel& label : differing) {
      const std::int64_t first_row =
          std::max<std::int64_t>(number_at(label.y - label.half_height), 0);
      const std::int64_t last_row = std::min(number_at(label.y + label.half_height), count - 1);
      for (std::int64_t row = first_row; row <= last_row; ++row) {
        const std::int64_t last_column = number_at(label.x + label.half_width);
        for (std::int64_t column = number_at(label.x - label.half_width); column <= last_column;
             ++column) {
          if (tiles.size() >= most) throw std::length_error("too many tiles with other labels");
          const std::int64_t around =
              (column % count + count) % count;  // labels reach over the seam
          tiles.push_back(
              {zoom, static_cast<std::uint32_t>(around), static_cast<std::uint32_t>(row)});
        }
      }
    }
  }

  /// Whether a feature may be drawn otherwise because it overlaps another one, however far away.
  /// Candidates are those of styles with other joins, too.
  bool depends_on_overlaps_elsewhere(const LayerStyle& style) const {
    const bool may_be_joined =
        style.stroke.join != LineJoin::round || request_.certainty == Certainty::candidates;
    return style.smooth > 0 || style.grow > 0 || (style.stroke.width > 0 && may_be_joined);
  }

  /// Layers visible in only one of the states have other zooms or opacities, which is not a change
  /// of the data.
  std::vector<TileId> candidates(int zoom, const TilePlan& before, const TilePlan& after) const {
    std::vector<std::pair<const LayerChanges*, TileDrawing>> drawings;  // usually the same in both
    const LayerChanges everywhere = all_of_reclassed(before, after);
    std::map<const LayerChanges*, LayerChanges> of_pairs;
    for (const TilePlan* plan : {&before, &after}) {
      for (const LayerPaint& paint : plan->layers) {
        const bool is_reclassed = has_other_classes(name_of(*plan, paint), before, after);
        const LayerChanges* changes = is_reclassed ? &everywhere : changes_of(*plan, paint);
        if (changes == nullptr) continue;
        if (depends_on_overlaps_elsewhere(paint.style)) {
          const auto found = of_pairs.find(changes);
          changes = found != of_pairs.end()
                        ? &found->second
                        : &of_pairs.emplace(changes, with_all_of_pairs(*changes)).first->second;
        }
        const double reach = paint.style.reach(plan->scale) + kReachOfDust;
        const TileDrawing drawing{zoom, paint.level, plan->pixel_level(),
                                  reach * plan->view.cells_per_pixel};
        const std::pair each(changes, drawing);
        if (std::ranges::find(drawings, each) == drawings.end()) drawings.push_back(each);
      }
    }
    std::vector<TileId> tiles;
    for (const auto& [changes, drawing] : drawings) {
      const auto more = tiles_with_changes(*changes, drawing, request_.most_tiles);
      tiles.insert(tiles.end(), more.begin(), more.end());
    }
    const auto has_lines = [](const LayerPaint& paint) { return paint.style.stroke.width > 0; };
    if (std::ranges::any_of(before.layers, has_lines) ||
        std::ranges::any_of(after.layers, has_lines)) {
      add_across_the_antimeridian(tiles);
    }
    add_tiles_of_labels(zoom, before, after, tiles);
    leave_one_of_each(tiles);
    return tiles;
  }

  /// Of tiles of one zoom, by row and column.
  static void leave_one_of_each(std::vector<TileId>& tiles) {
    const auto place = [](const TileId& tile) { return std::pair(tile.y, tile.x); };
    std::ranges::sort(tiles, {}, place);
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  }

  /// Adds the tiles at the other end of the world, since lines reach across the antimeridian.
  static void add_across_the_antimeridian(std::vector<TileId>& tiles) {
    const std::size_t count = tiles.size();
    for (std::size_t i = 0; i < count; ++i) {
      const auto [z, x, y] = tiles[i];
      const std::uint32_t last = (std::uint32_t{1} << z) - 1;
      if (x == 0) tiles.push_back({z, last, y});
      if (x == last) tiles.push_back({z, 0, y});
    }
  }

  /// The tiles that differ.
  std::vector<TileId> changed(std::vector<TileId> tiles, const TilePlan& before,
                              const TilePlan& after) {
    if (request_.certainty == Certainty::candidates) return tiles;
    std::vector<char> is_different(tiles.size());
    for_each_in_parallel(painters_.size(), painters_.size(), [&](std::size_t thread) {
      TilePlan old = before;
      TilePlan now = after;
      for (std::size_t i = thread; i < tiles.size(); i += painters_.size()) {
        old.view = now.view = View::of_tile(tiles[i], request_.tile.scale);
        is_different[i] = are_different(old, now, painters_[thread]) ? 1 : 0;
      }
    });
    std::vector<TileId> left;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      if (is_different[i] != 0) left.push_back(tiles[i]);
    }
    return left;
  }

  bool are_different(const TilePlan& before, const TilePlan& after, TilePainter& painter) const {
    const PaintJob old{&before};
    const PaintJob now{&after};
    if (painter.identify(old) == painter.identify(now)) return false;
    if (request_.certainty == Certainty::fingerprints) return true;
    const auto bytes_of = [&painter](const PaintJob& job) {
      return painter.paint({&job, 1}).front().value().bytes;
    };
    return *bytes_of(old) != *bytes_of(now);
  }

  const ChangeRequest& request_;
  std::shared_ptr<const Dataset> before_;
  std::shared_ptr<const Dataset> after_;
  std::vector<TilePainter> painters_;  // one per thread
  std::vector<ComparedLayer> layers_;
};

}  // namespace

Result<ChangedTiles> changed_tiles(const ChangeRequest& request,
                                   const std::shared_ptr<const Dataset>& before,
                                   const std::shared_ptr<const Dataset>& after) {
  return Comparison(request, before, after).find();
}

}  // namespace trapeze
