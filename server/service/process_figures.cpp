#include "server/service/process_figures.h"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>

namespace trapeze {
namespace {

constexpr int kFieldsBeforeStartTime = 19;  // in /proc/self/stat, after the program name

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
}

/// The value in a line "name value" of a file.
double value_in(const char* path, const std::string& name) {
  std::ifstream file(path);
  std::string word;
  double value = 0;
  while (file >> word) {
    if (word == name && file >> value) return value;
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0;
}

double start_time() {
  std::ifstream file("/proc/self/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_end = line.rfind(')');  // the name may contain anything
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(line.substr(name_end + 1));
  std::string skipped;
  for (int i = 0; i < kFieldsBeforeStartTime; ++i) fields >> skipped;
  double ticks = 0;
  fields >> ticks;
  return value_in("/proc/stat", "btime") + ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::size_t count_open_files() {
  std::error_code error;
  const std::filesystem::directory_iterator files("/proc/self/fd", error);
  if (error) return 0;
  return static_cast<std::size_t>(std::distance(begin(files), end(files))) - 1;  // without this one
}

}  // namespace

ProcessFigures process_figures() {
  ProcessFigures figures;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::ifstream memory("/proc/self/statm");
  memory >> figures.virtual_bytes >> figures.resident_bytes;
  figures.virtual_bytes *= page;
  figures.resident_bytes *= page;
  figures.peak_resident_bytes =
      static_cast<std::size_t>(value_in("/proc/self/status", "VmHWM:")) * 1024;
  figures.open_files = count_open_files();
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) == 0) figures.max_files = files.rlim_cur;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    figures.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  }
  figures.start_time = start_time();
  return figures;
}

}  // namespace trapeze
