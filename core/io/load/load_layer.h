// Reads the polygons of any vector source that GDAL understands into a layer, on all cores.
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
  unsigned threads = 0;  // 0: one a core
  LayerOptions generalization = {};
  SourceSelection selection = {};
  /// The reference system on whose grid the layer is built, see find_target_grid(); empty: Web
  /// Mercator.
  std::string grid = {};
  /// A layer, on the same grid, of which to take over what is built of the same rings, or null: the
  /// result is the same and is there sooner. Nothing is taken over of one that was built with other
  /// options. It was built by the same program: see build_fingerprint().
  std::shared_ptr<const Layer> earlier = {};
  /// Into which the source is divided, with the same selection and options; null: it is read whole.
  std::shared_ptr<const SourceDivision> division = {};
  std::uint32_t part = 1;  // the one of its parts that is read
  /// Called from the thread that called load_layer now and then, with about the share of the time
  /// that has gone, reading and building alike: in [0, 1] and never falling, or < 0 while unknown;
  /// at the end with 1. What it throws ends the loading.
  std::function<void(double)> progress = {};
};

struct LoadedLayer {
  std::unique_ptr<Layer> layer;
  LoadReport report;
  std::shared_ptr<const MappedFile> file = {};  // that a prepared layer looks at
  std::optional<std::uint64_t> revision = {};   // of a prepared layer: under which it was saved
  std::optional<PartNumber> part = {};          // of a part of a layer
  /// Of a layer in several prepared parts: these. `layer` has their fields and bounds, and no
  /// polygon.
  std::shared_ptr<const PreparedParts> parts = {};
  /// Of a whole prepared layer: where labels go, of all parts (see LabelAnchors), in memory that
  /// the layer keeps. Empty of others, of which that has to be found.
  std::span<const LabelAnchor> label_anchors = {};
};

/// Opens `path` read-only with one of the allowed vector drivers and reads all polygons of all its
/// layers (of OpenStreetMap: its areas), each in its own reference system; without one, coordinates
/// are taken for degrees if they can be. What lies beyond the 180th meridian comes back in on the
/// other side; what lies beyond the Web Mercator square towards the poles is cut off.
///
/// Features are in the order of the source whatever the number of threads, one row of the table for
/// each feature that has polygons, drawn or not. The result does not depend on the threads. Throws
/// std::runtime_error, naming the source, if it cannot be opened, has no layer, has not what is
/// selected, breaks off, or cannot be brought to Web Mercator; bad features never throw, they are
/// reported.
///
/// Thread-safety: may be called from several threads at once.
LoadedLayer load_layer(const std::string& path, const LoadOptions& options = {});

}  // namespace trapeze
