#include "server/seed/join.h"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "core/io/file/atomic_file.h"
#include "server/seed/write_archive.h"

namespace trapeze {
namespace {

ArchiveSize size_of(const SeedLogs& logs) {
  ArchiveSize size;
  const ZoomRange zooms = logs.archive().zooms;
  constexpr std::uint64_t kMostRun = 0xffffffff;  // in PMTiles; a longer run needs several entries
  for (const SeedBlock& block : logs.blocks()) {
    size.contents += block.contents().size();
    size.fingerprints += block.fingerprints().size();
    for (int zoom = zooms.first; zoom <= zooms.last; ++zoom) {
      for (const BlockEntry& entry : block.entries(zoom)) {
        size.entries += 1 + entry.places.count / kMostRun;
      }
    }
  }
  return size;
}

/// Combines consecutive equal tiles.
class Runs {
 public:
  explicit Runs(ArchiveWriter& writer) : writer_(writer) {}

  void add(const ArchiveTiles& tiles) {
    const bool goes_on = run_ && run_->zoom == tiles.zoom && run_->digest == tiles.digest &&
                         run_->places.first + run_->places.count == tiles.places.first;
    if (goes_on) {
      run_->places.count += tiles.places.count;
      return;
    }
    finish();
    run_ = tiles;
  }
  void finish() {
    if (run_) writer_.add(*run_);
    run_.reset();
  }

 private:
  ArchiveWriter& writer_;
  std::optional<ArchiveTiles> run_;
};

/// Why a finished folder cannot get this name; empty if it can. It replaces what has the name,
/// which must be noticed before the tiles are drawn.
std::string problem_with_folder_at(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path given(path);
  const fs::path folder = given.has_filename() ? given : given.parent_path();
  if (folder.filename() == "." || folder.filename() == "..") {
    return "this is no name that the finished folder could get; name another one";
  }
  std::error_code error;
  if (fs::is_symlink(folder, error)) return "it is a symbolic link; name another folder";
  if (!fs::exists(folder, error)) return {};
  if (!fs::is_directory(folder, error)) return "it exists and is not a folder; name another one";
  if (!fs::is_empty(folder, error)) {
    return "the folder exists and is not empty; name another one";
  }
  struct stat inside {};
  struct stat outside {};
  const bool is_mounted = stat(folder.c_str(), &inside) == 0 &&
                          stat((folder / "..").c_str(), &outside) == 0 &&
                          inside.st_dev != outside.st_dev;
  return is_mounted ? "a file system is mounted there; name a folder in it" : std::string();
}

}  // namespace

void check_place_of_archive(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder = fs::absolute(path).lexically_normal();
  const fs::path parent = (folder.has_filename() ? folder : folder.parent_path()).parent_path();
  if (!fs::is_directory(parent, error)) {
    throw std::runtime_error(
        fmt::format("cannot write {}: there is no folder {}", path, parent.string()));
  }
  const bool is_folder = kind_of_archive(path) == ArchiveKind::folder;
  if (is_folder) {
    const std::string problem = problem_with_folder_at(path);
    if (!problem.empty()) {
      throw std::runtime_error(fmt::format("cannot write {}: {}", path, problem));
    }
  }
  if (!is_folder && fs::is_directory(path, error)) {
    throw std::runtime_error(fmt::format("cannot write {}: it is a folder", path));
  }
  if (kind_of_archive(path) != ArchiveKind::mbtiles) return;
  const std::string problem = problem_with_database_at(path);
  if (!problem.empty()) throw std::runtime_error(fmt::format("cannot write {}: {}", path, problem));
}

/// For an archive that would have no tiles: directories of PMTiles must not be empty.
void add_first_tile(const SeedLogs& logs, Runs& runs) {
  const ZoomRange zooms = logs.archive().zooms;
  for (int zoom = zooms.first; zoom <= zooms.last; ++zoom) {
    for (const SeedBlock& block : logs.blocks()) {
      for (const BlockEntry& entry : block.entries(zoom)) {
        const BlockContent& content = block.contents()[entry.content];
        runs.add({zoom, {entry.places.first, 1}, content.digest, block.bytes_of(content)});
        return;
      }
    }
  }
}

// A log also has the fingerprints of tiles that are left out.
void join_into_archive(const SeedLogs& logs, const std::string& path, const JoinOptions& options) {
  const bool is_sparse = options.is_sparse || kind_of_archive(path) == ArchiveKind::folder;
  const auto writer = write_archive(path, logs.archive(), size_of(logs));
  const ZoomRange zooms = logs.archive().zooms;
  Runs runs(*writer);
  bool has_tiles = false;
  for (int zoom = zooms.first; zoom <= zooms.last; ++zoom) {
    for (const SeedBlock& block : logs.blocks()) {
      for (const BlockEntry& entry : block.entries(zoom)) {
        const BlockContent& content = block.contents()[entry.content];
        if (is_sparse && content.is_empty != 0) continue;
        runs.add({zoom, entry.places, content.digest, block.bytes_of(content)});
        has_tiles = true;
      }
    }
  }
  if (!has_tiles && kind_of_archive(path) == ArchiveKind::pmtiles) add_first_tile(logs, runs);
  runs.finish();
  for (const SeedBlock& block : logs.blocks()) {
    for (const BlockFingerprint& item : block.fingerprints()) {
      const BlockContent& content = block.contents()[item.content];
      if (is_sparse && content.is_empty != 0) continue;
      writer->add_fingerprint(item.fingerprint, content.digest);
    }
  }
  writer->finish();
}

}  // namespace trapeze
