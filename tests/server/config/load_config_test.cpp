#include "server/config/load_config.h"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "server/config/config_print.h"
#include "server/config/config_settings.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
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
    coverage = "on"
    close_gaps = 2.5
    merge = 4
    merge_by = "type"
    [[layer]]
    name = "c"
    prepared = "c.trapeze")");
  ASSERT_EQ(config.layers.size(), 3u);
  EXPECT_THAT(config.layers[0].file_to_open(), ::testing::EndsWith("/a.fgb"));
  EXPECT_EQ(config.layers[0].weights, std::nullopt);
  EXPECT_THAT(config.layers[1].file_to_open(), ::testing::EndsWith("/out/b.trapeze"));
  EXPECT_THAT(config.layers[1].file, ::testing::EndsWith("/b.fgb"));
  EXPECT_EQ(config.layers[1].weights, WeightRule::raised_parents);
  EXPECT_EQ(config.layers[0].coverage, std::nullopt);
  EXPECT_EQ(config.layers[1].coverage, CoverageMode::on);
  EXPECT_EQ(config.layers[0].close_gaps, std::nullopt);
  EXPECT_EQ(config.layers[1].close_gaps, 2.5);
  EXPECT_EQ(config.layers[0].merge, std::nullopt);
  EXPECT_EQ(config.layers[1].merge, 4);
  EXPECT_EQ(config.layers[0].merge_by, "");
  EXPECT_EQ(config.layers[1].merge_by, "type");
  EXPECT_EQ(config.layers[2].file, "");
  EXPECT_THAT(config.layers[2].file_to_open(), ::testing::EndsWith("/c.trapeze"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\""), HasSubstr("needs a file"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nfile = \"d.fgb\"\nweights = \"none\""),
              HasSubstr("effective-area"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nfile = \"d.fgb\"\ncoverage = \"yes\""),
              HasSubstr("\"auto\", \"on\" or \"off\""));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nfile = \"d.fgb\"\nclose_gaps = -1"),
              HasSubstr("a number from 0 to 1000"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nfile = \"d.fgb\"\nmerge = 65"),
              HasSubstr("a number from 0 to 64"));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nfile = \"d.fgb\"\nmerge_by = \"type\""),
              HasSubstr("merge_by needs merge"));
}

TEST_F(ConfigTest, ALayerMaySelectFromItsSource) {
  const Config config = read(R"(
    [[layer]]
    name = "a"
    file = "PG:dbname=maps password=secret"
    source_layer = "city.houses"
    where = "floors > 2"
    attributes = ["floors"]
    [[layer]]
    name = "b"
    file = "b.fgb"
    attributes = [])");
  const SourceSelection& selection = config.layers[0].selection;
  EXPECT_EQ(selection.layer, "city.houses");
  EXPECT_EQ(selection.where, "floors > 2");
  EXPECT_THAT(selection.attributes, ::testing::Optional(::testing::ElementsAre("floors")));
  EXPECT_THAT(config.layers[1].selection.attributes, ::testing::Optional(::testing::IsEmpty()));
  EXPECT_THAT(error_of("[[layer]]\nname = \"d\"\nprepared = \"d.trapeze\"\nwhere = \"a = 1\""),
              HasSubstr("is prepared: select from its source"));
}

TEST_F(ConfigTest, OnlyATableThatCanBeReadInPartsIsLive) {
  const std::string query = "live_query = \"SELECT n, id FROM c WHERE n > {since}\"\n";
  const std::string layer = "[[layer]]\nname = \"d\"\n" + query;
  const std::string table = "file = \"d.gpkg\"\nsource_layer = \"houses\"\n";
  EXPECT_EQ(read(layer + table).layers[0].live_query, "SELECT n, id FROM c WHERE n > {since}");
  EXPECT_THAT(error_of(layer + "file = \"d.gpkg\""), HasSubstr("needs a source_layer"));
  EXPECT_THAT(error_of(layer + "prepared = \"d.trapeze\""), HasSubstr("it is prepared"));
  EXPECT_THAT(error_of(layer + table + "[layer.style]\ntopology = \"fast\""),
              HasSubstr("without the topology test"));
}

