#include "core/io/source/source_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <cpl_conv.h>

#include "core/io/file/checksum.h"
#include "core/io/source/open_source.h"

namespace trapeze {
namespace {

/// What a Shapefile may have beside it that says where it lies and how its texts are encoded. GDAL
/// does not list one that it cannot use.
constexpr std::array kBesideShapes = {".prj", ".PRJ", ".cpg", ".CPG"};

/// The log to which SQLite appends changes, and transfers them to the file later, such as when the
/// program that made them closes it.
std::string log_of_database(const std::string& path) {
  return path + "-wal";
}

struct FileState {
  std::uint64_t size;
  std::int64_t modified;
};

/// None if there is no such file, or it cannot be accessed.
std::optional<FileState> state_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileState{static_cast<std::uint64_t>(status.st_size),
                   std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

/// Reading a database may leave an empty log.
bool is_filled(const std::string& log) {
  const auto state = state_of(log);
  return state && state->size > 0;
}

std::filesystem::path folder_of(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().parent_path();
}

std::string without_end_slash(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
}

/// A description of a source that is no local file; a connection string may contain a password.
std::string kind_of_remote(const std::string& path) {
  return path.starts_with("/vsi") ? path : "a database";
}

/// Whether one of the files has the name of this one, ignoring case and folders.
bool is_named(const std::string& file, const std::vector<std::string>& files) {
  return std::ranges::any_of(files, [&file](const std::string& other) {
    return EQUAL(CPLGetFilename(other.c_str()), CPLGetFilename(file.c_str()));
  });
}

std::vector<std::string> files_of(const std::string& path) {
  const ReadingSettings settings;  // otherwise large features of a GeoJSON are refused
  const GDALDatasetUniquePtr dataset = open_source(path);
  const CPLStringList list(dataset->GetFileList());
  std::vector<std::string> files;
  files.reserve(static_cast<std::size_t>(list.Count()));
  for (int i = 0; i < list.Count(); ++i) files.emplace_back(list[i]);
  if (std::string_view(dataset->GetDriverName()) == "ESRI Shapefile") {
    for (const char* ending : kBesideShapes) {
      const std::string file = std::filesystem::path(path).replace_extension(ending).string();
      if (state_of(file) && !is_named(file, files)) files.push_back(file);
    }
  }
  const std::string log = log_of_database(path);
  if (is_filled(log) && !is_named(log, files)) files.push_back(log);
  std::sort(files.begin(), files.end());
  return files;
}

/// A file that has come to a database, or to a Shapefile with that stem, since then, in words.
std::string addition_since(const SourceStamp& stamp, const std::string& stem,
                           const std::filesystem::path& now) {
  std::vector<std::string> names;
  names.reserve(stamp.files.size());
  for (const FileStamp& file : stamp.files) names.push_back(file.name);
  const std::string log = log_of_database(now.string());
  const std::string log_then = log_of_database(std::filesystem::path(stamp.path).filename());
  if (is_filled(log) && !is_named(log_then, names)) return log + " is new";
  if (!is_named(stem + ".shp", names)) return {};
  for (const char* ending : kBesideShapes) {
    if (is_named(stem + ending, names)) continue;
    const std::string file = (folder_of(now.string()) / now.stem()).string() + ending;
    if (state_of(file)) return file + " is new";
  }
  return {};
}

std::string change_of_file(const FileStamp& stamp, const std::string& path) {
  const auto state = state_of(path);
  if (!state) return {};
  if (state->size != stamp.size) {
    return path + " has " + std::to_string(state->size) + " bytes and had " +
           std::to_string(stamp.size);
  }
  if (state->modified == stamp.modified) return {};
  try {
    if (checksum_of_file(path) == stamp.checksum) return {};
  } catch (const std::exception& error) {
    return std::string(error.what()) + ", and its time has changed";
  }
  return path + " has other contents";
}

}  // namespace

SourceStamp stamp_source(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return {kind_of_remote(path), {}};
  SourceStamp stamp;
  stamp.path = without_end_slash(std::filesystem::absolute(path).lexically_normal().string());
  const std::filesystem::path folder = folder_of(stamp.path);
  for (const std::string& file : files_of(path)) {
    const auto state = state_of(file);
    if (!state) continue;
    stamp.files.push_back(
        {std::filesystem::absolute(file).lexically_normal().lexically_relative(folder).string(),
         state->size, state->modified, checksum_of_file(file)});
  }
  return stamp;
}

std::string change_since(const SourceStamp& stamp, const std::string& path) {
  const std::filesystem::path now = without_end_slash(path);
  const std::string stem = std::filesystem::path(stamp.path).stem().string();
  for (const FileStamp& file : stamp.files) {
    // Files that belong together differ in the part after the stem.
    const bool has_stem = file.name.starts_with(stem + ".");
    const std::string name =
        has_stem ? now.stem().string() + file.name.substr(stem.size()) : file.name;
    std::string change = change_of_file(file, (folder_of(now.string()) / name).string());
    if (!change.empty()) return change;
  }
  return addition_since(stamp, stem, now);
}

}  // namespace trapeze
