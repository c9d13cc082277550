// MBTiles, version 1.3: an SQLite database. Contents are in a table of their own, without
// duplicates, and the view `tiles` joins them with their places.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/io/file/unfinished.h"
#include "server/seed/archive.h"
#include "server/seed/content_table.h"

struct sqlite3;
struct sqlite3_stmt;

namespace trapeze {

class MbtilesWriter final : public ArchiveWriter {
 public:
  MbtilesWriter(const std::string& path, const ArchiveDescription& description,
                const ArchiveSize& size);
  ~MbtilesWriter() override;
  MbtilesWriter(const MbtilesWriter&) = delete;
  MbtilesWriter& operator=(const MbtilesWriter&) = delete;

  void add(const ArchiveTiles& tiles) override;
  void finish() override;

 private:
  struct CloseDatabase {
    void operator()(sqlite3* database) const;
  };
  struct FinalizeStatement {
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

  [[noreturn]] void fail() const;
  void sort_beside_archive();
  void execute(const char* sql);
  Statement prepare(const char* sql);
  void run(const Statement& statement);
  void add_metadata(const ArchiveDescription& description);

  const std::string path_;
  const Unfinished temporary_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement add_content_;
  Statement add_tile_;
  ContentTable contents_;
  std::uint64_t content_count_ = 0;
};

}  // namespace trapeze
