// Layers as they are served, saved in a file that is mapped instead of built again.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/io/load/load_layer.h"
#include "core/io/source/source_stamp.h"
#include "core/layer/feature_table.h"
#include "core/layer/layer_part.h"
#include "core/layer/layer_size.h"

namespace trapeze {

/// A prepared layer from which another one takes over unchanged content.
struct EarlierPrepared {
  std::shared_ptr<const Layer> layer;          // null if nothing can be taken over
  std::shared_ptr<const MappedFile> file;      // viewed by the layer
  std::span<const LabelAnchor> label_anchors;  // in memory that the layer keeps
  std::string unfit;                           // why nothing can be taken over; empty if there is a
                                               // layer
  std::string path;                            // of the file; empty if there is none
};

/// Saves a layer, or a part of one, that was loaded from the source of the stamp, under the
/// `revision` that it has when opened. Replaces a prepared file of that name (see
/// write_atomically), but no other file. `grid` is the one on which it was built. Label anchors of
/// unchanged features are taken over from `earlier`. Throws std::runtime_error that names the path:
/// that of the saved file, or that of the earlier one if it is no longer the file that was opened.
void save_prepared_layer(const std::string& path, const LoadedLayer& loaded, std::uint64_t revision,
                         const SourceStamp& source, const std::string& grid = {},
                         const EarlierPrepared& earlier = {});

/// Requirements on a prepared layer.
struct PreparedDemands {
  std::optional<WeightRule> weights;  // unset: any
  std::string source;  // what it must have been prepared from; empty: the source that it records
  std::optional<CoverageMode> coverage = {};  // unset: any
  std::optional<double> close_gaps = {};      // unset: any
  std::string grid = {};                      // see LoadOptions
  std::optional<double> merge = {};           // unset: any
  std::optional<std::string> merge_by = {};   // unset: any
};

/// Maps a prepared file. The layer draws and returns the same as the saved one, and its large
/// arrays stay in the file, where all processes share them.
///
/// Every byte is checked, on all cores, before this returns (15 ms for 40 MB on two cores):
/// checksums detect accidental damage, and every index is checked, so that even a malicious file is
/// not read beyond its end. Throws std::runtime_error that names the path and the remedy if the
/// file is damaged, of another version of Trapeze, prepared otherwise than demanded, or older than
/// its source. The source itself need not exist.
LoadedLayer open_prepared_layer(const std::string& path, const PreparedDemands& demands = {});

/// What a prepared file declares about its layer before the layer is read.
struct PreparedSummary {
  std::vector<Field> fields;
  Box bounds;
  LayerSize size;
  LayerOptions options;
  LoadReport report;
  std::uint64_t revision = 0;
  SourceStamp source;
  std::optional<PartNumber> part;  // unset: it is a whole layer
  LevelCounts counts;              // of a part
  std::uint64_t fingerprint = 0;   // build_fingerprint() of the program that prepared it
  std::uint64_t file_size = 0;
};

/// Reads only the beginning of the file, which takes less than a millisecond however large it is.
/// Throws std::runtime_error that names the path and the remedy if it is not a prepared file, of
/// another version of Trapeze, truncated, or damaged in its beginning.
PreparedSummary read_prepared_summary(const std::string& path);

/// Throws std::runtime_error that names the path and the remedy if this version of Trapeze builds
/// layers differently, or if the file was prepared otherwise than demanded or is older than its
/// source.
void check_prepared_summary(const std::string& path, const PreparedSummary& summary,
                            const PreparedDemands& demands);

/// Maps the prepared file with that summary and checks every byte of it. Afterwards no page stays
/// resident: each becomes resident when it is read. The source is not checked. Throws
/// std::runtime_error that names the path if it is no longer the same file, or is damaged.
LoadedLayer open_summarized_layer(const std::string& path, const PreparedSummary& summary);

/// Maps a prepared file for LoadOptions::earlier, whatever it was prepared from. A file of another
/// version of Trapeze, or prepared with options other than these, is unfit. Throws
/// std::runtime_error that names the path if the file is missing, is not a prepared file, or is
/// damaged.
EarlierPrepared open_earlier_layer(const std::string& path, const LayerOptions& options,
                                   const std::string& grid = {});

/// The same for a file in memory, which is kept alive by `memory` and begins at a multiple of 64
/// bytes. Its source and its fingerprint are not checked. Throws std::exception.
LoadedLayer layer_of_prepared_bytes(std::span<const std::byte> bytes,
                                    std::shared_ptr<const void> memory);

}  // namespace trapeze
