#include "server/seed/mbtiles_writer.h"

#include <spdlog/fmt/fmt.h>
#include <sqlite3.h>

#include <cerrno>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "core/io/file/atomic_file.h"

namespace trapeze {
namespace {

// The file has a temporary name until it is complete, so no journal is needed. The number is
// "MPBX", by which file(1) recognises MBTiles.
constexpr const char* kBegin =
    "PRAGMA page_size = 4096;"
    "PRAGMA journal_mode = OFF;"
    "PRAGMA synchronous = OFF;"
    "PRAGMA application_id = 0x4d504258;"
    "BEGIN;"
    "CREATE TABLE metadata (name TEXT, value TEXT);"
    "CREATE TABLE images (tile_id INTEGER PRIMARY KEY, tile_data BLOB);"
    "CREATE TABLE map (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER,"
    " tile_id INTEGER);"
    "CREATE VIEW tiles AS SELECT zoom_level, tile_column, tile_row, tile_data"
    " FROM map JOIN images ON images.tile_id = map.tile_id;";

constexpr const char* kEnd =
    "CREATE UNIQUE INDEX name ON metadata (name);"
    "CREATE UNIQUE INDEX tile_index ON map (zoom_level, tile_column, tile_row);"
    "COMMIT;";

}  // namespace

void MbtilesWriter::CloseDatabase::operator()(sqlite3* database) const {
  sqlite3_close(database);
}
void MbtilesWriter::FinalizeStatement::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

MbtilesWriter::MbtilesWriter(const std::string& path, const ArchiveDescription& description,
                             const ArchiveSize& size)
    : path_(path), temporary_(Unfinished::file_beside(path)), contents_(path, size.contents) {
  sqlite3* database = nullptr;
  const int result = sqlite3_open(temporary_.path().c_str(), &database);
  database_.reset(database);
  if (result != SQLITE_OK) fail();
  sort_beside_archive();
  execute(kBegin);
  add_content_ = prepare("INSERT INTO images VALUES (?1, ?2)");
  add_tile_ = prepare("INSERT INTO map VALUES (?1, ?2, ?3, ?4)");
  add_metadata(description);
}

MbtilesWriter::~MbtilesWriter() = default;

void MbtilesWriter::fail() const {
  throw std::runtime_error(
      fmt::format("cannot write {}: {}", path_, sqlite3_errmsg(database_.get())));
}

// Indexes are sorted in temporary files, which SQLite removes as soon as they are open. Its usual
// folders for them may be too small, or read-only as in a container.
void MbtilesWriter::sort_beside_archive() {
  const std::string folder = std::filesystem::absolute(path_).parent_path().string();
  const std::unique_ptr<char, decltype(&sqlite3_free)> sql(
      sqlite3_mprintf("PRAGMA temp_store_directory = %Q", folder.c_str()), sqlite3_free);
  execute(sql.get());
}

void MbtilesWriter::execute(const char* sql) {
  if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

MbtilesWriter::Statement MbtilesWriter::prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) fail();
  return Statement(statement);
}

void MbtilesWriter::run(const Statement& statement) {
  if (sqlite3_step(statement.get()) != SQLITE_DONE) fail();
  sqlite3_reset(statement.get());
}

void MbtilesWriter::add_metadata(const ArchiveDescription& description) {
  const auto [west, south, east, north] = description.bounds;
  const auto [longitude, latitude] = description.center;
  std::vector<std::pair<const char*, std::string>> rows = {
      {"name", description.name},
      {"format", std::string(kTileFormatNames.name_of(description.format))},
      {"bounds", fmt::format("{},{},{},{}", west, south, east, north)},
      {"center", fmt::format("{},{},{}", longitude, latitude, description.zooms.first)},
      {"minzoom", fmt::format("{}", description.zooms.first)},
      {"maxzoom", fmt::format("{}", description.zooms.last)},
      {"type", "overlay"},
      {"trapeze:layers", description.layers},
      {"trapeze:style", description.style},
      {"trapeze:scale", fmt::format("{}", description.scale)}};
  if (!description.attribution.empty()) rows.emplace_back("attribution", description.attribution);
  if (!description.description.empty()) rows.emplace_back("description", description.description);
  const Statement add = prepare("INSERT INTO metadata VALUES (?1, ?2)");
  for (const auto& [name, value] : rows) {
    sqlite3_bind_text(add.get(), 1, name, -1, SQLITE_STATIC);
    sqlite3_bind_text(add.get(), 2, value.c_str(), static_cast<int>(value.size()), SQLITE_STATIC);
    run(add);
  }
}

// Rows are counted from the south.
void MbtilesWriter::add(const ArchiveTiles& tiles) {
  const auto [content, is_new] = contents_.find_or_add(tiles.digest);
  if (is_new) {
    content.place = ++content_count_;
    sqlite3_bind_int64(add_content_.get(), 1, static_cast<sqlite3_int64>(content.place));
    sqlite3_bind_blob64(add_content_.get(), 2, tiles.bytes.data(), tiles.bytes.size(),
                        SQLITE_STATIC);
    run(add_content_);
  }
  for (std::uint64_t i = 0; i < tiles.places.count; ++i) {
    const TileId tile = tile_at_place(tiles.zoom, tiles.places.first + i);
    sqlite3_bind_int(add_tile_.get(), 1, tile.z);
    sqlite3_bind_int64(add_tile_.get(), 2, tile.x);
    sqlite3_bind_int64(add_tile_.get(), 3, (std::int64_t{1} << tile.z) - 1 - tile.y);
    sqlite3_bind_int64(add_tile_.get(), 4, static_cast<sqlite3_int64>(content.place));
    run(add_tile_);
  }
}

void MbtilesWriter::finish() {
  execute(kEnd);
  add_content_.reset();
  add_tile_.reset();
  database_.reset();
  const std::string problem = problem_with_database_at(path_);
  if (!problem.empty()) {
    throw std::runtime_error(fmt::format("cannot write {}: {}", path_, problem));
  }
  give_name_durably(temporary_, path_);
}

}  // namespace trapeze