TEST_F(ConfigTest, ALimitOfSkippedFeaturesIsANumberOrAShare) {
  const Config config = read(R"(
    [[layer]]
    name = "a"
    file = "a.fgb"
    max_skipped = 3
    may_shrink = true
    [[layer]]
    name = "b"
    file = "b.fgb"
    max_skipped = "0.5%"
    [[layer]]
    name = "c"
    file = "c.fgb")");
  EXPECT_EQ(config.layers[0].max_skipped, SkipLimit::parse("3"));
  EXPECT_TRUE(config.layers[0].may_shrink);
  EXPECT_EQ(config.layers[1].max_skipped, SkipLimit::parse("0.5%"));
  EXPECT_FALSE(config.layers[1].may_shrink);
  EXPECT_EQ(config.layers[2].max_skipped, SkipLimit());
}

TEST_F(ConfigTest, PrintsNoPassword) {
  std::ofstream(path_) << "[[layer]]\nname = \"a\"\nfile = \"PG:dbname=maps password=secret\"\n";
  const std::string printed = print_config(load_config(path_, {}));
  EXPECT_THAT(printed, HasSubstr("file = \"PG:dbname=maps password=***\""));
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
    [viewer]
    title = "Atlas"
    start = "#map=3/1/2"

    [text]
    fonts = ["fonts/a.ttf", "/usr/share/fonts/b.ttc#2"]

    [[layer]]
    name = "lakes"
    file = "water.fgb"
    title = "Lakes of the world"
    attribution = "OSM"
    description = "blue"
    min_zoom = 2
    max_zoom = 9
    detail_zoom = 12
    group = "World"
    title_attribute = "label"
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
  EXPECT_EQ(config.text.fonts,
            (std::vector<std::string>{(folder / "fonts/a.ttf").lexically_normal().string(),
                                      "/usr/share/fonts/b.ttc#2"}));
  EXPECT_EQ(config.viewer.title, "Atlas");
  EXPECT_EQ(config.viewer.start, "map=3/1/2");
  ASSERT_EQ(config.layers.size(), 2u);
  const LayerConfig& lakes = config.layers[0];
  EXPECT_EQ(lakes.detail_zoom, 12);
  EXPECT_EQ(lakes.group, "World");
  EXPECT_EQ(lakes.title_attribute, "label");
  EXPECT_EQ(config.layers[1].detail_zoom, std::nullopt);
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
      {"[server]\nprot = 1", ":2:1: ", "did you mean port?"},
      {"sevrer = 1", ":1:1: ", "did you mean server?"},
      {"sevrer = 1", ":1:1: ",
       "unknown key sevrer; allowed here are server, viewer, limits, text, log, admin, changes, "
       "styles, fonts, values, layer"},
      {"change = 1", ":1:1: ", "did you mean changes?"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nstyle.background = \"red\"",
       ":4:7: ", "\"background\" is for all layers"},
      {"[values.a]\nkey = \"k\"", ":1:1: ", "values \"a\" need a file"},
      {"[values.a]\nfile = \"a\"\ncolumn = 1", ":3:1: ", "unknown key values.a.column"},
      {"[values]\na = 1", ":2:5: ", "[values.NAME]"},
      {"[server]\nport = 70000", ":2:8: ", "server.port takes an integer from 0 to 65535"},
      {"[server]\nport = -1", ":2:8: ", "server.port takes an integer"},
      {"[server]\nport = \"80\"", ":2:8: ", "server.port takes an integer"},
      {"[server]\nport = 80.5", ":2:8: ", "server.port takes an integer"},
      {"[server]\nqueue = 0", ":2:9: ", "server.queue takes an integer from 1"},
      {"[server]\naddress = 1", ":2:11: ", "server.address takes an IPv4 or IPv6 address"},
      {"[server]\naddress = \"localhost\"", ":2:11: ", "server.address takes an IPv4"},
      {"[server]\ndevice = 1", ":2:10: ", "server.device takes a string"},
      {"[server]\nmetrics = 1", ":2:11: ", "server.metrics takes true or false"},
      {"[text]\nfonts = [\"a.ttf\", \"\"]", ":2:19: ", "text.fonts takes a list of font files"},
      {"[server]\ntrusted_proxies = [\"10.0.0.0/8\", \"10.0.0.0/33\"]", ":2:34: ", "ranges"},
      {"[limits]\ndrawn_burst = 0.5", ":2:15: ", "a number from 1 to"},
      {"[limits]\ndrawn_burst = nan", ":2:15: ", "a number from 1 to"},
      {"[limits]\nscale = 5", ":2:9: ", "an integer from 1 to 4"},
      {"[log]\nlevel = \"loud\"", ":2:9: ", "\"trace\", \"debug\""},
      {"[log]\naccess_format = \"xml\"", ":2:17: ", "\"text\" or \"json\""},
      {"[admin]\nport = \"${NOSUCH_VARIABLE}\"", ":2:8: ", "takes an integer"},
      {"[server]\ndevice = \"${NOSUCH_VARIABLE}\"", ":2:10: ", "NOSUCH_VARIABLE is not set"},
      {"[server]\nrenderer = \"vulkan\"", ":2:12: ", "\"osmesa\" or \"software\""},
      {"[server]\npublic_url = \"maps\"", ":2:14: ", "http://"},
      {"[server]\npublic_url = \"http://a\\r\\nb\"", ":2:14: ", "http://"},
      {"[server]\nallowed_hosts = \"a\"", ":2:17: ", "takes a list of host names"},
      {"[server]\nallowed_hosts = [1]", ":2:17: ", "takes a list of host names"},
      {"[server]\nallowed_hosts = [\"a\", \"a/b\"]", ":2:23: ", "host names"},
      {"server = 1", ":1:10: ", "server takes a table"},
      {"layer = 1", ":1:9: ", "[[layer]]"},
      {"layer = [1]", ":1:10: ", "[[layer]]"},
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
       ":4:11: ", "takes a list of style parameters of layers: breaks, classes"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nlocked = [\"background\"]",
       ":4:11: ", "takes a list of style parameters"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nmax_skipped = -1",
       ":4:15: ", "layer.max_skipped takes a number of features, or a share of them"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nmax_skipped = \"101%\"", ":4:15: ", "a share"},
      {"[[layer]]\nname = \"a\"\nfile = \"a\"\nmax_skipped = 0.5", ":4:15: ", "a share"},
      {"[styles.a]\n\"b c\" = { fill = \"red\" }", ":2:1: ", "\"b c\" cannot name a layer"},
      {"[styles.a]\n\"\" = { fill = \"red\" }", ":2:1: ", "\"\" cannot name a layer"},
      {"[server\n", ":1:", ""},
  };
  for (const BadConfig& config : bad) {
    const std::string error = error_of(config.text);
    EXPECT_THAT(error, HasSubstr(path_ + config.position)) << config.text;
    EXPECT_THAT(error, HasSubstr(config.says)) << config.text;
  }
}

