#include "core/io/source/source_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>
#include <string_view>

#include "core/io/file/checksum.h"
#include "core/io/source/open_source.h"

namespace trapeze {
namespace {

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

std::vector<std::string> files_of(const std::string& path) {
  const GDALDatasetUniquePtr dataset = open_source(path);
  const CPLStringList list(dataset->GetFileList());
  std::vector<std::string> files;
  for (int i = 0; i < list.Count(); ++i) files.emplace_back(list[i]);
  std::sort(files.begin(), files.end());
  return files;
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
    const std::string change = change_of_file(file, (folder_of(now.string()) / name).string());
    if (!change.empty()) return change;
  }
  return {};
}

}  // namespace trapeze
