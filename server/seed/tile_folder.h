// A folder of pictures, DIR/{z}/{x}/{y}.png, as any server of files serves it. Equal tiles are one
// file of several names (hard links), as far as the file system has that. Of tiles in which nothing
// is seen there is none.
#pragma once

#include <cstdint>
#include <string>

#include "core/io/file/unfinished.h"
#include "server/seed/archive.h"
#include "server/seed/content_table.h"

namespace trapeze {

class TileFolder final : public ArchiveWriter {
 public:
  /// Throws std::runtime_error also if there is a folder of that name with something in it.
  TileFolder(const std::string& path, ArchiveDescription description, const ArchiveSize& size);

  void add(const ArchiveTiles& tiles) override;
  void finish() override;

 private:
  std::string path_of(const TileId& tile) const;
  void add_file(const TileId& tile, std::string_view bytes, ContentTable::Content& content);
  void make_folder_of(const TileId& tile);
  void write_description();

  const std::string path_;
  const ArchiveDescription description_;
  const Unfinished temporary_;
  ContentTable contents_;
  int zoom_ = -1;  // of the folder that was made last
  std::uint32_t column_ = 0;
};

}  // namespace trapeze
