// Identifies the state of a source: the files it consists of, with size, time and contents.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace trapeze {

struct FileStamp {
  std::string name;  // relative to the folder that the source lies in
  std::uint64_t size = 0;
  std::int64_t modified = 0;  // nanoseconds since 1970
  std::uint64_t checksum = 0;
};

struct SourceStamp {
  std::string path;              // absolute; of what is no file of this machine, its kind only
  std::vector<FileStamp> files;  // none if the source is no file of this machine
};

/// Opens the source to ask for its files (a Shapefile has several), and reads them all. Of archives
/// and of what is remote nothing is kept. Throws std::runtime_error that names the path.
SourceStamp stamp_source(const std::string& path);

/// In words, what has changed of the files since they were stamped, when the source is now called
/// `path`; nothing if they are the same or not there. Contents are only read where size and time do
/// not tell.
std::string change_since(const SourceStamp& stamp, const std::string& path);

}  // namespace trapeze
