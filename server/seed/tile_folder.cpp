#include "server/seed/tile_folder.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/io/file/atomic_file.h"
#include "server/base/json_text.h"

namespace trapeze {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_write_folder(const std::string& path, const std::string& why) {
  throw std::runtime_error(fmt::format("cannot write {}: {}", path, why));
}

/// Without a trailing slash, which would hide its name.
std::string name_of_folder(const std::string& path) {
  const fs::path folder(path);
  return folder.has_filename() ? path : folder.parent_path().string();
}

void write_file(const std::string& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) fail_to_write_folder(path, std::generic_category().message(errno));
}

}  // namespace

TileFolder::TileFolder(const std::string& path, ArchiveDescription description,
                       const ArchiveSize& size)
    : path_(name_of_folder(path)),
      description_(std::move(description)),
      temporary_(Unfinished::folder_beside(path_)),
      contents_(path_, size.contents) {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_empty(path_, error)) {
    fail_to_write_folder(path_, "it exists and is not empty");
  }
}

std::string TileFolder::path_of(const TileId& tile) const {
  return fmt::format("{}/{}/{}/{}.{}", temporary_.path(), tile.z, tile.x, tile.y,
                     kTileFormatNames.name_of(description_.format));
}

void TileFolder::make_folder_of(const TileId& tile) {
  if (tile.z == zoom_ && tile.x == column_) return;
  std::error_code error;
  const fs::path folder = fs::path(path_of(tile)).parent_path();
  fs::create_directories(folder, error);
  if (error) fail_to_write_folder(path_, error.message());
  zoom_ = tile.z;
  column_ = tile.x;
}

void TileFolder::add(const ArchiveTiles& tiles) {
  ContentTable::Content& content = contents_.find_or_add(tiles.digest).content;
  for (std::uint64_t i = 0; i < tiles.places.count; ++i) {
    add_file(tile_at_place(tiles.zoom, tiles.places.first + i), tiles.bytes, content);
  }
}

// The number of hard links to a file is limited: when a link cannot be created, a new file is.
void TileFolder::add_file(const TileId& tile, std::string_view bytes,
                          ContentTable::Content& content) {
  make_folder_of(tile);
  const std::string path = path_of(tile);
  if (content.length > 0) {
    const int zoom = static_cast<int>(content.length) - 1;
    const std::string first = path_of(tile_at_place(zoom, content.place));
    if (link(first.c_str(), path.c_str()) == 0) return;
    if (errno != EMLINK && errno != EPERM && errno != EOPNOTSUPP) {
      fail_to_write_folder(path_, std::generic_category().message(errno));
    }
  }
  write_file(path, bytes);
  content.length = static_cast<std::uint32_t>(tile.z) + 1;
  content.place = place_on_curve(tile);
}

void TileFolder::write_description() {
  const ArchiveDescription& d = description_;
  Json json = {{"tilejson", "3.0.0"},
               {"name", d.name},
               {"scheme", "xyz"},
               {"tiles", {fmt::format("{{z}}/{{x}}/{{y}}.{}", kTileFormatNames.name_of(d.format))}},
               {"minzoom", d.zooms.first},
               {"maxzoom", d.zooms.last},
               {"bounds", d.bounds}};
  if (!d.description.empty()) json["description"] = d.description;
  if (!d.attribution.empty()) json["attribution"] = d.attribution;
  json["trapeze"] = {{"layers", d.layers}, {"style", d.style}, {"scale", d.scale}};
  write_file(temporary_.path() + "/tiles.json", to_text(json));
}

void TileFolder::finish() {
  write_description();
  give_name_durably(temporary_, path_);
}

}  // namespace trapeze
