#include "core/io/file/unfinished.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "core/io/file/atomic_file.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

namespace fs = std::filesystem;

/// The id of a process that no longer exists.
std::string id_of_gone_process() {
  const pid_t process = fork();
  if (process == 0) _exit(0);
  waitpid(process, nullptr, 0);
  return std::to_string(process);
}

TEST(UnfinishedTest, IsGoneWhenItHasNotGotAName) {
  const TemporaryFolder folder;
  {
    const Unfinished file = Unfinished::file_beside(folder.file("a.fgb"));
    folder.write(fs::path(file.path()).filename(), "half");
    const Unfinished inner = Unfinished::folder_beside(folder.file("b.gpkg"));
    EXPECT_TRUE(fs::is_directory(inner.path()));
  }
  EXPECT_TRUE(fs::is_empty(folder.file("")));
}

TEST(UnfinishedTest, StaysWhenItHasGotAName) {
  const TemporaryFolder folder;
  write_atomically(folder.file("a"), {});
  EXPECT_TRUE(fs::exists(folder.file("a")));
}

TEST(UnfinishedTest, WhatAKilledProcessLeftIsRemovedByTheNextForTheSameOutput) {
  const TemporaryFolder folder;
  const std::string gone = id_of_gone_process();
  const std::string alive = std::to_string(getppid());
  folder.write("a.trapeze.tmp." + gone, "");
  folder.write("a.trapeze.tmp." + alive, "");
  folder.write("a.trapeze.tmp.old", "");
  folder.write("b.trapeze.tmp." + gone, "");
  fs::create_directory(folder.file(".a.gpkg.tmp." + gone));
  folder.write(".a.gpkg.tmp." + gone + "/a.gpkg", "half");
  { const Unfinished file = Unfinished::file_beside(folder.file("a.trapeze")); }
  { const Unfinished inner = Unfinished::folder_beside(folder.file("a.gpkg")); }
  EXPECT_FALSE(fs::exists(folder.file("a.trapeze.tmp." + gone)));
  EXPECT_FALSE(fs::exists(folder.file(".a.gpkg.tmp." + gone)));
  EXPECT_TRUE(fs::exists(folder.file("a.trapeze.tmp." + alive)));
  EXPECT_TRUE(fs::exists(folder.file("a.trapeze.tmp.old")));
  EXPECT_TRUE(fs::exists(folder.file("b.trapeze.tmp." + gone)));
}

TEST(UnfinishedTest, AProcessThatEndsAtOnceTakesItAllAlong) {
  const TemporaryFolder folder;
  const pid_t process = fork();
  if (process == 0) {
    const Unfinished file = Unfinished::file_beside(folder.file("a.fgb"));
    const Unfinished inner = Unfinished::folder_beside(folder.file("b.gpkg"));
    folder.write(fs::path(file.path()).filename(), "half");
    folder.write(fs::path(inner.path()).filename().string() + "/b.gpkg-journal", "half");
    remove_unfinished();
    _exit(0);
  }
  waitpid(process, nullptr, 0);
  EXPECT_TRUE(fs::is_empty(folder.file("")));
}

TEST(UnfinishedTest, AFolderThatCannotBeMadeIsToldOf) {
  const TemporaryFolder folder;
  EXPECT_THROW(Unfinished::folder_beside(folder.file("missing/a.gpkg")), std::system_error);
}

}  // namespace
}  // namespace trapeze
