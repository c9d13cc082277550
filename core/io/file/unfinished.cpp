#include "core/io/file/unfinished.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <mutex>
#include <random>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace trapeze {
namespace {

namespace fs = std::filesystem;

/// Everything that this process is writing. Never destroyed, because the process may end at any
/// time.
struct Register {
  std::mutex mutex;
  std::set<std::string> paths;
};
Register& all_unfinished() {
  // NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): it is a register
  static Register& all = *new Register;
  return all;
}

/// The process id in a name that consists of `prefix`, a number and possibly a dash with anything
/// behind it; 0 for any other name.
pid_t process_in(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return 0;
  name.remove_prefix(prefix.size());
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  const bool is_all = end == name.data() + name.size() || *end == '-';
  return error == std::errc() && is_all && process > 0 ? process : 0;
}

bool is_gone(pid_t process) {
  return process == getpid() || (kill(process, 0) != 0 && errno == ESRCH);
}

/// A leftover with this process's id was left by an earlier process with the same id.
void remove_left_over(const fs::path& prefix) {
  const fs::path folder = prefix.has_parent_path() ? prefix.parent_path() : fs::path(".");
  const std::string name = prefix.filename().string();
  std::error_code ignored;
  std::vector<fs::path> left;
  for (auto entry = fs::directory_iterator(folder, ignored); entry != fs::directory_iterator();
       entry.increment(ignored)) {
    const pid_t process = process_in(entry->path().filename().string(), name);
    if (process != 0 && is_gone(process)) left.push_back(entry->path());
  }
  for (const fs::path& path : left) fs::remove_all(path, ignored);
}

std::string name_for_this_process(const fs::path& prefix) {
  remove_left_over(prefix);
  // In another container that writes the same output, a process may have the same id: with the same
  // name, each would take what the other has written so far for its own finished file.
  std::random_device random;
  return prefix.string() + std::to_string(getpid()) + '-' + std::to_string(random());
}

/// Another thread may keep writing into the folder until the end, so removal is repeated.
void remove_for_sure(const std::string& path) {
  constexpr int kMaxAttempts = 100;
  std::error_code error;
  for (int i = 0; i < kMaxAttempts; ++i) {
    fs::remove_all(path, error);
    if (!error && !fs::exists(path, error)) return;
  }
}

}  // namespace

// Under the lock, so that remove_unfinished() knows of every folder that is made.
Unfinished::Unfinished(std::string path, Kind kind) : path_(std::move(path)) {
  const std::lock_guard lock(all_unfinished().mutex);
  if (kind == Kind::folder) fs::create_directory(path_);
  all_unfinished().paths.insert(path_);
}

Unfinished::~Unfinished() {
  const std::lock_guard lock(all_unfinished().mutex);
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  all_unfinished().paths.erase(path_);
}

Unfinished Unfinished::file_beside(const std::string& output) {
  return {name_for_this_process(output + ".tmp."), Kind::file};
}

Unfinished Unfinished::folder_beside(const std::string& output) {
  const fs::path path(output);
  const fs::path prefix = path.parent_path() / ("." + path.filename().string() + ".tmp.");
  const std::string folder = name_for_this_process(prefix);
  return {folder, Kind::folder};
}

void Unfinished::give_name(const std::string& from, const std::string& to, std::error_code& error) {
  const std::lock_guard lock(all_unfinished().mutex);
  fs::rename(from, to, error);
}

void remove_unfinished() {
  all_unfinished().mutex.lock();  // never unlocked, so that nothing is written after this
  for (const std::string& path : all_unfinished().paths) remove_for_sure(path);
}

}  // namespace trapeze
