// Reads the polygons of any vector source that GDAL supports into a layer, on all cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/io/load/load_report.h"
#include "core/io/source/source_selection.h"
#include "core/labels/label_anchors.h"
#include "core/layer/layer.h"
#include "core/layer/layer_options.h"
#include "core/layer/layer_part.h"

namespace trapeze {

class MappedFile;
class PreparedParts;
class SourceDivision;

struct LoadOptions {
  unsigned threads = 0;  // 0: one per core
  LayerOptions generalization = {};
  SourceSelection selection = {};
  /// The reference system on whose grid the layer is built, see find_target_grid(); empty: Web
  /// Mercator.
  std::string grid = {};
  /// A layer on the same grid, built by the same program (see build_fingerprint()), from which
  /// content built of the same rings is taken over, or null. The result is the same but is ready
  /// sooner. Nothing is taken over from a layer that was built with other options.
  std::shared_ptr<const Layer> earlier = {};
  /// The division of the source, made with the same selection and options; null: the source is read
  /// whole.
  std::shared_ptr<const SourceDivision> division = {};
  std::uint32_t part = 1;  // the part that is read, if there is a division
  /// Called from time to time, on the thread that called load_layer, with the approximate fraction
  /// of the time elapsed, reading and building together: in [0, 1] and never decreasing, or < 0
  /// while unknown; 1 at the end. An exception thrown by it aborts the loading.
  std::function<void(double)> progress = {};
};

struct LoadedLayer {
  std::unique_ptr<Layer> layer;
  LoadReport report;
  std::shared_ptr<const MappedFile> file = {};  // viewed by a prepared layer
  std::optional<std::uint64_t> revision = {};   // of a prepared layer: the revision under which it
                                                // was saved
  std::optional<PartNumber> part = {};          // of a part of a layer
  /// For a layer in several prepared parts: the parts. `layer` then has their fields and bounds but
  /// no polygons.
  std::shared_ptr<const PreparedParts> parts = {};
  /// For a whole prepared layer: the label anchors of all parts (see LabelAnchors), in memory that
  /// the layer keeps. Empty for other layers, for which they have to be computed.
  std::span<const LabelAnchor> label_anchors = {};
};

/// Opens `path` read-only with one of the allowed vector drivers and reads all polygons of all its
/// layers (from OpenStreetMap: its areas), each in its own reference system. Without one,
/// coordinates are interpreted as degrees if possible. Geometry beyond the 180th meridian reappears
/// on the other side; geometry beyond the Web Mercator square towards the poles is cut off.
///
/// Features are in the order of the source, with one row of the table for each feature that has
/// polygons, drawn or not. The result does not depend on the number of threads. Throws
/// std::runtime_error that names the source if it cannot be opened, has no layer, lacks the
/// selected content, breaks off, or cannot be projected to Web Mercator. Bad features never throw;
/// they are reported.
///
/// Thread-safety: may be called from several threads at the same time.
LoadedLayer load_layer(const std::string& path, const LoadOptions& options = {});

}  // namespace trapeze
