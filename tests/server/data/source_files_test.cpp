#include "server/data/source_files.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "server/config/load_config.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> files_of(const std::string& source) {
  std::vector<std::string> files;
  append_files(source, files);
  return files;
}

TEST(SourceFilesTest, AShapefileIsItsPartsAndAnyOtherFileHasAWriteAheadLog) {
  for (const std::string file : {"/a/b.shp", "/a/b.SHP"}) {
    EXPECT_THAT(files_of(file), ElementsAre(file, "/a/b.dbf", "/a/b.shx", "/a/b.prj", "/a/b.cpg",
                                            "/a/b.DBF", "/a/b.SHX", "/a/b.PRJ", "/a/b.CPG"));
  }
  EXPECT_THAT(files_of("/a/b.gpkg"), ElementsAre("/a/b.gpkg", "/a/b.gpkg-wal"));
  EXPECT_THAT(files_of("PG:dbname=maps"), IsEmpty());
}

TEST(SourceFilesTest, ChangesThatAreStillInTheWriteAheadLogAreSeen) {
  const TemporaryFolder folder;
  const std::vector<std::string> files = files_of(folder.write("a.gpkg", "pages"));
  const std::string before = state_of_files(files);
  folder.write("a.gpkg-wal", "");
  EXPECT_EQ(state_of_files(files), before) << "a reader makes an empty one";
  folder.write("a.gpkg-wal", "one change");
  const std::string changed = state_of_files(files);
  EXPECT_NE(changed, before);
  folder.write("a.gpkg-wal", "one change, another one");
  EXPECT_NE(state_of_files(files), changed);
}

TEST(SourceFilesTest, AFileThatMustNotBeReadIsSeenAgainOnceItMay) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const TemporaryFolder folder;
  const std::vector<std::string> files = files_of(folder.write("a.gpkg", "pages"));
  const std::string before = state_of_files(files);
  std::filesystem::permissions(files[0], std::filesystem::perms::none);
  EXPECT_NE(state_of_files(files), before);
  std::filesystem::permissions(files[0], std::filesystem::perms::owner_read);
  EXPECT_EQ(state_of_files(files), before);
}

TEST(SourceFilesTest, ALayerWithAWriteAheadLogIsNeverKnownToBeTheSame) {
  const TemporaryFolder folder;
  const auto layers = layers_of_files({folder.write("a.gpkg", "pages")});
  EXPECT_NE(state_of_sources(layers[0]), "");
  folder.write("a.gpkg-wal", "one change");
  EXPECT_EQ(state_of_sources(layers[0]), "");
}

}  // namespace
}  // namespace trapeze
