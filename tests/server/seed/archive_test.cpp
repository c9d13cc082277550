// Archives as other programs read them.
#include "server/seed/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "server/seed/earlier_archive.h"
#include "server/seed/join.h"
#include "server/seed/pmtiles_writer.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/seed/pmtiles_reader.h"
#include "tests/server/seed/seeded_tiles.h"
#include "tests/server/tiles/edited_land.h"

namespace trapeze {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::PmtilesReader;
using testing::seed_request;

ArchiveDescription description(ZoomRange zooms) {
  ArchiveDescription d;
  d.name = "Rings";
  d.attribution = "drawn by hand";
  d.zooms = zooms;
  d.bounds = {-90, -45, 90, 45.5};
  d.center = {179.25, 0.25};
  d.layers = "rings,west";
  d.style = "fill=red";
  return d;
}

/// The output of a seeding: on `threads` threads, in parts, or resumed after it was stopped.
class Seeding {
 public:
  Seeding(const SeedPlan& plan, ZoomRange zooms) : plan_(plan), zooms_(zooms) {
    KnownTiles known(plan, TilePainter::new_class_cache(), std::make_shared<LabelBook>());
    constexpr double kTilesOfJob = 24;  // so that there are many jobs
    jobs_ = divide_into_jobs(plan, known, kTilesOfJob);
  }

  const SeedJobs& jobs() const { return jobs_; }

  void run(const std::string& log, int threads = 1, const SeedPart& part = {},
           const JobPainter::FindKnown& find_known = {}) {
    std::vector<std::unique_ptr<MaskRenderer>> renderers;
    for (int i = 0; i < threads; ++i) renderers.push_back(std::make_unique<SoftwareRenderer>());
    Seeder seeder(plan_, jobs_, std::move(renderers), std::make_shared<LabelBook>(), find_known);
    SeedLog written(log, head(part));
    seeder.seed(jobs_of_part(jobs_, part), written,
                [this](const SeedProgress& progress) { progress_ = progress; });
  }
  SeedLogHead head(const SeedPart& part = {}) const {
    return {plan_.identity("software", ""), jobs_.jobs.size(), jobs_of_part(jobs_, part), part,
            description(zooms_)};
  }
  /// Progress of the last run.
  const SeedProgress& progress() const { return progress_; }

 private:
  const SeedPlan& plan_;
  ZoomRange zooms_;
  SeedJobs jobs_;
  SeedProgress progress_;
};

class ArchiveTest : public ::testing::Test {
 protected:
  static constexpr ZoomRange kZooms{0, 7};

  std::string archive(const std::string& name, const JoinOptions& options = {}) {
    if (!fs::exists(log_)) seeding_.run(log_);
    join_into_archive(SeedLogs({log_}), folder_.file(name), options);
    return folder_.file(name);
  }