TEST_F(ConfigTest, TellsAllThatIsWrongInTheOrderOfTheFile) {
  std::ofstream(path_) << "[server]\nport = 70000\nprot = 1\nqueue = 5\nbatch = 0\n"
                          "[limits]\nscale = \"2\"\n"
                          "[[layer]]\nname = \"a b\"\nmin_zoom = -1\nstyle = { fill = \"no\" }\n"
                          "[[layer]]\nname = \"b\"\nfile = \"b.fgb\"\n";
  const LoadedConfig loaded = load_config(path_, {});
  std::vector<std::string> where;
  for (const ConfigProblem& problem : loaded.problems) where.push_back(problem.where);
  EXPECT_THAT(where,
              ::testing::ElementsAre(path_ + ":2:8", path_ + ":3:1", path_ + ":5:9", path_ + ":7:9",
                                     path_ + ":9:8", path_ + ":10:12", path_ + ":11:18"));
  EXPECT_EQ(loaded.config.server.queue, 5u) << "what is right is read";
  EXPECT_EQ(loaded.config.server.port, 8080) << "what is wrong is the default";
  EXPECT_EQ(loaded.config.layers.size(), 2u);
}

TEST_F(ConfigTest, EnvironmentGoesBeforeTheFileAndTheCommandLineBeforeBoth) {
  std::ofstream(path_) << "[server]\nport = 1\nqueue = 2\nbatch = 3\n"
                          "[[layer]]\nname = \"a\"\nfile = \"a.fgb\"\ntitle = \"A\"\n";
  const char* const environment[] = {"PATH=/bin",
                                     "TRAPEZE_SERVER_QUEUE=20",
                                     "TRAPEZE_SERVER_BATCH=30",
                                     "TRAPEZE_SERVER_TRUSTED_PROXIES=10.0.0.0/8,::1",
                                     "TRAPEZE_SERVER_METRICS=false",
                                     "TRAPEZE_LIMITS_DRAWN_PER_SECOND=2.5",
                                     "TRAPEZE_DATA=/data",
                                     "TRAPEZE_SERVER_PORT_8080_TCP=x",
                                     nullptr};
  auto overrides = environment_overrides(environment);
  EXPECT_EQ(overrides.size(), 5u) << "variables of others are left alone";
  overrides.push_back({"server.batch", "33", "--batch"});
  const LoadedConfig loaded = load_config(path_, overrides);
  EXPECT_EQ(problems_text(loaded.problems), "");
  EXPECT_EQ(loaded.config.server.port, 1);
  EXPECT_EQ(loaded.config.server.queue, 20u);
  EXPECT_EQ(loaded.config.server.batch, 33u);
  EXPECT_EQ(loaded.config.server.trusted_proxies.size(), 2u);
  EXPECT_FALSE(loaded.config.server.metrics);
  EXPECT_EQ(loaded.config.limits.drawn_per_second, 2.5);
  EXPECT_EQ(loaded.origins.at("server.port"), path_ + ":2:8");
  EXPECT_EQ(loaded.origins.at("server.queue"), "TRAPEZE_SERVER_QUEUE");
  EXPECT_EQ(loaded.origins.at("server.batch"), "--batch");
  EXPECT_EQ(loaded.origins.at("layer.a.title"), path_ + ":8:9");
  EXPECT_FALSE(loaded.origins.contains("server.deadline_ms"));
}

