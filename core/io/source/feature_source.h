// Reads the features of all layers of a source one after another.
//
// Belongs to one thread, as GDAL's handles do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/io/source/gdal_messages.h"
#include "core/io/source/open_source.h"
#include "core/io/source/source_crs.h"
#include "core/io/source/source_selection.h"

namespace trapeze {

/// A layer that can hold polygons.
struct SourceLayer {
  OGRLayer* layer = nullptr;
  int geometry_field = 0;  // the first one that can hold polygons
  SourceCrs crs;
};

struct SourceFeature {
  OGRFeatureUniquePtr feature;
  const SourceLayer* layer = nullptr;  // null: of a layer that cannot hold polygons
  std::size_t layer_index = 0;         // in layers()
  std::string failure;                 // what GDAL complained about while reading it
};

class FeatureSource {
 public:
  /// Throws std::runtime_error, naming the source, if it cannot be opened or is known to be cut
  /// off, or has thousands of attributes; SelectionError, with all that is wrong, if it lacks what
  /// is selected. A database is asked for the first feature for which the condition holds, to learn
  /// whether it understands it.
  explicit FeatureSource(const std::string& path, const SourceSelection& selection = {});

  std::string driver() const;
  const std::vector<SourceLayer>& layers() const { return layers_; }
  /// The number of features in layers that cannot hold polygons; next() skips them.
  std::size_t passed_over() const { return passed_over_; }

  /// What may be wrong with it, in words without its name: a layer whose coordinates are taken for
  /// degrees, for it names no reference system that is known, and its format has no usual one.
  std::vector<std::string> warnings() const;
  /// Throws SourceError, before anything is read, if it is known that a layer cannot be brought to
  /// Web Mercator: by its reference system, or by the extent that it says to have if it names none.
  void check_reference_systems() const;

  /// Reads the next feature; false at the end. Throws SourceError if the source breaks off, or if
  /// fewer features of a layer can be read than it says it has.
  bool next(SourceFeature& next);

  /// From here on, next() passes over features for which that is false, without looking at them;
  /// `order` counts those that it would give otherwise, from 0. Where about so few are wanted that
  /// it is worth it, and the format knows where each of them is, no others are read: then it is not
  /// noticed if others cannot be.
  void keep_only(std::function<bool(std::size_t order)> is_wanted, std::size_t about);

  /// Share of the features that have been read, 0 to 1, or < 0 if unknown.
  double progress() const;

 private:
  std::vector<SelectionProblem> select(const SourceSelection& selection);
  void find_layers();
  std::string find_only_layer(const std::string& name);
  void add_layer(OGRLayer& layer, int geometry_field);
  std::string apply_condition(const std::string& where);
  std::string apply_condition(const std::string& where, OGRLayer& layer);
  void select_ids(const SourceSelection& selection);
  bool knows_places() const;
  bool read_next(SourceFeature& next);
  OGRFeatureUniquePtr next_by_place(SourceFeature& next);
  OGRFeatureUniquePtr next_by_id(SourceFeature& next);
  void read_by_id(OGRLayer& layer);
  std::vector<SelectionProblem> find_missing_attributes(
      const std::optional<std::vector<std::string>>& names) const;
  void count_stored();
  OGRFeatureUniquePtr next_of_layers(SourceFeature& next);
  OGRFeatureUniquePtr next_interleaved(SourceFeature& next);
  bool has_unknown_prj() const;
  void expect(OGRLayer& layer);
  void check_all_was_read();

  ReadingSettings settings_;
  GDALDatasetUniquePtr dataset_;
  // The layers of an OSM file are mixed in one stream, which can only be read in its own order.
  bool is_interleaved_ = false;
  std::vector<SourceLayer> layers_;
  std::size_t passed_over_ = 0;
  GdalMessages messages_;

  bool has_condition_ = false;
  std::vector<GIntBig> stored_;  // by layer: the features it says it has, < 0 if it does not say

  // If only features of certain ids are read: these, and what was found of them, in order.
  std::optional<std::vector<std::int64_t>> ids_;
  std::string condition_;  // on the others, in SQL; empty: none
  std::vector<OGRFeatureUniquePtr> by_id_;

  std::function<bool(std::size_t)> is_wanted_;  // empty: all are
  bool reads_by_place_ = false;                 // only those are read at all

  std::size_t current_layer_ = 0;
  std::size_t read_ = 0;
  GIntBig read_of_layer_ = 0;  // of the current one
  double expected_ = 0;        // features in layers(), < 0 if unknown
  double interleaved_share_ = -1;
};

}  // namespace trapeze
