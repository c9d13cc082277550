// What has been seeded so far, in a file: a head that says what is seeded, and the blocks of the
// jobs that are done, in whatever order they were. It grows at its end only, so that whoever is
// interrupted loses no more than what was under way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/io/file/mapped_file.h"
#include "server/seed/archive.h"
#include "server/seed/seed_block.h"
#include "server/seed/seed_jobs.h"

namespace trapeze {

/// What a log says of itself.
struct SeedLogHead {
  std::string identity;  // see SeedPlan::identity(), with all that decides the archive
  std::uint64_t jobs = 0;
  JobRange range;  // of the jobs, those of the log
  SeedPart part;
  ArchiveDescription archive;
};

/// A log that is written. Thread-safety: all methods may be called from any thread.
class SeedLog {
 public:
  /// Makes the file, or goes on with it: what was being written when it was interrupted is cut off.
  /// Throws std::runtime_error that names the path if it cannot be written, if it is the log of
  /// something else, or if another process writes it.
  SeedLog(const std::string& path, const SeedLogHead& head);
  ~SeedLog();
  SeedLog(const SeedLog&) = delete;
  SeedLog& operator=(const SeedLog&) = delete;

  /// The jobs that were done when it was opened, and what became of their tiles.
  const std::set<std::uint64_t>& done() const { return done_; }
  const SeedFigures& figures() const { return figures_; }
  std::uint64_t bytes_of_data() const { return end_; }

  /// Appends a block. Throws std::runtime_error that names the path, the log being as it was.
  void append(std::span<const std::byte> block);
  /// Waits until all is on the disk. Throws like append().
  void sync();

 private:
  const std::string path_;
  int file_ = -1;
  std::set<std::uint64_t> done_;
  SeedFigures figures_;
  std::mutex mutex_;  // guards end_ and the file
  std::uint64_t end_ = 0;
};

/// Logs that are read: all jobs of one seeding. Thread-safety: immutable.
class SeedLogs {
 public:
  /// Throws std::runtime_error that names the path if one cannot be read, is of another seeding, or
  /// has not been finished, or if there is no log of some of the jobs.
  explicit SeedLogs(const std::vector<std::string>& paths);

  const ArchiveDescription& archive() const { return archive_; }
  /// By job.
  std::span<const SeedBlock> blocks() const { return blocks_; }
  SeedFigures figures() const;

 private:
  std::vector<std::unique_ptr<MappedFile>> files_;
  ArchiveDescription archive_;
  std::vector<SeedBlock> blocks_;
};

}  // namespace trapeze