TEST_F(ConfigTest, AMistypedVariableIsAnErrorWithTheNearestSetting) {
  const char* const environment[] = {"TRAPEZE_SERVER_PROT=80",
                                     "TRAPEZE_LIMITS_=1",
                                     "TRAPEZE_SERVER_SERVICE_HOST=10.0.0.1",
                                     "TRAPEZE_SERVER_PORT=tcp://10.0.0.1:80",
                                     "TRAPEZE_LOG_PORT_80_TCP_ADDR=10.0.0.1",
                                     "TRAPEZE_DATA=/data",
                                     nullptr};
  const LoadedConfig loaded = load_config("", environment_overrides(environment));
  ASSERT_EQ(loaded.problems.size(), 2u) << problems_text(loaded.problems);
  EXPECT_EQ(problems_text(loaded.problems).substr(0, 20), "TRAPEZE_SERVER_PROT:");
  EXPECT_THAT(loaded.problems[0].what, HasSubstr("did you mean TRAPEZE_SERVER_PORT?"));
  EXPECT_EQ(loaded.problems[1].where, "TRAPEZE_LIMITS_");
}

TEST_F(ConfigTest, WrongOverridesAreErrorsThatNameThem) {
  const LoadedConfig loaded =
      load_config("", {{"server.port", "http", "--port"},
                       {"server.metrics", "yes", "TRAPEZE_SERVER_METRICS"},
                       {"server.port", "80 ", "--port"},
                       {"limits.drawn_burst", "inf", "TRAPEZE_LIMITS_DRAWN_BURST"},
                       {"server.allowed_hosts", "a,b/c", "TRAPEZE_SERVER_ALLOWED_HOSTS"}});
  EXPECT_THAT(problems_text(loaded.problems),
              AllOf(HasSubstr("--port: takes an integer from 0 to 65535\nTRAPEZE_SERVER_METRICS"),
                    HasSubstr("takes true or false\n--port"), HasSubstr("a number from 1"),
                    HasSubstr("with commas between them")));
  EXPECT_EQ(loaded.problems.size(), 5u);
}

