// A log of what has been seeded so far, in a file: a head that describes the seeding, and the
// blocks of the finished jobs, in the order of completion. The file only grows at its end, so an
// interruption loses only unfinished jobs.
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

/// The description at the beginning of a log.
struct SeedLogHead {
  std::string identity;  // SeedPlan::identity() and all else that determines the archive
  std::uint64_t jobs = 0;
  JobRange range;  // the jobs of this log
  SeedPart part;
  ArchiveDescription archive;
};

/// A log opened for writing. Thread-safety: all methods may be called from any thread.
class SeedLog {
 public:
  /// Creates the file, or continues it: an incomplete block left by an interruption is cut off.
  /// Throws std::runtime_error that names the path if the file cannot be written, if it is the log
  /// of another seeding, or if another process writes to it.
  SeedLog(const std::string& path, const SeedLogHead& head);
  ~SeedLog();
  SeedLog(const SeedLog&) = delete;
  SeedLog& operator=(const SeedLog&) = delete;

  /// The jobs that were done when the log was opened, and the figures of their tiles.
  const std::set<std::uint64_t>& done() const { return done_; }
  const SeedFigures& figures() const { return figures_; }
  std::uint64_t bytes_of_data() const { return end_; }

  /// Appends a block. Throws std::runtime_error that names the path; the log is then unchanged.
  void append(std::span<const std::byte> block);
  /// Waits until everything is on disk. Throws like append().
  void sync();

 private:
  const std::string path_;
  int file_ = -1;
  std::set<std::uint64_t> done_;
  SeedFigures figures_;
  std::mutex mutex_;  // guards end_ and the file
  std::uint64_t end_ = 0;
};

/// Logs opened for reading: all jobs of one seeding. Thread-safety: immutable.
class SeedLogs {
 public:
  /// Throws std::runtime_error that names the path if a log cannot be read, belongs to another
  /// seeding or is unfinished, or if there is no log of some of the jobs.
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
