// A layer that was prepared in several parts, each a file of its own, and perhaps an overview of
// them all for low zooms.
//
// When the layer is opened, only the beginnings of the files are looked at: which parts there are,
// where they lie, and how much there is in them. A part is mapped, and checked, when somebody wants
// to see something of it; what is resident then is what was looked at.
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

  const std::string& path() const { return path_; }
  const PreparedSummary& summary() const { return summary_; }
  const PartNumber& number() const { return *summary_.part; }

  /// Mapped and checked when it is asked for first, which takes about 0.4 ms a megabyte. Null if it
  /// cannot be: then is_damaged().
  std::shared_ptr<const Layer> layer() const;
  /// Null if nobody has asked for it so far.
  std::shared_ptr<const Layer> layer_if_open() const;
  /// Whether its file could not be opened when somebody asked for it, or was written into since.
  bool is_damaged() const;
  /// What was wrong when it was opened; empty if nothing was.
  std::string problem() const;

 private:
  const std::string path_;
  const PreparedSummary summary_;
  mutable std::mutex mutex_;  // guards what follows
  mutable std::shared_ptr<const Layer> layer_;
  mutable std::shared_ptr<const MappedFile> file_;
  mutable std::string problem_;
  mutable std::atomic<bool> has_failed_ = false;
};

/// Immutable but for parts that are opened. Thread-safety: any number of threads may read.
class PreparedParts {
 public:
  /// `parts` by their numbers; `overview` may be null.
  PreparedParts(std::vector<std::shared_ptr<const PreparedPart>> parts,
                std::shared_ptr<const PreparedPart> overview);

  const std::vector<std::shared_ptr<const PreparedPart>>& parts() const { return parts_; }
  const std::shared_ptr<const PreparedPart>& overview() const { return overview_; }

  /// Changes when any part or the overview does, and only then.
  std::uint64_t revision() const { return revision_; }
  LayerSize size() const { return size_; }
  /// Of all files, in bytes.
  std::uint64_t file_size() const { return file_size_; }
  /// Whether none is damaged, as far as can be told of those that were looked at.
  bool is_whole() const;
  /// The same within the last twentieth of a second, for who asks often: hundreds of files are
  /// looked at.
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

/// Whether it is the name of several files: it has a `*` or a `?` in its last part, and there is no
/// file of that very name.
bool is_pattern_of_files(const std::string& path);
/// The regular files of a folder that have such a name, in which `*` stands for any characters and
/// `?` for any one, in order. Throws std::runtime_error that names it if there is none.
std::vector<std::string> files_of_pattern(const std::string& pattern);

/// A digest of the revisions of parts, in their order.
std::uint64_t revision_of_parts(const std::vector<std::shared_ptr<const PreparedPart>>& parts);

/// The parts that these files are. Those that `earlier` has, if it is not null, are taken from
/// there if they are the same. Throws std::runtime_error, in words that name the files, if one is
/// no part, was prepared otherwise than demanded, than another one, or from another state of the
/// source; if a part is missing, or there twice; if an overview was made of other parts.
LoadedLayer open_prepared_parts(const std::vector<std::string>& files,
                                const PreparedDemands& demands,
                                const PreparedParts* earlier = nullptr);

/// The same, without an overview, for making one.
std::vector<std::shared_ptr<const PreparedPart>> find_prepared_parts(
    const std::vector<std::string>& files, const PreparedDemands& demands);

}  // namespace trapeze
