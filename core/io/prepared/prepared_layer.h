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

/// A prepared layer of which another one is to take over what has not changed.
struct EarlierPrepared {
  std::shared_ptr<const Layer> layer;          // null if nothing can be taken over
  std::shared_ptr<const MappedFile> file;      // that the layer looks at
  std::span<const LabelAnchor> label_anchors;  // in memory that the layer keeps
  std::string unfit;                           // why nothing can be; empty if there is a layer
  std::string path;                            // of the file; empty if there is none to look at
};

/// Saves a layer that was loaded from the source of the stamp, or a part of one, under a `revision`
/// that it is to have when it is opened. A prepared file of that name is replaced, see
/// write_atomically; any other one is not. `grid` is the one it was built on. Where labels go is
/// taken over from `earlier`, of features that are as they were. Throws std::runtime_error that
/// names the path: of what is saved, or of what was taken over from if that is no longer what was
/// opened.
void save_prepared_layer(const std::string& path, const LoadedLayer& loaded, std::uint64_t revision,
                         const SourceStamp& source, const std::string& grid = {},
                         const EarlierPrepared& earlier = {});

/// The demands on a prepared layer.
struct PreparedDemands {
  std::optional<WeightRule> weights;  // unset: any
  std::string source;  // what it must have been prepared from; empty: what it names itself
  std::optional<CoverageMode> coverage = {};  // unset: any
  std::optional<double> close_gaps = {};      // unset: any
  std::string grid = {};                      // see LoadOptions
  std::optional<double> merge = {};           // unset: any
  std::optional<std::string> merge_by = {};   // unset: any
};

/// Maps a prepared file. The layer draws and answers as the one that was saved, and its large
/// arrays stay in the file, where all processes share them.
///
/// Every byte is checked, on all cores, before this returns (15 ms for 40 MB on two cores):
/// checksums detect accidental damage, and every index is checked, so that even a malicious file is
/// not read beyond its end. Throws std::runtime_error that names the path and says what to do if
/// the file is damaged, of another version of Trapeze, prepared otherwise than demanded, or older
/// than its source. The source itself need not exist.
LoadedLayer open_prepared_layer(const std::string& path, const PreparedDemands& demands = {});

/// What a prepared file says of its layer before the layer is looked at.
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
  std::uint64_t fingerprint = 0;   // build_fingerprint() of whoever prepared it
  std::uint64_t file_size = 0;
};

/// Looks at the beginning of the file only, which takes less than a millisecond however large it
/// is. Throws std::runtime_error that names the path and says what to do if it is no prepared file,
/// of another version of Trapeze, cut off, or damaged in its beginning.
PreparedSummary read_prepared_summary(const std::string& path);

/// Throws std::runtime_error that names the path and says what to do if this version of Trapeze
/// builds layers otherwise, if it was prepared otherwise than demanded, or is older than its
/// source.
void check_prepared_summary(const std::string& path, const PreparedSummary& summary,
                            const PreparedDemands& demands);

/// Maps a prepared file of which that is the summary, and checks every byte of it, after which
/// none of its pages is held: each becomes resident when it is looked at. Its source is not
/// checked. Throws std::runtime_error that names the path if it is not the same file any longer, or
/// damaged.
LoadedLayer open_summarized_layer(const std::string& path, const PreparedSummary& summary);

/// Maps a prepared file for LoadOptions::earlier, whatever it was prepared from. A file of another
/// version of Trapeze, or prepared with other options than these, is unfit. Throws
/// std::runtime_error that names the path if there is no file, or one that is no prepared file or
/// is damaged.
EarlierPrepared open_earlier_layer(const std::string& path, const LayerOptions& options,
                                   const std::string& grid = {});

/// The same of a file in memory, kept by `memory` and beginning at a multiple of 64 bytes; its
/// source and its fingerprint are not checked. Throws std::exception.
LoadedLayer layer_of_prepared_bytes(std::span<const std::byte> bytes,
                                    std::shared_ptr<const void> memory);

}  // namespace trapeze
