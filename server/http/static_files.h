// The files of the viewer, read once at the start, from the binary or from a folder. Only files
// found then can be served, so no path in a URL can lead anywhere else.
//
// Thread-safety: immutable, any number of threads may read.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/http/content_encoding.h"
#include "server/http/viewer_files.h"

namespace trapeze {

struct StaticFile {
  std::string content_type;
  std::string entity_tag;  // of the uncompressed bytes: strong, with its quotes
  std::shared_ptr<const std::string> bytes;
  std::shared_ptr<const std::string> gzip = {};    // null if it would not be smaller; the same
  std::shared_ptr<const std::string> brotli = {};  // here, which not all builds make of folders

  /// The encodings it is available in besides identity, the smallest first.
  std::vector<ContentEncoding> encodings() const;
  /// Null if it is not available in that encoding.
  const std::shared_ptr<const std::string>& in(ContentEncoding encoding) const;
};

class StaticFiles {
 public:
  /// Contains no files.
  StaticFiles() = default;
  /// Reads all regular files below `root`, except those whose name begins with '.' and those of
  /// more than 32 MB (these are logged). Throws std::runtime_error if `root` is not a readable
  /// folder.
  explicit StaticFiles(const std::string& root);

  explicit StaticFiles(std::span<const BuiltInFile> files);

  /// `path` is decoded and begins with '/'; a path ending with '/' refers to its index.html. Null
  /// if there is no such file.
  const StaticFile* find(const std::string& path) const;
  std::size_t size() const { return files_.size(); }

 private:
  std::unordered_map<std::string, StaticFile> files_;  // by path, "/index.html"
};

/// Determined by the file name extension; application/octet-stream if it is unknown.
std::string content_type_of(const std::string& file_name);

}  // namespace trapeze
