#include "server/data/source_files.h"

#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/io/prepared/prepared_parts.h"
#include "server/config/load_config.h"

namespace trapeze {
namespace {

// A Shapefile consists of several files, one of which is named. GDAL takes either spelling of the
// others, whatever that of the named one.
constexpr std::array<std::string_view, 8> kBesideShapefile = {".dbf", ".shx", ".prj", ".cpg",
                                                              ".DBF", ".SHX", ".PRJ", ".CPG"};

/// The log into which SQLite may write changes before it transfers them to the file.
std::string write_ahead_log_of(const std::string& source) {
  return source + "-wal";
}

/// The files that currently match, and the folder, which changes when files are added or removed.
void append_parts(const std::string& pattern, std::vector<std::string>& files) {
  const std::filesystem::path folder = std::filesystem::path(pattern).parent_path();
  files.push_back(folder.empty() ? "." : folder.string());
  try {
    for (std::string& file : files_of_pattern(pattern)) files.push_back(std::move(file));
  } catch (const std::runtime_error&) {
    // There are none, which will be reported when they are read.
  }
}

/// Whether the source is a single file that receives all changes directly.
bool is_in_one_file(const std::string& source) {
  std::error_code error;
  return is_file_path(source) && std::filesystem::is_regular_file(source, error) &&
         !std::filesystem::exists(write_ahead_log_of(source), error);
}

}  // namespace

void append_files(const std::string& source, std::vector<std::string>& files) {
  if (!is_file_path(source)) return;
  if (is_pattern_of_files(source)) return append_parts(source, files);
  files.push_back(source);
  const std::filesystem::path named(source);
  if (named.extension() != ".shp" && named.extension() != ".SHP") {
    files.push_back(write_ahead_log_of(source));
    return;
  }
  for (const std::string_view ending : kBesideShapefile) {
    files.push_back(std::filesystem::path(named).replace_extension(ending).string());
  }
}

std::string state_of_files(const std::vector<std::string>& paths) {
  std::string state;
  for (const std::string& path : paths) {
    struct stat status {};
    // A file that must not be read counts as missing too: it is read once that has been put right,
    // which changes neither its size nor its time.
    const bool is_there = stat(path.c_str(), &status) == 0 && access(path.c_str(), R_OK) == 0;
    // An empty file counts as missing: reading an SQLite database may create an empty log and
    // remove it.
    if (!is_there || (S_ISREG(status.st_mode) && status.st_size == 0)) {
      state += "-;";
      continue;
    }
    state += fmt::format("{}:{}:{}:{}.{};", status.st_dev, status.st_ino, status.st_size,
                         status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
  }
  return state;
}

std::string state_of_sources(const LayerConfig& layer) {
  // For a prepared layer, the file it was prepared from is only compared with it.
  if (!is_in_one_file(layer.file_to_open())) return {};
  std::vector<std::string> files;
  append_files(layer.file, files);
  append_files(layer.prepared, files);
  return state_of_files(files);
}

}  // namespace trapeze
