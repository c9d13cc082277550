// Identifies the state of a source: its files, with their sizes, times and contents.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace trapeze {

struct FileStamp {
  std::string name;  // relative to the folder of the source
  std::uint64_t size = 0;
  std::int64_t modified = 0;  // nanoseconds since 1970
  std::uint64_t checksum = 0;
};

struct SourceStamp {
  std::string path;              // absolute; only the kind for sources that are no local file
  std::vector<FileStamp> files;  // empty if the source is no local file
};

/// Opens the source to list its files (a Shapefile has several), and reads them all. Nothing is
/// recorded for archives and remote sources. Throws std::runtime_error that names the path.
SourceStamp stamp_source(const std::string& path);

/// What has changed in the files since they were stamped, in words, if the source is now at `path`;
/// empty if they are unchanged or missing. Contents are read only where size and time do not
/// decide.
std::string change_since(const SourceStamp& stamp, const std::string& path);

}  // namespace trapeze