TEST_F(ConfigTest, OriginsAreThoseOfTheValuesInUse) {
  setenv("TRAPEZE_TEST_NAME", "a", 1);
  std::ofstream(path_) << "text.fonts = [\"a.ttf\"]\n[[layer]]\nname = \"${TRAPEZE_TEST_NAME}\"\n"
                       << "file = \"a.fgb\"\n";
  const LoadedConfig loaded = load_config(path_, {{"text.fonts", "b.ttf", "TRAPEZE_TEXT_FONTS"}});
  unsetenv("TRAPEZE_TEST_NAME");
  EXPECT_EQ(loaded.origin_of("layer.a.file"), path_ + ":4:8");
  EXPECT_EQ(loaded.origin_of("text.fonts", 0), "TRAPEZE_TEXT_FONTS");
}

TEST_F(ConfigTest, StringsMayHoldVariables) {
  setenv("TRAPEZE_TEST_FOLDER", "/maps", 1);
  const Config config = read(R"(
    [server]
    device = "$${x}"
    [[layer]]
    name = "a"
    file = "${TRAPEZE_TEST_FOLDER}/a.fgb"
    title = "${NOSUCH_VARIABLE:-Untitled}")");
  unsetenv("TRAPEZE_TEST_FOLDER");
  EXPECT_EQ(config.server.renderer.device, "${x}");
  EXPECT_EQ(config.layers[0].file, "/maps/a.fgb");
  EXPECT_EQ(config.layers[0].title, "Untitled");
}

TEST_F(ConfigTest, SourcesThatAreNoFilesKeepTheirNames) {
  const Config config = read(R"(
    [[layer]]
    name = "a"
    file = "PG:dbname=maps tables=/a"
    [[layer]]
    name = "b"
    file = "/vsizip/b.zip/b.shp"
    [[layer]]
    name = "c"
    file = "sub/c:d.fgb")");
  EXPECT_EQ(config.layers[0].file, "PG:dbname=maps tables=/a");
  EXPECT_EQ(config.layers[1].file, "/vsizip/b.zip/b.shp");
  EXPECT_THAT(config.layers[2].file, ::testing::EndsWith("/sub/c:d.fgb"));
  EXPECT_NE(config.layers[2].file, "sub/c:d.fgb");
}

TEST_F(ConfigTest, WhatIsPrintedReadsBackAsTheSame) {
  std::ofstream(path_)
      << "[server]\nqueue = 9\ncache_control = \"no-store, \\\"x\\\"\"\n"
         "allowed_hosts = [\"a.example\", \"*.b.example\"]\n"
         "trusted_proxies = [\"10.0.0.0/8\"]\n[log]\naccess = \"stdout\"\n"
         "[[layer]]\nname = \"a\"\nfile = \"/a.fgb\"\ntitle = \"5 $${a} \\n \\u00e4\"\n"
         "weights = \"effective-area\"\nstyle = { fill = \"#12345678\" }\n"
         "[styles.night]\nbackground = \"black\"\na = { fill_opacity = 0.5 }\n";
  const LoadedConfig loaded = load_config(path_, {{"server.port", "81", "--port"}});
  ASSERT_EQ(problems_text(loaded.problems), "");
  const std::string printed = print_config(loaded);
  EXPECT_THAT(printed, ::testing::ContainsRegex("port = 81 +# --port"));
  EXPECT_THAT(printed, ::testing::ContainsRegex("queue = 9 +# [^ ]+:2:9\n"));
  EXPECT_THAT(printed, ::testing::ContainsRegex("batch = 8 +# default\n"));
  EXPECT_THAT(printed, HasSubstr("access = \"stdout\""));
  std::ofstream(path_) << printed;
  LoadedConfig again = load_config(path_, {});
  ASSERT_EQ(problems_text(again.problems), "") << printed;
  EXPECT_EQ(again.config.layers[0].title, "5 ${a} \n \u00e4");
  EXPECT_EQ(again.config.layers[0].style.canonical_text(), "fill=12345678");
  EXPECT_EQ(again.config.styles.at("night").canonical_text(),
            loaded.config.styles.at("night").canonical_text());
  again.origins = loaded.origins;
  EXPECT_EQ(print_config(again), printed);
}

