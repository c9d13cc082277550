#include "server/http/static_files.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

namespace trapeze {
namespace {

namespace fs = std::filesystem;

class StaticFilesTest : public ::testing::Test {
 protected:
  StaticFilesTest() {
    write("secret.txt", "secret");
    write("web/index.html", "<p>index</p>");
    write("web/lib/map.js", "map()");
    write("web/lib/index.html", "<p>lib</p>");
    write("web/.hidden", "hidden");
    write("web/.git/config", "hidden");
  }
  ~StaticFilesTest() override { fs::remove_all(folder_); }

  void write(const std::string& path, const std::string& text) const {
    fs::create_directories((folder_ / path).parent_path());
    std::ofstream(folder_ / path) << text;
  }
  std::string root() const { return (folder_ / "web").string(); }

  const fs::path folder_ = fs::path(::testing::TempDir()) /
                           (std::string("static_files_test_") +
                            ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(StaticFilesTest, ServesWhatIsInTheFolderAndIndexesFolders) {
  const StaticFiles files(root());
  EXPECT_EQ(files.size(), 3u);
  ASSERT_NE(files.find("/"), nullptr);
  EXPECT_EQ(*files.find("/")->bytes, "<p>index</p>");
  EXPECT_EQ(files.find("/")->content_type, "text/html; charset=utf-8");
  EXPECT_EQ(*files.find("/lib/")->bytes, "<p>lib</p>");
  EXPECT_EQ(*files.find("/lib/map.js")->bytes, "map()");
  EXPECT_EQ(files.find("/lib/map.js")->content_type, "text/javascript; charset=utf-8");
}

TEST_F(StaticFilesTest, WorksWithASlashAtTheEndOfTheRoot) {
  EXPECT_NE(StaticFiles(root() + "/").find("/lib/map.js"), nullptr);
}

TEST_F(StaticFilesTest, NoPathEscapesTheFolder) {
  const StaticFiles files(root());
  for (const char* path :
       {"/../secret.txt", "/lib/../../secret.txt", "/./index.html", "//index.html", "/.hidden",
        "/.git/config", "/lib", "", "index.html", "/lib/../index.html"}) {
    EXPECT_EQ(files.find(path), nullptr) << path;
  }
}

TEST_F(StaticFilesTest, TagsFollowTheContents) {
  const std::string before = StaticFiles(root()).find("/")->entity_tag;
  EXPECT_EQ(StaticFiles(root()).find("/")->entity_tag, before);
  write("web/index.html", "<p>other</p>");
  EXPECT_NE(StaticFiles(root()).find("/")->entity_tag, before);
}

TEST_F(StaticFilesTest, TextIsKeptCompressedToo) {
  write("web/long.js", std::string(5000, 'x'));
  write("web/photo.png", std::string(5000, 'x'));
  const StaticFiles files(root());
  const StaticFile* script = files.find("/long.js");
  ASSERT_NE(script->in(ContentEncoding::gzip), nullptr);
  EXPECT_LT(script->in(ContentEncoding::gzip)->size(), 500u);
  EXPECT_EQ(script->in(ContentEncoding::identity), script->bytes);
  EXPECT_TRUE(files.find("/photo.png")->encodings().empty()) << "of its kind it is compressed";
  EXPECT_TRUE(files.find("/")->encodings().empty()) << "short";
}

TEST(ViewerFilesTest, TheViewerOfTheProgramIsWholeAndSmall) {
  if (viewer_files().empty()) GTEST_SKIP() << "built without the viewer";
  const StaticFiles files(viewer_files());
  std::size_t sent = 0;
  for (const BuiltInFile& file : viewer_files()) {
    const bool is_shown =
        !file.path.starts_with("/leaflet/images/") && !file.path.ends_with(".txt");
    sent += !is_shown ? 0 : file.brotli.empty() ? file.bytes.size() : file.brotli.size();
    const StaticFile* found = files.find(std::string(file.path));
    ASSERT_NE(found, nullptr) << file.path;
    EXPECT_EQ(*found->bytes, file.bytes);
    if (file.gzip.empty()) continue;
    EXPECT_LT(file.gzip.size(), file.bytes.size()) << file.path;
    EXPECT_TRUE(file.gzip.starts_with("\x1f\x8b")) << file.path;
  }
  EXPECT_NE(files.find("/"), nullptr);
  EXPECT_NE(files.find("/leaflet/leaflet.js"), nullptr);
  EXPECT_LE(sent, 120'000u) << "what a browser that opens the page is sent";
}

TEST_F(StaticFilesTest, AMissingFolderIsAnErrorThatNamesIt) {
  try {
    StaticFiles files(root() + "/nosuch");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("/nosuch"));
  }
}

}  // namespace
}  // namespace trapeze
