// Reads the features of all layers of a source one after another.
//
// One thread only, like GDAL's handles.
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
  const SourceLayer* layer = nullptr;  // null: the feature is from a layer that cannot hold
                                       // polygons
  std::size_t layer_index = 0;         // in layers()
  /// GDAL's error while reading it, if any. If the format is parsed many features at a time: the
  /// latest error so far, and only if this feature has no geometry.
  std::string failure;
  bool follows_lost_lines = false;  // the error concerns lines of a GeoJSON sequence before it
};

class FeatureSource {
 public:
  /// Throws std::runtime_error that names the source if it cannot be opened, is known to be
  /// truncated, or has thousands of attributes. Throws SelectionError with all problems if the
  /// source lacks selected content. A database is queried for the first feature that meets the
  /// condition, to check whether it understands the condition.
  explicit FeatureSource(const std::string& path, const SourceSelection& selection = {});

  std::string driver() const;
  const std::vector<SourceLayer>& layers() const { return layers_; }
  /// The number of features in layers that cannot hold polygons; next() skips them.
  std::size_t passed_over() const { return passed_over_; }

  /// Possible problems, in words without the name of the source: a layer whose coordinates are
  /// interpreted as degrees because it has no known reference system and its format has no usual
  /// one; a format that is read ahead, with an error that cannot be assigned to a feature; a
  /// GeoJSON with numbers that GDAL changes.
  std::vector<std::string> warnings() const;
  /// Throws SourceError, before anything is read, if it is known that a layer cannot be projected
  /// to Web Mercator: because of its reference system or, if it has none, because of its declared
  /// extent.
  void check_reference_systems() const;

  /// Reads the next feature; false at the end. Throws SourceError if the source breaks off, or if
  /// fewer features of a layer can be read than it declares.
  bool next(SourceFeature& next);

  /// From here on, next() skips features for which is_wanted is false, without examining them.
  /// `order` numbers, from 0, the features that it would otherwise return. If `about` so few are
  /// wanted that it is worthwhile, and the format has random access to features, the others are not
  /// read at all; unreadable ones among them then go unnoticed.
  void keep_only(std::function<bool(std::size_t order)> is_wanted, std::size_t about);

  /// Fraction of the features read, 0 to 1, or < 0 if unknown.
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
  void assign_failure_ahead(SourceFeature& next);
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
  std::string warning_;  // of GDAL when it opened the source
  GDALDatasetUniquePtr dataset_;
  // The layers of an OSM file are interleaved in one stream, which can only be read in its own
  // order.
  bool is_interleaved_ = false;
  std::vector<SourceLayer> layers_;
  std::size_t passed_over_ = 0;
  GdalMessages messages_;
  std::string failure_ahead_;  // the latest error of a format that is read ahead

  bool has_condition_ = false;
  std::vector<GIntBig> stored_;  // by layer: the declared number of features, < 0 if not declared

  // If only features with certain ids are read: these ids and the features found for them, in
  // order.
  std::optional<std::vector<std::int64_t>> ids_;
  std::string condition_;  // with ids: the condition that applies as well, in SQL; empty: none
  std::vector<OGRFeatureUniquePtr> by_id_;

  std::function<bool(std::size_t)> is_wanted_;  // empty: all are wanted
  bool reads_by_place_ = false;                 // only wanted features are read at all

  std::size_t current_layer_ = 0;
  std::size_t read_ = 0;
  GIntBig read_of_layer_ = 0;  // of the current one
  double expected_ = 0;        // features in layers(), < 0 if unknown
  double interleaved_share_ = -1;
};

}  // namespace trapeze