TEST_F(ConfigTest, AnEmptyTitleIsNone) {
  EXPECT_EQ(read("[[layer]]\nname = \"a\"\nfile = \"a.fgb\"\ntitle = \"\"").layers[0].title, "a");
}

TEST_F(ConfigTest, ATextIsReadAsTheFileOfThatTextWouldBe) {
  const std::string text =
      "[server]\nport = 81\nqueue = 0\n[[layer]]\nname = \"a\"\nfile = \"a.fgb\"";
  std::ofstream(path_) << text;
  const LoadedConfig file = load_config(path_, {});
  const LoadedConfig loaded = load_config_text(text, path_);
  EXPECT_THAT(problems_text(loaded.problems), HasSubstr(path_ + ":3:9: server.queue"));
  EXPECT_EQ(problems_text(loaded.problems), problems_text(file.problems));
  EXPECT_EQ(print_config(loaded), print_config(file));
}

TEST_F(ConfigTest, AMissingFileIsAnErrorThatNamesIt) {
  try {
    read_config("/nosuch/trapeze.toml");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nosuch/trapeze.toml"));
  }
}

TEST(ConfigFolderTest, AFolderIsNotReadAsAnEmptyConfiguration) {
  const LoadedConfig loaded = load_config(::testing::TempDir(), {});
  EXPECT_THAT(problems_text(loaded.problems), HasSubstr("it is a folder"));
}

std::string example_text() {
  std::ifstream file(TRAPEZE_CONFIG_FOLDER "/example.toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Settings for which "not set" differs from every value; the example only shows them in comments.
bool is_comment_in_example(const std::string& key) {
  return key == "prepared" || key == "source_layer" || key == "where" || key == "attributes" ||
         key == "live_query" || key == "detail_zoom" || key == "group" ||
         key == "title_attribute" || key == "merge_by";
}

TEST(ConfigExampleTest, NamesEverySettingWithItsDefault) {
  const LoadedConfig example = load_config(TRAPEZE_CONFIG_FOLDER "/example.toml", {});
  ASSERT_EQ(problems_text(example.problems), "");
  for (const auto& setting : config_settings()) {
    EXPECT_TRUE(example.origins.contains(setting.name())) << setting.name();
    EXPECT_TRUE(setting.get(example.config) == setting.get(Config())) << setting.name();
  }
  ASSERT_EQ(example.config.layers.size(), 2u);
  for (const auto& setting : layer_settings()) {
    EXPECT_THAT(example_text(), HasSubstr(setting.key + " = "));
    if (is_comment_in_example(setting.key)) continue;
    EXPECT_TRUE(example.origins.contains("layer.buildings." + setting.key)) << setting.key;
  }
  EXPECT_EQ(example.config.layers[0].file, "/maps/buildings.gpkg");
}

TEST(ConfigSchemaTest, IsTheOneThatTheProgramPrints) {
  std::ifstream file(TRAPEZE_CONFIG_FOLDER "/trapeze.schema.json");
  const std::string schema{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(schema == config_schema())
      << "make it anew: trapeze config schema > config/trapeze.schema.json";
}

TEST(LayersOfFilesTest, NamesLayersAfterTheirFiles) {
  const auto layers = layers_of_files(
      {"/data/lakes.fgb", "old town (2).geojson", "shapes/", "b\xc3\xa4ume.shp", ".fgb"});
  ASSERT_EQ(layers.size(), 5u);
  EXPECT_EQ(layers[0].name, "lakes");
  EXPECT_EQ(layers[0].file, "/data/lakes.fgb");
  EXPECT_EQ(layers[1].name, "old_town__2_");
  EXPECT_EQ(layers[1].title, "old town (2)");
  EXPECT_EQ(layers[2].name, "shapes");
  EXPECT_EQ(layers[3].name, "b__ume");
  EXPECT_EQ(layers[3].title, "b\xc3\xa4ume");
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
