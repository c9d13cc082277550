#include "core/io/file/atomic_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

namespace fs = std::filesystem;

std::string read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// A process of another container may have the same id.
TEST(AtomicFileTest, NeverGivesTheNameToWhatAnotherHasNotFinished) {
  const TemporaryFolder folder;
  const std::string path = folder.file("file");
  AtomicFile first(path);
  first.write(bytes_of("first"));
  AtomicFile second(path);
  second.write(bytes_of("sec"));
  EXPECT_THROW(first.finish(), std::runtime_error);
  EXPECT_FALSE(fs::exists(path));
  second.write(bytes_of("ond"));
  second.finish();
  EXPECT_EQ(read(path), "second");
}

TEST(AtomicFileTest, HasItsNameOnlyOnceItIsFinished) {
  const TemporaryFolder folder;
  const std::string path = folder.write("file", "before");
  AtomicFile file(path);
  file.write(bytes_of("head body"));
  file.write_at(0, bytes_of("HEAD"));
  file.write(bytes_of(" end"));
  EXPECT_EQ(read(path), "before");
  file.finish();
  EXPECT_EQ(read(path), "HEAD body end");
}

TEST(AtomicFileTest, LeavesNothingIfItIsNotFinished) {
  const TemporaryFolder folder;
  { AtomicFile(folder.file("file")).write(bytes_of("half")); }
  EXPECT_TRUE(fs::is_empty(fs::path(folder.file("file")).parent_path()));
}

TEST(AtomicFileTest, SaysWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THROW(AtomicFile(folder.file("none/file")), std::runtime_error);
}

TEST(AtomicFileTest, AFolderIsGivenItsNameAsAWhole) {
  const TemporaryFolder folder;
  const std::string path = folder.file("tiles");
  fs::create_directory(path);
  const auto unfinished = Unfinished::folder_beside(path);
  std::ofstream(unfinished.path() + "/0.png") << "tile";
  give_name_durably(unfinished, path);
  EXPECT_EQ(read(path + "/0.png"), "tile");
  std::ofstream(unfinished.path()) << "";
  EXPECT_THROW(give_name_durably(unfinished, folder.file("none/tiles")), std::runtime_error);
}

}  // namespace
}  // namespace trapeze
