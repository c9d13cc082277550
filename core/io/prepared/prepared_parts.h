// A layer that was prepared in several parts, each in its own file, possibly with an overview of
// them all for low zooms.
//
// When the layer is opened, only the beginnings of the files are read: the list of parts, their
// extents and their sizes. A part is mapped and checked when it is first needed; only pages that
// are read then stay resident.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/io/file/mapped_file.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Thread-safety: any number of threads may call any function.
class PreparedPart {
 public:
  PreparedPart(std::string path, PreparedSummary summary)
      : path_(std::move(path)), summary_(std::move(summary)) {}
  /// A part with the contents of `earlier`, whose layer it shares if that has been opened. What
  /// else its file declares, such as the state of the source, is that of `summary`.
  PreparedPart(std::string path, PreparedSummary summary, const PreparedPart& earlier);

  const std::string& path() const { return path_; }
  const PreparedSummary& summary() const { return summary_; }
  const PartNumber& number() const { return *summary_.part; }

  /// Mapped and checked on the first call, which takes about 0.4 ms per megabyte. Null if that
  /// fails: then is_damaged() is true. Throws if only memory or descriptors are short: the next
  /// call tries again.
  std::shared_ptr<const Layer> layer() const;
  /// Null if layer() has not been called so far.
  std::shared_ptr<const Layer> layer_if_open() const;
  /// Whether its file could not be opened when it was needed, or has been written to since.
  bool is_damaged() const;
  /// The problem found when it was opened; empty if there was none.
  std::string problem() const;

 private:
  const std::string path_;
  const PreparedSummary summary_;
  mutable std::mutex mutex_;  // guards the members below
  mutable std::shared_ptr<const Layer> layer_;
  mutable std::shared_ptr<const MappedFile> file_;
  mutable std::string problem_;
  mutable std::atomic<bool> has_failed_ = false;
};

/// Immutable except that parts are opened. Thread-safety: any number of threads may read.
class PreparedParts {
 public:
  /// `parts` in order of number; `overview` may be null.
  PreparedParts(std::vector<std::shared_ptr<const PreparedPart>> parts,
                std::shared_ptr<const PreparedPart> overview);

  const std::vector<std::shared_ptr<const PreparedPart>>& parts() const { return parts_; }
  const std::shared_ptr<const PreparedPart>& overview() const { return overview_; }

  /// Changes if and only if any part or the overview changes.
  std::uint64_t revision() const { return revision_; }
  LayerSize size() const { return size_; }
  /// Total size of all files, in bytes.
  std::uint64_t file_size() const { return file_size_; }
  /// Whether no part is known to be damaged; only parts that have been opened are checked.
  bool is_whole() const;
  /// The same, but up to a twentieth of a second old, for frequent calls: hundreds of files may
  /// have to be checked.
  bool was_whole_lately() const;

 private:
  std::vector<std::shared_ptr<const PreparedPart>> parts_;
  std::shared_ptr<const PreparedPart> overview_;
  std::uint64_t revision_ = 0;
  LayerSize size_;
  std::uint64_t file_size_ = 0;
  mutable std::atomic<std::int64_t> looked_at_ = 0;  // for was_whole_lately(), in nanoseconds
  mutable std::atomic<bool> was_whole_ = true;
};

/// Whether it is a file name pattern: its last component contains a `*` or a `?`, and no file has
/// that very name.
bool is_pattern_of_files(const std::string& path);
/// The regular files in the folder that match the pattern, in which `*` matches any characters and
/// `?` any single one, in order. Throws std::runtime_error that names the pattern if there is none.
std::vector<std::string> files_of_pattern(const std::string& pattern);

/// A digest of the revisions of the parts, in order.
std::uint64_t revision_of_parts(const std::vector<std::shared_ptr<const PreparedPart>>& parts);

/// Opens the parts in these files. The layers of parts that are unchanged in `earlier`, if not
/// null, are taken from there. Throws std::runtime_error that names the files if one is not a part,
/// or was prepared otherwise than demanded, otherwise than another one, or from another state of
/// the source; if a part is missing or occurs twice; or if an overview was made from other parts.
LoadedLayer open_prepared_parts(const std::vector<std::string>& files,
                                const PreparedDemands& demands,
                                const PreparedParts* earlier = nullptr);

/// The same without an overview, for creating one.
std::vector<std::shared_ptr<const PreparedPart>> find_prepared_parts(
    const std::vector<std::string>& files, const PreparedDemands& demands);

}  // namespace trapeze
