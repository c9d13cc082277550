// The files of the viewer, taken once at the start, from the program or from a folder. Only what
// was found then can be served, so no path in a URL can lead anywhere else.
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
  std::string entity_tag;  // of the bytes as they are: strong, in its quotes
  std::shared_ptr<const std::string> bytes;
  std::shared_ptr<const std::string> gzip = {};    // null where it would not be smaller, as the
  std::shared_ptr<const std::string> brotli = {};  // next, which not every build makes of a folder

  /// The encodings that it is kept in beside identity, the smallest first.
  std::vector<ContentEncoding> encodings() const;
  /// Null if it is not kept in that one.
  const std::shared_ptr<const std::string>& in(ContentEncoding encoding) const;
};

class StaticFiles {
 public:
  /// No files at all.
  StaticFiles() = default;
  /// Reads all regular files below `root`, but not those whose name begins with '.', nor those of
  /// more than 32 MB (they are logged). Throws std::runtime_error if `root` is not a folder that
  /// can be read.
  explicit StaticFiles(const std::string& root);

  explicit StaticFiles(std::span<const BuiltInFile> files);

  /// `path` is decoded and begins with '/'; one that ends with '/' means its index.html. Null if
  /// there is no such file.
  const StaticFile* find(const std::string& path) const;
  std::size_t size() const { return files_.size(); }

 private:
  std::unordered_map<std::string, StaticFile> files_;  // by path, "/index.html"
};

/// By the ending of the name; application/octet-stream if it is unknown.
std::string content_type_of(const std::string& file_name);

}  // namespace trapeze
