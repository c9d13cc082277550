// A folder of images, DIR/{z}/{x}/{y}.png, to be served by any file server. Equal tiles are hard
// links to one file, as far as the file system supports that. There are no files for tiles that
// show nothing.
#pragma once

#include <cstdint>
#include <string>

#include "core/io/file/unfinished.h"
#include "server/seed/archive.h"
#include "server/seed/content_table.h"

namespace trapeze {

class TileFolder final : public ArchiveWriter {
 public:
  /// Also throws std::runtime_error if there is a non-empty folder with that name.
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
  int zoom_ = -1;  // of the folder created last
  std::uint32_t column_ = 0;
};

}  // namespace trapeze