  TemporaryFolder folder_;
  std::shared_ptr<const Dataset> dataset_ = testing::sample_dataset();
  SeedPlan plan_ = *SeedPlan::make(seed_request(*dataset_, kZooms, "stroke=black"), dataset_);
  Seeding seeding_{plan_, kZooms};
  std::string log_ = folder_.file("log");
  TilePainter painter_ = testing::software_painter();
};

TEST_F(ArchiveTest, PmtilesHasEveryTileOnceInOrder) {
  const PmtilesReader reader(archive("a.pmtiles"));
  std::uint64_t next = 0;
  std::uint64_t wrong = 0;
  for (const PmtilesReader::Entry& entry : reader.entries()) {
    EXPECT_EQ(entry.id, next);
    next += entry.run;
    int zoom = kZooms.last;
    while (first_id_of_zoom(zoom) > entry.id) --zoom;
    const TileId tile = tile_at_place(zoom, entry.id - first_id_of_zoom(zoom));
    if (reader.tile(entry) != testing::served_bytes(plan_, tile, painter_)) ++wrong;
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(next, plan_.count());
  EXPECT_EQ(reader.addressed_tiles(), plan_.count());
  EXPECT_EQ(reader.tile_entries(), reader.entries().size());
}

TEST_F(ArchiveTest, TilesWithMarksAreThoseOfTheServer) {
  const SeedPlan plan = *SeedPlan::make(seed_request(*dataset_, {0, 2}, "debug=tile"), dataset_);
  const std::string log = folder_.file("marked");
  Seeding(plan, {0, 2}).run(log);
  join_into_archive(SeedLogs({log}), folder_.file("marked.pmtiles"), {});
  const PmtilesReader reader(folder_.file("marked.pmtiles"));
  ASSERT_FALSE(reader.entries().empty());
  EXPECT_EQ(reader.tile(reader.entries().front()),
            testing::served_bytes(plan, tile_at_place(0, 0), painter_));
}

TEST_F(ArchiveTest, PmtilesStoresEachContentOnceInTheOrderOfItsFirstTile) {
  const PmtilesReader reader(archive("a.pmtiles"));
  std::map<std::string, std::uint64_t> places;
  std::uint64_t end = 0;
  for (const PmtilesReader::Entry& entry : reader.entries()) {
    const auto [found, is_new] = places.emplace(reader.tile(entry), entry.offset);
    EXPECT_EQ(found->second, entry.offset);
    if (!is_new) continue;
    EXPECT_EQ(entry.offset, end) << "clustered";
    end = entry.offset + entry.length;
  }
  EXPECT_EQ(reader.tile_contents(), places.size());
  EXPECT_EQ(reader.word(64), end) << "there is nothing else among the tiles";
}

TEST_F(ArchiveTest, PmtilesSaysWhatItIs) {
  const PmtilesReader reader(archive("a.pmtiles"));
  EXPECT_LE(reader.root_offset() + reader.root_length(), 16'384u);
  EXPECT_EQ(reader.byte(96), 1) << "clustered";
  EXPECT_EQ(reader.byte(97), 2) << "gzip";
  EXPECT_EQ(reader.byte(98), 1) << "tiles as they are";
  EXPECT_EQ(reader.byte(99), 2) << "PNG";
  EXPECT_EQ(reader.byte(100), kZooms.first);
  EXPECT_EQ(reader.byte(101), kZooms.last);
  EXPECT_DOUBLE_EQ(reader.degrees(102), -90);
  EXPECT_DOUBLE_EQ(reader.degrees(114), 45.5);
  EXPECT_EQ(reader.byte(118), kZooms.first);
  EXPECT_DOUBLE_EQ(reader.degrees(119), 179.25);
  EXPECT_DOUBLE_EQ(reader.degrees(123), 0.25);
  const auto json = nlohmann::json::parse(reader.metadata());
  EXPECT_EQ(json["name"], "Rings");
  EXPECT_EQ(json["attribution"], "drawn by hand");
  EXPECT_EQ(json["maxzoom"], kZooms.last);
  EXPECT_EQ(json["trapeze"]["style"], "fill=red");
}

TEST_F(ArchiveTest, PmtilesThatIsSparseHasWhatIsSeenOnly) {
  const PmtilesReader all(archive("all.pmtiles"));
  const PmtilesReader sparse(archive("sparse.pmtiles", {true}));
  EXPECT_LT(sparse.addressed_tiles(), all.addressed_tiles());
  EXPECT_EQ(sparse.tile_contents() + 1, all.tile_contents()) << "only the empty one is missing";
}

TEST_F(ArchiveTest, PmtilesThatIsSparseAndShowsNothingHasOneTile) {
  const SeedPlan plan = *SeedPlan::make(seed_request(*dataset_, {0, 3}, "opacity=0"), dataset_);
  const std::string log = folder_.file("nothing");
  Seeding(plan, {0, 3}).run(log);
  join_into_archive(SeedLogs({log}), folder_.file("nothing.pmtiles"), {true});
  const PmtilesReader reader(folder_.file("nothing.pmtiles"));
  ASSERT_EQ(reader.entries().size(), 1u) << "a directory must not be empty";
  EXPECT_EQ(reader.entries().front().id, 0u);
  EXPECT_EQ(reader.addressed_tiles(), 1u);
}

TEST_F(ArchiveTest, PmtilesOfManyEntriesHasLeavesAndARootThatFits) {
  constexpr std::uint64_t kTiles = 300'000;
  constexpr int kZoom = 10;
  PmtilesWriter writer(folder_.file("many.pmtiles"), description({kZoom, kZoom}),
                       {kTiles, kTiles, 0});
  for (std::uint64_t i = 0; i < kTiles; ++i) {
    const std::string bytes = "tile " + std::to_string(i * i);
    writer.add({kZoom, {i * 3, 1}, digest_of_bytes(bytes), bytes});
  }
  writer.finish();
  const PmtilesReader reader(folder_.file("many.pmtiles"));
  EXPECT_LE(reader.root_offset() + reader.root_length(), 16'384u);
  EXPECT_GT(reader.leaves_length(), 0u);
  const auto entries = reader.entries();
  ASSERT_EQ(entries.size(), kTiles);
  for (std::uint64_t i = 0; i < kTiles; i += 9973) {
    EXPECT_EQ(entries[i].id, first_id_of_zoom(kZoom) + i * 3);
    EXPECT_EQ(reader.tile(entries[i]), "tile " + std::to_string(i * i));
  }
}

TEST_F(ArchiveTest, PmtilesSplitsRunsThatAreTooLongForItsNumbers) {
  constexpr int kZoom = 18;
  constexpr std::uint64_t kAll = std::uint64_t{1} << 2 * kZoom;
  PmtilesWriter writer(folder_.file("long.pmtiles"), description({kZoom, kZoom}), {64, 1, 0});
  writer.add({kZoom, {0, kAll}, digest_of_bytes("sea"), "sea"});
  writer.finish();
  const PmtilesReader reader(folder_.file("long.pmtiles"));
  std::uint64_t next = first_id_of_zoom(kZoom);
  for (const PmtilesReader::Entry& entry : reader.entries()) {
    EXPECT_EQ(entry.id, next);
    EXPECT_LE(entry.run, 0xffffffffu);
    next += entry.run;
  }
  EXPECT_EQ(next, first_id_of_zoom(kZoom) + kAll);
  EXPECT_EQ(reader.addressed_tiles(), kAll);
  EXPECT_EQ(reader.tile_contents(), 1u);
}

class Database {
 public:
  explicit Database(const std::string& path) {
    EXPECT_EQ(sqlite3_open_v2(path.c_str(), &database_, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// The first value of the first row; empty if there is none.
  std::string value(const std::string& sql) {
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(database_, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
    std::string value;
    if (sqlite3_step(statement) == SQLITE_ROW) {
      const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement, 0));
      value.assign(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement, 0)));
    }
    sqlite3_finalize(statement);
    return value;
  }

 private:
  sqlite3* database_ = nullptr;
};

TEST_F(ArchiveTest, MbtilesHasEveryTileAndItsMetadata) {
  Database database(archive("a.mbtiles"));
  EXPECT_EQ(database.value("PRAGMA integrity_check"), "ok");
  EXPECT_EQ(database.value("SELECT count(*) FROM tiles"), std::to_string(plan_.count()));
  for (const TileId& tile :
       {TileId{0, 0, 0}, TileId{4, 5, 7}, TileId{6, 16, 20}, TileId{7, 3, 3}}) {
    const std::uint32_t row = (1u << tile.z) - 1 - tile.y;
    EXPECT_EQ(
        database.value("SELECT tile_data FROM tiles WHERE zoom_level = " + std::to_string(tile.z) +
                       " AND tile_column = " + std::to_string(tile.x) +
                       " AND tile_row = " + std::to_string(row)),
        testing::served_bytes(plan_, tile, painter_));
  }
  const auto metadata = [&](const std::string& name) {
    return database.value("SELECT value FROM metadata WHERE name = '" + name + "'");
  };
  EXPECT_EQ(metadata("name"), "Rings");
  EXPECT_EQ(metadata("format"), "png");
  EXPECT_EQ(metadata("bounds"), "-90,-45,90,45.5");
  EXPECT_EQ(metadata("center"), "179.25,0.25,0");
  EXPECT_EQ(metadata("minzoom"), "0");
  EXPECT_EQ(metadata("maxzoom"), "7");
  EXPECT_EQ(metadata("attribution"), "drawn by hand");
  EXPECT_EQ(metadata("trapeze:style"), "fill=red");
}

TEST_F(ArchiveTest, MbtilesStoresEachContentOnceAndLeavesOutTheEmptyOneIfItIsSparse) {
  Database all(archive("all.mbtiles"));
  EXPECT_EQ(all.value("SELECT count(*) FROM images"),
            all.value("SELECT count(DISTINCT tile_data) FROM images"));
  Database sparse(archive("sparse.mbtiles", {true}));
  EXPECT_EQ(std::stoi(sparse.value("SELECT count(*) FROM images")) + 1,
            std::stoi(all.value("SELECT count(*) FROM images")));
}

TEST_F(ArchiveTest, AFolderHasFilesOfWhatIsSeenAndOneForEqualTiles) {
  const std::string path = archive("tiles");
  EXPECT_EQ(read_file(path + "/0/0/0.png"), testing::served_bytes(plan_, {0, 0, 0}, painter_));
  EXPECT_FALSE(fs::exists(path + "/7/0/0.png")) << "nothing is seen there";
  struct stat one {};
  struct stat other {};
  ASSERT_EQ(stat((path + "/7/45/45.png").c_str(), &one), 0);
  ASSERT_EQ(stat((path + "/7/45/44.png").c_str(), &other), 0);
  EXPECT_EQ(one.st_ino, other.st_ino);
  const auto json = nlohmann::json::parse(read_file(path + "/tiles.json"));
  EXPECT_EQ(json["maxzoom"], kZooms.last);
}

TEST_F(ArchiveTest, AFolderThatHasSomethingInItIsNotReplaced) {
  const std::string path = folder_.file("full");
  fs::create_directory(path);
  std::ofstream(path + "/file") << "mine";
  EXPECT_THROW(check_place_of_archive(path), std::runtime_error);
  EXPECT_THROW(archive("full"), std::runtime_error);
  EXPECT_EQ(read_file(path + "/file"), "mine");
}

TEST_F(ArchiveTest, WhatAFolderCannotReplaceIsNoticedBeforehand) {
  const std::string file = folder_.file("empty_file");
  std::ofstream{file};
  const std::string target = folder_.file("target");
  fs::create_directory(target);
  EXPECT_NO_THROW(check_place_of_archive(target));
  EXPECT_NO_THROW(check_place_of_archive(target + "/"));
  const std::string link = folder_.file("link");
  fs::create_directory_symlink(target, link);
  for (const std::string& path : {file, target + "/.", target + "/..", link, link + "/"}) {
    EXPECT_THROW(check_place_of_archive(path), std::runtime_error) << path;
  }
}

TEST_F(ArchiveTest, BytesDoNotDependOnThreadsOrParts) {
  for (const char* name : {"one.pmtiles", "one.mbtiles"}) archive(name);
  ASSERT_GT(seeding_.jobs().jobs.size(), 20u);
  for (const std::size_t count : {2u, 3u, 8u}) {
    std::vector<std::string> parts;
    for (std::size_t i = 1; i <= count; ++i) {
      parts.push_back(folder_.file("part" + std::to_string(count) + "." + std::to_string(i)));
      seeding_.run(parts.back(), 2, {i, count});
    }
    std::reverse(parts.begin(), parts.end());
    for (const std::string ending : {".pmtiles", ".mbtiles"}) {
      join_into_archive(SeedLogs(parts), folder_.file("joined" + ending), {});
      EXPECT_EQ(read_file(folder_.file("joined" + ending)), read_file(folder_.file("one" + ending)))
          << count << " parts";
    }
  }
}

TEST_F(ArchiveTest, PartsThatAreMissingOrOfSomethingElseAreRefused) {
  const std::string first = folder_.file("first");
  const std::string second = folder_.file("second");
  seeding_.run(first, 1, {1, 2});
  EXPECT_THROW(SeedLogs({first}), std::runtime_error);
  const auto other_plan = SeedPlan::make(seed_request(*dataset_, kZooms, "stroke=red"), dataset_);
  Seeding(*other_plan, kZooms).run(second, 1, {2, 2});
  EXPECT_THROW(SeedLogs({first, second}), std::runtime_error);
  EXPECT_THROW(SeedLogs({folder_.file("rings")}), std::runtime_error);
}

TEST_F(ArchiveTest, PartsThatAreDescribedDifferentlyOrDamagedAreRefused) {
  const std::string first = folder_.file("first");
  const std::string second = folder_.file("second");
  seeding_.run(first, 1, {1, 2});
  seeding_.run(second, 1, {2, 2});
  EXPECT_NO_THROW(SeedLogs({first, second}));
  const std::string whole = read_file(first);
  for (const auto& [from, to] :
       {std::pair("\"minzoom\":0", "\"minzoom\":2"), std::pair("\"maxzoom\":7", "\"maxzoom\":9"),
        std::pair("drawn by hand", "drawn by land")}) {
    std::ofstream(first, std::ios::binary) << testing::changed(whole, from, to);
    EXPECT_THROW(SeedLogs({first, second}), std::runtime_error) << to;
  }
  SeedLogHead other = seeding_.head({2, 2});
  other.archive.attribution = "drawn by another hand";
  fs::remove(second);
  SeedLog{second, other};
  std::ofstream(first, std::ios::binary) << whole;
  try {
    SeedLogs({first, second});
    ADD_FAILURE() << "no failure";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("attribution"));
  }
}

TEST_F(ArchiveTest, GoingOnAfterAnyCutGivesTheSameBytes) {
  const std::string whole = read_file(archive("whole.pmtiles"));
  const std::string log = read_file(log_);
  const std::string cut = folder_.file("cut");
  for (const double share : {0.0, 0.0005, 0.1, 0.5, 0.77, 0.999}) {
    std::ofstream(cut, std::ios::binary)
        << log.substr(0, static_cast<std::size_t>(share * static_cast<double>(log.size())));
    seeding_.run(cut, 2);
    join_into_archive(SeedLogs({cut}), folder_.file("again.pmtiles"), {});
    EXPECT_TRUE(read_file(folder_.file("again.pmtiles")) == whole) << share;
  }
}

TEST_F(ArchiveTest, ALogOfSomethingElseIsNotGoneOnWith) {
  seeding_.run(log_);
  const auto other_plan = SeedPlan::make(seed_request(*dataset_, kZooms, "stroke=red"), dataset_);
  const std::string before = read_file(log_);
  EXPECT_THROW(Seeding(*other_plan, kZooms).run(log_), std::runtime_error);
  EXPECT_EQ(read_file(log_), before);
}

TEST_F(ArchiveTest, AFileThatIsNoLogIsLeftAlone) {
  for (const char* const text : {"notes", "trapeze seeding 1\n{\"identity\":\"of another\""}) {
    const std::string path = folder_.file("notes.txt");
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_THROW(SeedLog(path, seeding_.head()), std::runtime_error);
    EXPECT_EQ(read_file(path), text);
  }
}

TEST_F(ArchiveTest, FontsBelongToASeedingIfThereIsTextInItsTiles) {
  const auto identities_differ = [this](const std::string& style) {
    const auto plan = SeedPlan::make(seed_request(*dataset_, {0, 1}, style), dataset_);
    return plan->identity("software", "one") != plan->identity("software", "other");
  };
  EXPECT_TRUE(identities_differ("label=name"));
  EXPECT_TRUE(identities_differ("debug=tile"));
  EXPECT_FALSE(identities_differ("stroke=black"));
}

TEST_F(ArchiveTest, ALogThatIsBeingWrittenIsNotWrittenByAnother) {
  const SeedLog log(log_, seeding_.head());
  EXPECT_THROW(SeedLog(log_, seeding_.head()), std::runtime_error);
}

TEST(UpdateTest, DrawsWhatHasChangedAndGivesWhatSeedingAnewGives) {
  constexpr ZoomRange kZooms{4, 9};
  TemporaryFolder folder;
  testing::EditedLand land(7);
  const auto before = land.load();
  const auto request = [&](const Dataset& dataset) {
    auto of = seed_request(dataset, kZooms, "stroke=black&fill-opacity=0.5");
    of.bbox = GeographicBounds{-12, -12, 35, 22};
    return of;
  };
  const auto old_plan = SeedPlan::make(request(*before), before);
  Seeding(*old_plan, kZooms).run(folder.file("old"));
  join_into_archive(SeedLogs({folder.file("old")}), folder.file("old.pmtiles"), {});
  for (int i = 0; i < 6; ++i) land.edit();
  const auto after = land.load();
  const auto plan = SeedPlan::make(request(*after), after);
  Seeding anew(*plan, kZooms);
  anew.run(folder.file("anew"));
  const std::uint64_t drawn = anew.progress().figures.drawn;
  join_into_archive(SeedLogs({folder.file("anew")}), folder.file("anew.pmtiles"), {});
  const EarlierArchive earlier(folder.file("old.pmtiles"));
  Seeding update(*plan, kZooms);
  update.run(folder.file("update"), 1, {},
             [&](const Digest& fingerprint) { return earlier.find(fingerprint); });
  join_into_archive(SeedLogs({folder.file("update")}), folder.file("update.pmtiles"), {});
  EXPECT_EQ(read_file(folder.file("update.pmtiles")), read_file(folder.file("anew.pmtiles")));
  EXPECT_GT(update.progress().reused, drawn / 2);
  EXPECT_LT(update.progress().reused, drawn);
}

/// Data that do not change, and their archive.
class UnchangedDataTest : public ::testing::Test {
 protected:
  static constexpr ZoomRange kZooms{4, 8};

  UnchangedDataTest() {
    Seeding(*plan_, kZooms).run(folder_.file("old"));
    join_into_archive(SeedLogs({folder_.file("old")}), folder_.file("old.pmtiles"), {});
  }

  void update_from(const std::string& archive) {
    const EarlierArchive earlier(archive);
    update_.run(folder_.file("update"), 1, {},
                [&](const Digest& fingerprint) { return earlier.find(fingerprint); });
  }

  TemporaryFolder folder_;
  testing::EditedLand land_{7};
  std::shared_ptr<const Dataset> dataset_ = land_.load();
  Result<SeedPlan> plan_ =
      SeedPlan::make(seed_request(*dataset_, kZooms, "fill-opacity=0.5"), dataset_);
  Seeding update_{*plan_, kZooms};
};

TEST_F(UnchangedDataTest, NothingIsDrawnByAnUpdate) {
  update_from(folder_.file("old.pmtiles"));
  EXPECT_GT(update_.progress().figures.drawn, 0u);
  EXPECT_EQ(update_.progress().figures.drawn, update_.progress().reused);
  EXPECT_EQ(update_.progress().figures.alone, 0u);
}

TEST_F(UnchangedDataTest, DamagedTilesAreDrawnAgainByAnUpdate) {
  const std::string whole = read_file(folder_.file("old.pmtiles"));
  std::string damaged = whole;
  constexpr std::size_t kPlaceOfTiles = 56;  // in the header: offset and length
  std::array<std::uint64_t, 2> tiles{};
  std::memcpy(tiles.data(), whole.data() + kPlaceOfTiles, sizeof tiles);
  for (std::size_t i = tiles[0] + 40; i < tiles[0] + tiles[1]; i += 40) damaged[i] ^= 1;
  std::ofstream(folder_.file("damaged.pmtiles"), std::ios::binary) << damaged;
  update_from(folder_.file("damaged.pmtiles"));
  join_into_archive(SeedLogs({folder_.file("update")}), folder_.file("update.pmtiles"), {});
  EXPECT_EQ(update_.progress().reused, 0u);
  EXPECT_TRUE(read_file(folder_.file("update.pmtiles")) == whole);
}

TEST(UpdateTest, WhatIsNoArchiveOfOursIsRefused) {
  TemporaryFolder folder;
  std::ofstream(folder.file("a.pmtiles")) << "PMTiles\x03" << std::string(200, 'x');
  EXPECT_THROW(EarlierArchive(folder.file("a.pmtiles")), std::runtime_error);
}

TEST(SeedPartTest, PartsHaveAboutEqualCostsAndEachJobIsInOne) {
  SeedJobs jobs;
  for (std::size_t i = 0; i < 500; ++i) {
    jobs.jobs.push_back({0, 0, static_cast<double>(1 + i * 37 % 90), 0});
  }
  const double all = jobs.cost({0, jobs.jobs.size()});
  for (const std::size_t count : {1u, 3u, 8u}) {
    std::size_t next = 0;
    for (std::size_t i = 1; i <= count; ++i) {
      const JobRange range = jobs_of_part(jobs, {i, count});
      EXPECT_EQ(range.first, next);
      next = range.end;
      EXPECT_NEAR(jobs.cost(range), all / static_cast<double>(count), 100);
    }
    EXPECT_EQ(next, jobs.jobs.size());
  }
}

TEST(SeedPartTest, WordsAreTakenForPartsOnlyIfTheyAreParts) {
  EXPECT_EQ(parse_part("3/8")->number, 3u);
  for (const char* text : {"", "3", "0/8", "9/8", "3/", "/8", "a/b", "3/8x", "-1/8"}) {
    EXPECT_FALSE(parse_part(text).has_value()) << text;
  }
}

TEST(SeedPlanTest, BoxesAreTakenOnlyIfTheyLieOnTheMap) {
  EXPECT_TRUE(parse_bbox("14.1,35.7,14.6,36.1").has_value());
  EXPECT_TRUE(parse_bbox("-180,-90,180,90").has_value());
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "3,2,1,4", "1,4,3,2", "a,b,c,d", "1,2,3,4 ",
                           "-181,0,1,1", "0,86,1,87", "nan,0,1,1"}) {
    EXPECT_FALSE(parse_bbox(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace trapeze
