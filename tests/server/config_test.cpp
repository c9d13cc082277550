#include "server/config.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

namespace trapeze {
namespace {

using ::testing::HasSubstr;

class ConfigTest : public ::testing::Test {
 protected:
  ~ConfigTest() override { std::filesystem::remove(path_); }

  Config read(const std::string& text) const {
    std::ofstream(path_) << text;
    return read_config(path_);
  }

  std::string error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  }

  const std::string path_ = ::testing::TempDir() + "/" +
                            ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                            ".toml";
};

TEST_F(ConfigTest, ALayerIsAFileOrAPreparedOneOrBoth) {
  const Config config = read(R"(
    [[layer]]
    name = "a"
    file = "a.fgb"
    [[layer]]
    name = "b"
    file = "b.fgb"
    prepared = "out/b.trapeze"
    weights = "raised-parents"
    [[layer]]
    name = "c"
    prepared = "c.trapeze")");
  ASSERT_EQ(config.layers.size(), 3u);
  EXPECT_THAT(config.layers[0].file_to_open(), ::testing::EndsWith("/a.fgb"));
  EXPECT_EQ(config.layers[0].weights, std::nullopt);
  EXPECT_THAT(config.layers[1].file_to_open(), ::testing::EndsWith("/out/b.trapeze"));
  EXPECT_THAT(config.layers[1].file, ::testing::EndsWith("/b.fgb"));
  EXPECT_EQ(config.layers[1].weights, WeightRule::raised_parents);
  EXPECT_EQ(config.layers[2].file, "");
  EXPECT_THAT(config.layers[2].file_to_open(), ::testing::EndsWith("/c.trapeze"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\""), HasSubstr("needs a file"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nfile = \"d.fgb\"\nweights = \"none\""),
              HasSubstr("effective-area"));
}

TEST_F(ConfigTest, ReadsEveryKey) {
  const Config config = read(R"(
    [server]
    address = "127.0.0.1"
    port = 9000
    threads = 3
    workers = 4
    queue = 17
    deadline_ms = 250
    renderer = "software"
    device = "1"
    public_url = "https://maps.example/trapeze/"
    allowed_hosts = ["maps.example", "*.cdn.example:80"]
    web_root = "web"

    [[layer]]
    name = "lakes"
    file = "water.fgb"
    title = "Lakes of the world"
    attribution = "OSM"
    description = "blue"
    min_zoom = 2
    max_zoom = 9
    style = { fill = "teal", fill_opacity = 0.25 }

    [[layer]]
    name = "land"
    file = "/data/land.fgb"
  )");
  EXPECT_EQ(config.server.address, "127.0.0.1");
  EXPECT_EQ(config.server.port, 9000);
  EXPECT_EQ(config.server.threads, 3u);
  EXPECT_EQ(config.server.workers, 4u);
  EXPECT_EQ(config.server.queue, 17u);
  EXPECT_EQ(config.server.deadline_ms, 250u);
  EXPECT_EQ(config.server.renderer.kind, RendererKind::software);
  EXPECT_EQ(config.server.renderer.device, "1");
  EXPECT_EQ(config.server.public_url, "https://maps.example/trapeze");
  EXPECT_EQ(config.server.allowed_hosts,
            (std::vector<std::string>{"maps.example", "*.cdn.example:80"}));
  const auto folder = std::filesystem::path(path_).parent_path();
  EXPECT_EQ(std::filesystem::path(config.server.web_root), (folder / "web").lexically_normal());
  ASSERT_EQ(config.layers.size(), 2u);
  const LayerConfig& lakes = config.layers[0];
  EXPECT_EQ(lakes.name, "lakes");
  EXPECT_EQ(std::filesystem::path(lakes.file), (folder / "water.fgb").lexically_normal());
  EXPECT_EQ(lakes.title, "Lakes of the world");
  EXPECT_EQ(lakes.attribution, "OSM");
  EXPECT_EQ(lakes.description, "blue");
  EXPECT_EQ(lakes.min_zoom, 2);
  EXPECT_EQ(lakes.max_zoom, 9);
  EXPECT_EQ(lakes.style.canonical_text(), "fill=008080ff&fill-opacity=0.25");
  EXPECT_EQ(config.layers[1].file, "/data/land.fgb");
  EXPECT_EQ(config.layers[1].title, "land");
  EXPECT_TRUE(config.layers[1].style.settings().empty());
}

TEST_F(ConfigTest, AnEmptyFileIsTheDefaults) {
  const Config config = read("");
  EXPECT_EQ(config.server.port, 8080);
  EXPECT_TRUE(config.layers.empty());
}

struct BadConfig {
  const char* text;
  const char* position;  // line:column
  const char* says;
};

TEST_F(ConfigTest, ErrorsSayWhereWhatAndWhatIsAllowed) {
  const BadConfig bad[] = {
      {"[server]\nprot = 1", ":2:1: ", "unknown key server.prot; allowed here are address, port"},
      {"sevrer = 1", ":1:1: ", "unknown key sevrer; allowed here are server, styles, layer"},
      {"[server]\nport = 70000", ":2:8: ", "server.port takes an integer from 0 to 65535"},
      {"[server]\nport = -1", ":2:8: ", "server.port takes an integer"},
      {"[server]\nport = \"80\"", ":2:8: ", "server.port takes an integer"},
      {"[server]\nport = 80.5", ":2:8: ", "server.port takes an integer"},
      {"[server]\nqueue = 0", ":2:9: ", "server.queue takes an integer from 1"},
      {"[server]\naddress = 1", ":2:11: ", "server.address takes a string"},
      {"[server]\nrenderer = \"vulkan\"", ":2:12: ", "\"osmesa\" or \"software\""},
      {"[server]\npublic_url = \"maps\"", ":2:14: ", "http://"},
      {"[server]\nallowed_hosts = \"a\"", ":2:17: ", "takes a list of strings"},
      {"[server]\nallowed_hosts = [1]", ":2:18: ", "takes a list of strings"},
      {"[server]\nallowed_hosts = [\"a/b\"]", ":2:17: ", "\"a/b\" is none"},
      {"server = 1", ":1:10: ", "server takes a table"},
      {"layer = 1", ":1:9: ", "[[layer]]"},
      {"layer = [1]", ":1:9: ", "[[layer]]"},
      {"[layer]\nname = \"a\"", ":1:1: ", "[[layer]]"},
      {"[[layer]]\nfile = \"a\"", ":1:1: ", "needs a name"},
      {"[[layer]]\nname = \"a b\"\nfile = \"a\"", ":2:8: ", "64 letters"},
      {"[[layer]]\nname = \"a\"", ":1:1: ", "layer \"a\" needs a file"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\n[[layer]]\nname = \"a\"\nfile = \"b\"",
       ":4:1: ", "layer \"a\" is defined twice, first in line 1"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nmin_zoom = 25", ":4:12: ", "from 0 to 24"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nmin_zoom = 5\nmax_zoom = 4", ":1:1: ", "min_zoom"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nstyle = { fill = \"no\" }", ":4:18: ", "a colour"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nstyle = { fill_opacity = 2 }",
       ":4:26: ", "a number from 0 to 1"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nstyle = { fil = \"red\" }",
       ":4:11: ", "a style does not know \"fil\""},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nlocked = [\"fil\"]",
       ":4:10: ", "\"fil\" is none; known are breaks, classes"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nlocked = [\"background\"]",
       ":4:10: ", "\"background\" is none"},
      {"[server\n", ":1:", ""},
  };
  for (const BadConfig& config : bad) {
    const std::string error = error_of(config.text);
    EXPECT_THAT(error, HasSubstr(path_ + config.position)) << config.text;
    EXPECT_THAT(error, HasSubstr(config.says)) << config.text;
  }
}

TEST_F(ConfigTest, AMissingFileIsAnErrorThatNamesIt) {
  try {
    read_config("/nosuch/trapeze.toml");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nosuch/trapeze.toml"));
  }
}

TEST(LayersOfFilesTest, NamesLayersAfterTheirFiles) {
  const auto layers = layers_of_files(
      {"/data/lakes.fgb", "old town (2).geojson", "shapes/", "b\xc3\xa4ume.shp", ".fgb"});
  ASSERT_EQ(layers.size(), 5u);
  EXPECT_EQ(layers[0].name, "lakes");
  EXPECT_EQ(layers[0].file, "/data/lakes.fgb");
  EXPECT_EQ(layers[1].name, "old_town__2_");
  EXPECT_EQ(layers[2].name, "shapes");
  EXPECT_EQ(layers[3].name, "b__ume");
  EXPECT_EQ(layers[4].name, "_fgb");
}

TEST(LayersOfFilesTest, RefusesTwoFilesOfOneName) {
  try {
    layers_of_files({"a/lakes.fgb", "b/lakes.shp"});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("a/lakes.fgb"));
    EXPECT_THAT(error.what(), HasSubstr("b/lakes.shp"));
  }
}

}  // namespace
}  // namespace trapeze
