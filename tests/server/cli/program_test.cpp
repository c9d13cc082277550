// Tests the program from the outside: starts it, sends requests, and ends it with signals.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <spdlog/fmt/fmt.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "render/picture/png.h"
#include "server/config/config.h"
#include "server/http/viewer_files.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/sanitized.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::EndsWith;
using testing::fixture;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RawClient;
using ::testing::StartsWith;

/// In a folder of this process: the tests of several builds may run at the same time.
std::string scratch_path(const std::string& name) {
  static const TemporaryFolder folder;
  return folder.file(std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
                     "_" + name);
}

/// A run of the program with its output redirected to a file of its own. Killed if it is still
/// running when the test ends.
class Program {
 public:
  explicit Program(std::vector<std::string> arguments)
      : output_(scratch_path("output_" + std::to_string(++runs_) + ".txt")) {
    arguments.insert(arguments.begin(), TRAPEZE_PROGRAM);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const int output = open(output_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(output, STDOUT_FILENO);
      dup2(output, STDERR_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(output);
  }

  ~Program() {
    if (!status_) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::filesystem::remove(output_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  std::string output() const { return read_file(output_); }

  void send_signal(int signal) const { kill(pid_, signal); }

  /// The exit status, or the number of the signal that killed it, negative; empty if the program
  /// does not exit within 20 seconds.
  std::optional<int> wait() {
    for (int i = 0; i < 2000 && !status_; ++i) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      } else {
        std::this_thread::sleep_for(10ms);
      }
    }
    return status_;
  }

  /// The port, once the program listens.
  std::uint16_t port() const {
    const std::regex listening("listening on [0-9.]+ port ([0-9]+)");
    for (int i = 0; i < 2000; ++i) {
      const std::string text = output();
      std::smatch match;
      if (std::regex_search(text, match, listening)) {
        return static_cast<std::uint16_t>(std::stoi(match[1]));
      }
      std::this_thread::sleep_for(10ms);
    }
    throw std::runtime_error("it does not listen: " + output());
  }

 private:
  static inline int runs_ = 0;
  const std::string output_;
  pid_t pid_ = 0;
  std::optional<int> status_;
};

std::vector<std::string> serve_arguments(const std::vector<std::string>& files) {
  std::vector<std::string> arguments = {"serve",     "--port",     "0",       "--address",
                                        "127.0.0.1", "--renderer", "software"};
  arguments.insert(arguments.end(), files.begin(), files.end());
  return arguments;
}

void wait_until_ready(std::uint16_t port) {
  for (int i = 0; i < 1000; ++i) {
    if (RawClient(port).get("/ready").status == 200) return;
    std::this_thread::sleep_for(10ms);
  }
  FAIL() << "never ready";
}

double metric(std::uint16_t port, const std::string& name) {
  const std::string text = "\n" + RawClient(port).get("/metrics").body;
  const std::size_t begin = text.find("\n" + name + " ");
  return begin == std::string::npos ? 0 : std::stod(text.substr(begin + name.size() + 2));
}

/// A round island with `vertices` vertices.
void write_island(const std::string& path, int vertices) {
  std::ofstream file(path);
  file << R"({"type": "Polygon", "coordinates": [[)";
  for (int i = 0; i <= vertices; ++i) {
    const double angle = 2 * std::numbers::pi * (i % vertices) / vertices;
    const double radius = 20 + i % vertices * 7919 % 1000 * 1e-6;
    file << fmt::format("{}[{:.6f},{:.6f}]", i == 0 ? "" : ",", radius * std::cos(angle),
                        radius * std::sin(angle));
  }
  file << "]]}";
}

/// A polygon whose graph takes seconds to build, in a folder of its own.
std::string write_large_polygon(const std::string& folder, int teeth) {
  std::filesystem::create_directories(folder);
  const std::string path = folder + "/comb.geojson";
  std::ofstream file(path);
  file << R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},)"
       << R"("geometry":{"type":"Polygon","coordinates":[[[0,-1])";
  for (int i = 0; i <= teeth; ++i) {
    file << ",[" << i * 1e-4 << "," << (i % 2 == 0 ? 0 : (i * 7919 % 1000) * 1e-3) << "]";
  }
  file << ",[" << teeth * 1e-4 << ",-1],[0,-1]]]}}]}";
  return path;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

TEST(ProgramTest, InterruptedCommandsLeaveNothingBehind) {
  const std::string folder = scratch_path("interrupted");
  const std::string source = write_large_polygon(folder, 400'000);
  for (const std::string output : {"out.gpkg", "out.fgb", "out.geojson"}) {
    for (const int signal : {SIGINT, SIGTERM}) {
      Program program({"export", source, "--zoom", "20", "--output", folder + "/" + output});
      for (int i = 0; i < 1000 && names_in(folder).size() < 2; ++i) {
        std::this_thread::sleep_for(10ms);
      }
      EXPECT_EQ(names_in(folder).size(), 2u) << "it writes beside the output";
      program.send_signal(signal);
      EXPECT_EQ(program.wait(), 128 + signal);
      EXPECT_THAT(program.output(), HasSubstr("trapeze: interrupted\n"));
      EXPECT_THAT(names_in(folder), ::testing::ElementsAre("comb.geojson"));
    }
  }
  // Its file is written within moments after seconds of building, so it may be done first.
  write_large_polygon(folder, 200'000);
  Program program({"prepare", source, "--output", folder});
  for (int i = 0; i < 3000 && names_in(folder).size() < 2; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(names_in(folder).size(), 2u) << "it writes beside the output";
  program.send_signal(SIGTERM);
  EXPECT_THAT(program.wait().value_or(-1), ::testing::AnyOf(128 + SIGTERM, 0));
  EXPECT_THAT(names_in(folder), ::testing::Each(Not(HasSubstr(".tmp."))));
  std::filesystem::remove_all(folder);
}

TEST(ProgramTest, SeedsAnArchiveThatNoOtherProcessSeedsMeanwhile) {
  const std::string folder = scratch_path("seeded");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  const std::vector<std::string> arguments = {
      "seed",     fixture("rings.geojson"), "--renderer", "software", "--zooms", "0-9",
      "--output", folder + "/rings.mbtiles"};
  Program first(arguments);
  const auto is_being_put_together = [&folder] {
    return std::ranges::any_of(names_in(folder), [](const std::string& name) {
      return name.find(".tmp.") != std::string::npos;
    });
  };
  for (int i = 0; i < 20'000 && !is_being_put_together(); ++i) std::this_thread::sleep_for(1ms);
  Program second(arguments);
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.output(), HasSubstr("another process is writing it"));
  EXPECT_EQ(first.wait(), 0) << first.output();
  EXPECT_THAT(names_in(folder), ::testing::ElementsAre("rings.mbtiles"));
  std::filesystem::remove_all(folder);
}

TEST(ProgramTest, ServesFilesAndEndsInOrderOnSigterm) {
  Program program(serve_arguments({fixture("rings.geojson"), fixture("west.geojson")}));
  const std::uint16_t port = program.port();
  wait_until_ready(port);
  RawClient client(port);
  EXPECT_EQ(client.get("/tiles/rings,west/0/0/0.png").status, 200);
  RawClient half(port);
  half.send("GET /tiles/rings/1/0/0@4x.png HTTP/1.1\r\n");
  std::this_thread::sleep_for(100ms);
  program.send_signal(SIGTERM);
  EXPECT_TRUE(client.is_closed_within(5s));
  half.send("Host: a\r\n\r\n");
  EXPECT_EQ(half.receive().status, 200) << "what was asked before the signal is answered";
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(
      program.output(),
      AllOf(HasSubstr("rendering with software"), HasSubstr("rings.geojson: 1 of 1 features"),
            HasSubstr("ready: 2 layers"), HasSubstr("SIGTERM"), HasSubstr("stopped")));
}

TEST(ProgramTest, KeepsTheMemoryOfLayersAndNotThatOfBuildingThem) {
  if (testing::kIsSanitized) GTEST_SKIP() << "sanitizers have allocators of their own";
  const char* const kResident = "process_resident_memory_bytes";
  double without = 0;
  {
    const Program server(serve_arguments({fixture("rings.geojson")}));
    wait_until_ready(server.port());
    without = metric(server.port(), kResident);
  }
  const std::string map = scratch_path("island.geojson");
  write_island(map, 150'000);
  const Program server(serve_arguments({map}));
  wait_until_ready(server.port());
  std::filesystem::remove(map);
  const double layer =
      metric(server.port(),
             "trapeze_layer_bytes{layer=\"" + std::filesystem::path(map).stem().string() + "\"}");
  EXPECT_GT(layer, 10e6);
  double with = 0;
  // The server is ready a little before it has released all memory.
  for (int i = 0; i < 1000; ++i) {
    with = metric(server.port(), kResident);
    if (with - without < 1.2 * layer + 10e6) break;
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_LT(with - without, 1.2 * layer + 10e6);
  EXPECT_GT(metric(server.port(), "process_resident_memory_peak_bytes"), with);
}

TEST(ProgramTest, TellsTheAddressToOpenInTheLineAfterReady) {
  Program program(serve_arguments({fixture("rings.geojson")}));
  const std::string root = "http://localhost:" + std::to_string(program.port()) + "/";
  const std::string address =
      viewer_files().empty() ? "the layers are at " + root + "catalog\n" : "open " + root + "\n";
  for (int i = 0; i < 2000 && program.output().find(address) == std::string::npos; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  const std::string said = program.output();
  EXPECT_THAT(said, EndsWith(address));
  EXPECT_THAT(said, ::testing::ContainsRegex("ready: 1 layers[^\n]*\n[^\n]*" + root));
}

TEST(ProgramTest, ServesItsOwnViewerOverDataOfOnesOwn) {
  if (viewer_files().empty()) GTEST_SKIP() << "built without the viewer";
  Program program(serve_arguments({fixture("rings.geojson")}));
  testing::RawClient client(program.port());
  const auto page = client.get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("<html"));
  const auto script = client.get("/viewer.js");
  EXPECT_EQ(script.status, 200);
  EXPECT_EQ(script.headers.at("content-type"), "text/javascript; charset=utf-8");
}

TEST(ProgramTest, EndsInOrderOnSigint) {
  Program program(serve_arguments({fixture("rings.geojson")}));
  program.port();
  program.send_signal(SIGINT);
  EXPECT_EQ(program.wait(), 0);
}

TEST(ProgramTest, ServesAConfiguration) {
  const std::string path = scratch_path("trapeze.toml");
  std::ofstream(path) << "[server]\nport = 1\naddress = \"127.0.0.1\"\nrenderer = \"software\"\n"
                      << "[[layer]]\nname = \"shapes\"\nfile = \"" << fixture("rings.geojson")
                      << "\"\nstyle = { fill = \"teal\" }\n";
  Program program({"serve", "--config", path, "--port", "0"});
  const std::uint16_t port = program.port();
  wait_until_ready(port);
  EXPECT_EQ(RawClient(port).get("/tiles/shapes/0/0/0.png").status, 200);
  EXPECT_EQ(RawClient(port).get("/tiles/rings/0/0/0.png").status, 404);
  std::filesystem::remove(path);
}

TEST(ProgramTest, NamesTheConfigurationThatHasNoLayer) {
  const std::string path = scratch_path("trapeze.toml");
  std::ofstream(path) << "[server]\nport = 0\n";
  Program program({"serve", "--config", path});
  EXPECT_EQ(program.wait(), 2);
  EXPECT_THAT(program.output(),
              HasSubstr("there are no layers: name files, or a [[layer]] in " + path));
  std::filesystem::remove(path);
}

TEST(ProgramTest, ReadsItsConfigurationAgainOnSighup) {
  const std::string path = scratch_path("trapeze.toml");
  const auto write = [&path](const std::string& name, const std::string& more) {
    std::ofstream(path) << "[server]\nwatch_ms = 0\n"
                        << more << "[[layer]]\nname = \"" << name << "\"\nfile = \""
                        << fixture("rings.geojson") << "\"\n";
  };
  const auto wait_for = [](const std::uint16_t port, const std::string& target) {
    for (int i = 0; i < 1000; ++i) {
      if (RawClient(port).get(target).status == 200) return true;
      std::this_thread::sleep_for(10ms);
    }
    return false;
  };
  write("one", "");
  std::vector<std::string> arguments = serve_arguments({});
  arguments.insert(arguments.end(), {"--config", path});
  Program program(arguments);
  const std::uint16_t port = program.port();
  EXPECT_TRUE(wait_for(port, "/tiles/one/0/0/0.png"));
  write("two", "queue = 7\n[fonts.a]\nfiles = [\"a.ttf\"]\n");
  program.send_signal(SIGHUP);
  EXPECT_TRUE(wait_for(port, "/tiles/two/0/0/0.png"));
  EXPECT_EQ(RawClient(port).get("/tiles/one/0/0/0.png").status, 404);
  write("three", "prot = 7\n");
  program.send_signal(SIGHUP);
  for (int i = 0; i < 1000 && program.output().find("old ones are kept") == std::string::npos;
       ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(RawClient(port).get("/tiles/two/0/0/0.png").status, 200);
  program.send_signal(SIGTERM);
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.output(),
              AllOf(HasSubstr("SIGHUP"), HasSubstr("server.queue has changed"),
                    HasSubstr("fonts have changed"),
                    HasSubstr(path + ":3:1: unknown key server.prot"), HasSubstr("stopped")));
  std::filesystem::remove(path);
}

TEST(ProgramTest, AFontThatCannotBeUsedIsAWarningOfConfigCheckAndDoesNotKeepFromDrawing) {
  const std::string font = scratch_path("broken.ttf");
  std::ofstream(font) << "these are words";
  const std::string path = scratch_path("trapeze.toml");
  std::ofstream(path) << "[text]\nfonts = [\"" << font << "\",\n \"/nowhere/a.ttf\"]\n"
                      << "[[layer]]\nname = \"a\"\nfile = \"" << fixture("rings.geojson") << "\"\n";
  Program check({"config", "check", path});
  EXPECT_EQ(check.wait(), 0);
  EXPECT_THAT(
      check.output(),
      AllOf(HasSubstr(path + ":2:10: warning: text.fonts: the font "),
            HasSubstr("broken.ttf is in no format of fonts that is known"),
            HasSubstr(path + ":3:2: warning: text.fonts: the font /nowhere/a.ttf is not there"),
            HasSubstr(path + ": the server starts, with 2 warnings; 1 layer\n")));
  auto arguments = serve_arguments({});
  arguments.insert(arguments.end(), {"--config", path});
  Program serve(arguments);
  serve.port();
  serve.send_signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
  EXPECT_THAT(serve.output(),
              AllOf(HasSubstr("/nowhere/a.ttf is not there"),
                    HasSubstr("there is no font, so legends and labels show no text")));
  std::filesystem::remove(path);
  std::filesystem::remove(font);
}

/// A folder with valid maps, and some maps that are broken in one way each.
class ConfigCheckTest : public ::testing::Test {
 protected:
  ConfigCheckTest() {
    copy("rings.geojson", "map.geojson");
    run({"export", file("map.geojson"), "--zoom", "3", "--output", file("map.gpkg")});
    std::filesystem::copy_file(file("map.gpkg"), file("cut.gpkg"));
    std::filesystem::resize_file(file("cut.gpkg"),
                                 std::filesystem::file_size(file("map.gpkg")) / 2);
    write("words.txt", "these are words");
    write("bad.geojson", R"({"type": "FeatureCollection", "features": [{"type": "Feature",)"
                         R"("properties": {}, "geometry": {"type": "Polygon",)"
                         R"("coordinates": [[[0,0],[1e999,0],[5,5],[0,0]]]}}]})");
    copy("rings.geojson", "changed.geojson");
    for (const char* source : {"map.geojson", "bad.geojson", "changed.geojson"}) {
      run({"prepare", file(source), "--output", folder_});
    }
    copy("west.geojson", "changed.geojson");
    std::filesystem::copy_file(file("map.trapeze"), file("other.trapeze"));
    std::fstream(file("other.trapeze"), std::ios::in | std::ios::out | std::ios::binary)
        .seekp(12)  // the version in the file header
        .put('\x63');
  }

  std::string file(const std::string& name) const { return folder_ + "/" + name; }
  void copy(const std::string& name, const std::string& to) const {
    std::filesystem::copy_file(fixture(name), file(to),
                               std::filesystem::copy_options::overwrite_existing);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
  }
  static void run(const std::vector<std::string>& arguments) {
    Program program(arguments);
    ASSERT_EQ(program.wait(), 0) << program.output();
  }

  /// The output of `config check` and its exit status, which shows whether a server would start.
  std::pair<std::optional<int>, std::string> check() const {
    Program program({"config", "check", file("trapeze.toml")});
    const auto status = program.wait();
    return {status, program.output()};
  }
  /// Listens on a free port, unless the configuration sets one.
  std::optional<int> serve() const {
    std::vector<std::string> arguments = {"serve", "--config", file("trapeze.toml")};
    const bool has_port = read_file(file("trapeze.toml")).find("port = ") != std::string::npos;
    if (!has_port) arguments.insert(arguments.end(), {"--port", "0"});
    Program program(arguments);
    return program.wait();
  }

 private:
  static std::string new_folder() {
    std::string folder = ::testing::TempDir() + "config_check_XXXXXX";
    if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no folder");
    return folder;
  }
  const std::string folder_ = new_folder();
};

/// A configuration with a single mistake.
struct Broken {
  const char* text;
  const char* position;  // line:column
  const char* says;
};

TEST_F(ConfigCheckTest, WhatItFindsKeepsTheServerFromStarting) {
  const std::string layer = "[[layer]]\nname = \"a\"\n";
  const Broken all[] = {
      {"file = \"nosuch.fgb\"", ":3:8: ", "layer.a.file: "},
      {"file = \"nosuch.fgb\"", ":3:8: ", "nosuch.fgb: no such file"},
      {"file = \".\"", ":3:8: ", "is a folder"},
      {"file = \"words.txt\"", ":3:8: ", "contains no vector data"},
      {"file = \"cut.gpkg\"", ":3:8: ", "cut.gpkg: "},
      {"file = \"/vsizip/nosuch.zip/a.shp\"", ":3:8: ", "no such file"},
      {"file = \"map.gpkg\"\nsource_layer = \"roads\"", ":4:16: ", "layer.a.source_layer: "},
      {"file = \"map.gpkg\"\nsource_layer = \"roads\"",
       ":4:16: ", "has no layer \"roads\"; it has"},
      {"file = \"map.gpkg\"\nwhere = \"trapeze_id >\"", ":4:9: ", "cannot be asked where"},
      {"file = \"map.gpkg\"\nwhere = \"colour = 1\"", ":4:9: ", "layer.a.where: "},
      {"file = \"map.geojson\"\nwhere = \"colour = 1\"", ":4:9: ", "colour"},
      {"file = \"map.geojson\"\nwhere = \"colour =\"", ":4:9: ", "syntax error"},
      {"file = \"map.gpkg\"\nattributes = [\"trapeze_id\", \"colour\"]",
       ":4:29: ", "has no attribute \"colour\""},
      {"file = \"map.geojson\"\ncoverage = \"off\"\nclose_gaps = 1",
       ":5:14: ", "gaps can be closed only where coverage is auto or on"},
      {"file = \"map.geojson\"\nmerge = 4\nmerge_by = \"colour\"",
       ":5:12: ", "has no attribute \"colour\" to merge by; it has: "},
      {"file = \"map.gpkg\"\nsource_layer = \"map\"\nlive_query = \"SELECT fid, fid FROM map\"",
       ":5:14: ", "live_query has no {since}"},
      {"prepared = \"nosuch.trapeze\"", ":3:12: ", "layer.a.prepared: "},
      {"prepared = \"words.txt\"", ":3:12: ", "contains no vector data"},
      {"prepared = \"changed.trapeze\"", ":3:12: ", "is older than its source: "},
      {"file = \"west.geojson\"\nprepared = \"other.trapeze\"", ":4:12: ", "has format 99"},
      {"prepared = \"map.trapeze\"\nweights = \"effective-area\"",
       ":3:12: ", "and effective-area are configured"},
      {"prepared = \"bad.trapeze\"\nmax_skipped = 0",
       ":4:15: ", "1 of 1 features were skipped (100 %), and at most 0 may be"},
      {"prepared = \"map.trapeze\"\ncrs = [\"EPSG:3857\", \"EPSG:2056\"]",
       ":3:12: ", "map.EPSG-2056.trapeze"},
      {"file = \"map.trapeze\"\ncrs = [\"EPSG:3857\", \"EPSG:2056\"]",
       ":3:8: ", "map.EPSG-2056.trapeze"},
      {"file = \"map.trapeze\"\nwhere = \"a = 1\"", ":3:8: ", "is prepared already"},
      {"file = \"map.geojson\"\n[server]\nweb_root = \"nosuch\"",
       ":5:12: ", "server.web_root: cannot read the folder of the viewer"},
      {"file = \"map.geojson\"\n[log]\naccess = \"nosuch/a.log\"", ":5:10: ", "cannot be written"},
      {"file = \"map.geojson\"\n[log]\naccess = \".\"", ":5:10: ", "Is a directory"},
      {"file = \"map.geojson\"\n[server]\naddress = \"203.0.113.7\"",
       ":5:11: ", "cannot listen on"},
      {"file = \"map.geojson\"\n[server]\naddress = \"localhost\"", ":5:11: ", "IPv4 or IPv6"},
      {"file = \"map.geojson\"\n[server]\nport = 70000", ":5:8: ", "from 0 to 65535"},
      {"file = \"${NOSUCH_VARIABLE}\"", ":3:8: ", "NOSUCH_VARIABLE is not set"},
      {"file = \"map.geojson\"\nmax_skipped = \"many\"", ":4:15: ", "a number of features"},
      {"file = \"map.geojson\"\n[server]\naddress = \"127.0.0.1\"\n[admin]\nport = 8080",
       ":7:8: ", "is the port of the server"},
  };
  for (const Broken& broken : all) {
    write("trapeze.toml", layer + broken.text);
    const auto [status, says] = check();
    EXPECT_EQ(status, 1) << broken.text << "\n" << says;
    EXPECT_THAT(says,
                AllOf(StartsWith(file("trapeze.toml") + broken.position), HasSubstr(broken.says)))
        << broken.text;
    EXPECT_EQ(std::ranges::count(says, '\n'), 1) << "no more than one is wrong: " << says;
    EXPECT_EQ(serve(), 1) << broken.text;
  }
}

TEST_F(ConfigCheckTest, WhatItPassesStartsAndLeavesNoFileBehind) {
  write("trapeze.toml",
        "[server]\naddress = \"127.0.0.1\"\nport = 0\nrenderer = \"software\"\n"
        "[log]\naccess = \"access.log\"\n"
        "[[layer]]\nname = \"a\"\nfile = \"map.gpkg\"\nwhere = \"trapeze_id >= 0\"\n"
        "attributes = [\"trapeze_id\"]\n"
        "[[layer]]\nname = \"b\"\nfile = \"map.geojson\"\nprepared = \"map.trapeze\"");
  const auto [status, says] = check();
  EXPECT_EQ(status, 0) << says;
  EXPECT_EQ(says, file("trapeze.toml") + ": nothing is wrong; 2 layers\n");
  EXPECT_FALSE(std::filesystem::exists(file("access.log")));
  Program program({"serve", "--config", file("trapeze.toml")});
  wait_until_ready(program.port());
}

TEST_F(ConfigCheckTest, TellsAllThatIsWrongAtOnceWithTheEnvironment) {
  write("trapeze.toml",
        "[server]\nweb_root = \"nosuch\"\n[[layer]]\nname = \"a\"\nmin_zoom = 99\n"
        "file = \"nosuch.fgb\"\n[[layer]]\nname = \"b\"\nfile = \"map.gpkg\"\n"
        "where = \"colour\"\nattributes = [\"x\", \"y\"]\n");
  setenv("TRAPEZE_SERVER_QUEUE", "many", 1);
  setenv("TRAPEZE_SERVER_PROT", "80", 1);
  setenv("TRAPEZE_LOG_ACCESS", "/nosuch/access.log", 1);
  const auto [status, says] = check();
  for (const char* name : {"TRAPEZE_SERVER_QUEUE", "TRAPEZE_SERVER_PROT", "TRAPEZE_LOG_ACCESS"}) {
    unsetenv(name);
  }
  EXPECT_EQ(status, 1);
  for (const char* place :
       {":5:12: ", ":2:12: server.web_root", ":6:8: layer.a.file", ":10:9: layer.b.where",
        ":11:15: layer.b.attributes", ":11:20: layer.b.attributes"}) {
    EXPECT_THAT(says, HasSubstr(file("trapeze.toml") + place));
  }
  EXPECT_THAT(says,
              AllOf(HasSubstr("TRAPEZE_SERVER_QUEUE: takes an integer"),
                    HasSubstr("TRAPEZE_SERVER_PROT: there is no such setting"),
                    HasSubstr("TRAPEZE_LOG_ACCESS: log.access: /nosuch/access.log cannot be")));
  EXPECT_EQ(std::ranges::count(says, '\n'), 9) << says;
}

TEST_F(ConfigCheckTest, FindsStylesInWhichNoTileIsDrawn) {
  for (const auto& [style, says] : {std::pair("grow = 3, smooth = 3", "exclude each other"),
                                    std::pair("merge = 3", "only for layers with merge")}) {
    write("trapeze.toml",
          std::string("[[layer]]\nname = \"a\"\nfile = \"map.gpkg\"\nstyle = { ") + style + " }");
    const auto [status, said] = check();
    EXPECT_EQ(status, 1);
    EXPECT_THAT(said, AllOf(HasSubstr("layer.a.style: "), HasSubstr(says)));
  }
}

TEST_F(ConfigCheckTest, WarnsOfFeaturesWithoutTheirTitle) {
  for (const char* layer : {"file = \"map.gpkg\"", "prepared = \"map.trapeze\"",
                            "file = \"map.gpkg\"\nattributes = [\"trapeze_id\"]"}) {
    write("trapeze.toml",
          std::string("[[layer]]\nname = \"a\"\ntitle_attribute = \"colour\"\n") + layer);
    const auto [status, says] = check();
    EXPECT_EQ(status, 0) << says;
    EXPECT_THAT(says, HasSubstr(":3:19: warning: layer.a.title_attribute: "));
    EXPECT_THAT(says, HasSubstr("has no attribute \"colour\": its features have no title"));
  }
}

TEST_F(ConfigCheckTest, WarnsOfWhatTheServerWarnsOfAndStartsWith) {
  write("plain.gml",
        R"(<ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/")"
        R"( xmlns:gml="http://www.opengis.net/gml"><gml:featureMember><ogr:a fid="a.0">)"
        R"(<ogr:geometryProperty><gml:Polygon><gml:outerBoundaryIs><gml:LinearRing>)"
        R"(<gml:coordinates>1,1 2,1 2,2 1,1</gml:coordinates></gml:LinearRing>)"
        R"(</gml:outerBoundaryIs></gml:Polygon></ogr:geometryProperty></ogr:a>)"
        R"(</gml:featureMember></ogr:FeatureCollection>)");
  write("trapeze.toml",
        "[server]\naddress = \"127.0.0.1\"\nport = 0\nrenderer = \"software\"\n"
        "[[layer]]\nname = \"a\"\nfile = \"plain.gml\"\n");
  const std::string words = file("plain.gml") +
                            ": names no coordinate reference system, so its "
                            "coordinates are assumed to be degrees on WGS 84";
  const auto [status, says] = check();
  EXPECT_EQ(status, 0);
  EXPECT_THAT(says, HasSubstr(file("trapeze.toml") + ":7:8: warning: layer.a.file: " + words));
  Program program({"serve", "--config", file("trapeze.toml")});
  wait_until_ready(program.port());
  EXPECT_THAT(program.output(), HasSubstr(" warning " + words));
  Program read({"check", file("plain.gml")});
  EXPECT_EQ(read.wait(), 0);
  EXPECT_THAT(read.output(), HasSubstr("  warning: names no coordinate reference system"));
}

TEST_F(ConfigCheckTest, AConfigurationWithoutLayersIsAWarningAsServeMayBeGivenFiles) {
  write("trapeze.toml", "[server]\nport = 0\n");
  const auto [status, says] = check();
  EXPECT_EQ(status, 0);
  EXPECT_THAT(says, HasSubstr(file("trapeze.toml") + ": warning: there is no [[layer]]"));
}

TEST(ProgramTest, ConfigurationsAreCheckedAndPrinted) {
  const std::string path = scratch_path("trapeze.toml");
  std::ofstream(path) << "[server]\nport = 1\nqueue = 0\nprot = 2\n";
  Program wrong({"config", "check", path});
  EXPECT_EQ(wrong.wait(), 1);
  EXPECT_THAT(wrong.output(), AllOf(HasSubstr(path + ":3:9: server.queue takes"),
                                    HasSubstr(path + ":4:1: unknown key server.prot")));
  std::ofstream(path) << "[server]\nport = 1\n";
  Program right({"config", "check", path});
  EXPECT_EQ(right.wait(), 0);
  setenv("TRAPEZE_SERVER_QUEUE", "77", 1);
  setenv("TRAPEZE_SERVER_BATCH", "7", 1);
  Program print(
      {"config", "print", "--config", path, "--set", "server.batch=3", fixture("rings.geojson")});
  unsetenv("TRAPEZE_SERVER_QUEUE");
  unsetenv("TRAPEZE_SERVER_BATCH");
  EXPECT_EQ(print.wait(), 0);
  using ::testing::ContainsRegex;
  EXPECT_THAT(print.output(),
              AllOf(ContainsRegex("port = 1 +# [^ ]+:2:8\n"), HasSubstr("name = \"rings\""),
                    ContainsRegex("queue = 77 +# TRAPEZE_SERVER_QUEUE\n"),
                    ContainsRegex("batch = 3 +# --set server.batch\n"),
                    ContainsRegex("deadline_ms = 10000 +# default\n")));
  std::filesystem::remove(path);
}

TEST(ProgramTest, AFileThatIsMissingOrNoMapIsAnErrorThatNamesIt) {
  Program missing(serve_arguments({fixture("rings.geojson"), fixture("nosuch.fgb")}));
  EXPECT_EQ(missing.wait(), 1);
  EXPECT_THAT(missing.output(), HasSubstr("nosuch.fgb"));
  const std::string path = scratch_path("broken.fgb");
  std::ofstream(path) << "this is not FlatGeobuf";
  Program broken(serve_arguments({path}));
  EXPECT_EQ(broken.wait(), 1);
  EXPECT_THAT(broken.output(), HasSubstr("broken.fgb"));
  std::filesystem::remove(path);
}

TEST(ProgramTest, APortInUseIsAnErrorThatNamesIt) {
  Program first(serve_arguments({fixture("rings.geojson")}));
  const std::string port = std::to_string(first.port());
  Program second({"serve", "--port", port, "--address", "127.0.0.1", "--renderer", "software",
                  fixture("west.geojson")});
  EXPECT_EQ(second.wait(), 1);
  EXPECT_THAT(second.output(), AllOf(HasSubstr(port), HasSubstr("in use")));
}

TEST(ProgramTest, WrongArgumentsAreErrorsThatHelp) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"serve"}, "there are no layers"},
      {{"serve", "--renderer", "vulkan", fixture("rings.geojson")}, "--renderer: takes \"auto\""},
      {{"serve", "--port", "70000", fixture("rings.geojson")}, "--port: takes an integer from 0"},
      {{"serve", "--set", "limits.scale=9", fixture("rings.geojson")}, "from 1 to 4"},
      {{"serve", "--set", "limits.nosuch=9", fixture("rings.geojson")}, "limits.nosuch=9"},
      {{"serve", "--set", "limits.scale", fixture("rings.geojson")}, "TABLE.KEY=VALUE"},
      {{"config"}, "config needs a command: check, print, schema"},
      {{"config", "check"}, "FILE"},
      {{"render", fixture("rings.geojson"), "--tile", "0/1/0", "--output", "x.png"},
       "0 to 2^Z - 1, got \"0/1/0\""},
      {{"render", fixture("rings.geojson"), "--tile", "0", "--output", "x.png"}, "Z/X/Y"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--style", "fill=no", "--output",
        "x.png"},
       "fill takes a colour"},
      {{"check"}, "FILE"},
      {{"prepare", fixture("rings.geojson")}, "--output"},
      {{"prepare", fixture("rings.geojson"), "--output", "x", "--weights", "none"},
       "effective-area"},
      {{"check", fixture("rings.geojson"), "--coverage", "yes"}, "auto, on or off"},
      {{"check", fixture("rings.geojson"), "--list", "list.shp"},
       "--list takes a name that ends in .fgb"},
      {{"check", fixture("rings.geojson"), fixture("west.geojson"), "--list", "list.fgb"},
       "--list takes one FILE at a time"},
      {{"check", fixture("rings.geojson"), "--overwrite"}, "--overwrite is for --list"},
      {{"prepare", fixture("rings.geojson"), "--output", "x", "--coverage", "yes"},
       "auto, on or off"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--coverage", "yes", "--output",
        "x.fgb"},
       "auto, on or off"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--output", "x.jpg"},
       ".png or .webp"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--output", "png"}, ".png or .webp"},
      {{"bench"}, "NAME"},
      {{"bench", "nosuch", "--help"}, "no benchmark \"nosuch\""},
      {{"bench", "../trapeze"}, "no benchmark \"../trapeze\""},
      {{"export", fixture("rings.geojson"), "--output", "x.fgb"}, "--zoom"},
      {{"export", fixture("rings.geojson"), "--zoom", "3"}, "--output"},
      {{"export", fixture("rings.geojson"), "--zoom", "25", "--output", "x.fgb"}, "0 to 24"},
      {{"export", fixture("rings.geojson"), "--zoom", "-1", "--output", "x.fgb"}, "0 to 24"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--simplify=-1", "--output", "x.fgb"},
       "--simplify takes"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--simplify=nan", "--output", "x.fgb"},
       "--simplify"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--topology", "lax", "--output",
        "x.fgb"},
       "fast or strict"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--weights", "none", "--output",
        "x.fgb"},
       "effective-area"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--crs", "EPSG:25832", "--output",
        "x.fgb"},
       "EPSG:4326 or EPSG:3857"},
      {{}, "Usage"},
      {{"sevre"}, "there is no command sevre; did you mean serve? `trapeze --help` tells more"},
      {{"config", "chek"}, "did you mean check?"},
      {{"serve", "--prot", "9000", fixture("rings.geojson")}, "did you mean --port?"},
      {{"prepare", fixture("rings.geojson"), "--ouput=x"}, "did you mean --output?"},
      {{"serve", "--set", "limits.zom=9", fixture("rings.geojson")}, "did you mean limits.zoom?"},
      {{"serve", "--renderer", "sofware", fixture("rings.geojson")}, "did you mean software?"},
      {{"serve", "--port"}, "--port needs a value, N; `trapeze serve --help` tells more"},
      {{"serve", "--port", "1", "--port", "2", "x.fgb"}, "--port is given more than once"},
      {{"serve", "--verbose=x", fixture("rings.geojson")}, "--verbose takes no value"},
      {{"serve", fixture("rings.geojson"), fixture("rings.geojson")}, "both be the layer"},
      {{"config", "print", "--port"}, "`trapeze config print --help` tells more"},
      {{"config", "print", "--port", "x"}, "--port: takes an integer from 0"},
      {{"config", "print", fixture("rings.geojson"), fixture("rings.geojson")},
       "both be the layer"},
      {{"config", "check", "a.toml", "b.toml"}, "config check takes no further argument b.toml"},
      {{"check", fixture("rings.geojson"), "--close-gaps"}, "--close-gaps needs a value, METRES;"},
      {{"check", fixture("rings.geojson"), "--close-gaps", "x"},
       "--close-gaps takes a number from 0 to 1000, got \"x\""},
      {{"check", fixture("rings.geojson"), "--coverage", "off", "--close-gaps", "5"},
       "--close-gaps needs --coverage auto or on"},
      {{"check", fixture("rings.geojson"), "--coverage", "off", "--merge", "4"},
       "--merge needs --coverage auto or on"},
      {{"check", fixture("rings.geojson"), "--merge-by", "name"}, "--merge-by needs --merge"},
      {{"check", fixture("rings.geojson"), "--coverage", "of"}, "did you mean o"},
      {{"check", fixture("rings.geojson"), "--max-skipped", "101%"},
       "--max-skipped takes a number of features, or a share of them such as \"1%\", got"},
      {{"prepare", fixture("rings.geojson")}, "--output is missing"},
      {{"prepare", fixture("rings.geojson"), fixture("rings.geojson"), "--output", "x"},
       "both be the layer"},
      {{"prepare", fixture("rings.geojson"), "--output", fixture("rings.geojson")},
       "--output takes a folder"},
      {{"export", fixture("rings.geojson"), "--zoom", "x", "--output", "x.fgb"},
       "--zoom takes a whole number from 0 to 24, got \"x\""},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--output", "x.png"}, ".geojson"},
      {{"export", fixture("rings.geojson"), "--zoom", "3", "--output", "x.gpgk"},
       "did you mean .gpkg?"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--scale", "9", "--output", "x.png"},
       "--scale takes a whole number from 1 to 4, got \"9\""},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--output", "x.pgn"},
       "did you mean .png?"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--output", "x.png", "--style",
        "fil=red"},
       "--style: There is no parameter \"fil\"; did you mean \"fill\"?"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--output", "x.png", "--style",
        "rngs.fill=red"},
       "did you mean \"rings.fill\"?"},
      {{"render", fixture("rings.geojson"), "--tile", "0/0/0", "--output", "x.png", "--style",
        "style=defualt"},
       "did you mean \"default\"?"},
      {{"render", fixture("rings.geojson"), fixture("rings.geojson"), "--tile", "0/0/0", "--output",
        "x.png"},
       "both be the layer"}};
  for (const auto& [arguments, says] : wrong) {
    Program program(arguments);
    EXPECT_EQ(program.wait(), 2) << says;
    EXPECT_THAT(program.output(), AllOf(HasSubstr(says), Not(HasSubstr("required"))));
    EXPECT_THAT(program.output(), StartsWith(arguments.empty() ? "Trapeze" : "trapeze: "));
  }
}

TEST(ProgramTest, WhatFailsIsToldInOneStyleAndEndsWithOne) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> failing = {
      {{"serve", "--config", "/nosuch.toml"}, "/nosuch.toml"},
      {{"config", "print", "--config", "/nosuch.toml"}, "/nosuch.toml"},
      {{"prepare", fixture("rings.geojson"), "--output", "/proc/nosuch"}, "/proc/nosuch"},
      {{"check", fixture("nosuch.fgb")}, "nosuch.fgb"},
      {{"export", fixture("nosuch.fgb"), "--zoom", "3", "--output", "x.fgb"}, "nosuch.fgb"}};
  for (const auto& [arguments, says] : failing) {
    Program program(arguments);
    EXPECT_EQ(program.wait(), 1) << says;
    EXPECT_THAT(program.output(), AllOf(StartsWith("trapeze: "), HasSubstr(says)));
  }
}

TEST(ProgramTest, RendersOneTileIntoAFile) {
  const std::string path = scratch_path("tile.png");
  Program program({"render", fixture("west.geojson"), fixture("rings.geojson"), "--tile", "0/0/0",
                   "--scale", "2", "--style", "west.fill=blue&rings.fill=red", "--renderer",
                   "software", "--output", path});
  ASSERT_EQ(program.wait(), 0) << program.output();
  const std::string bytes = read_file(path);
  std::filesystem::remove(path);
  const Picture picture = decode_png(bytes);
  ASSERT_EQ(picture.width, 512);
  EXPECT_EQ(picture.at(10, 10), (Rgba{0, 0, 255, 255}));
  EXPECT_EQ(picture.at(140, 140), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(picture.at(500, 10).a, 0);
}

TEST(ProgramTest, RendersWhatTheNameOfTheOutputSaysWhateverItsCase) {
  for (const std::string name : {"tile.webp", "tile.WEBP"}) {
    const std::string path = scratch_path(name);
    Program program({"render", fixture("rings.geojson"), "--tile", "0/0/0", "--renderer",
                     "software", "--output", path});
    ASSERT_EQ(program.wait(), 0) << program.output();
    const std::string bytes = read_file(path);
    std::filesystem::remove(path);
    EXPECT_EQ(bytes.substr(0, 4), "RIFF");
    EXPECT_EQ(bytes.substr(8, 4), "WEBP");
  }
}

TEST(ProgramTest, PrintsTheTableOfParametersAndSaysSoInItsHelp) {
  Program table({"parameters"});
  EXPECT_EQ(table.wait(), 0);
  EXPECT_THAT(table.output(), AllOf(HasSubstr("fill-opacity"), HasSubstr("|")));
  Program help({"--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_THAT(help.output(), ::testing::ContainsRegex("\n  parameters +Print a table of"));
}

TEST(ProgramTest, ChecksFilesAndGoesOnAfterABadOne) {
  Program program({"check", fixture("nosuch.fgb"), fixture("rings.geojson")});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_THAT(program.output(),
              AllOf(HasSubstr("nosuch.fgb"), HasSubstr("rings.geojson (GeoJSON)"),
                    ::testing::ContainsRegex("polygons +2"), ::testing::ContainsRegex("rings +3"),
                    ::testing::ContainsRegex("vertices +12"), HasSubstr("per vertex"),
                    ::testing::ContainsRegex("memory of the process +[0-9]+ bytes at most")));
  Program good({"check", fixture("rings.geojson")});
  EXPECT_EQ(good.wait(), 0);
}

TEST(ProgramTest, MoreSkippedFeaturesThanAllowedEndEveryCommandThatLoads) {
  const std::string map = scratch_path("map.geojson");
  std::ofstream(map) << R"({"type": "FeatureCollection", "features": [)"
                     << R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon",)"
                     << R"("coordinates": [[[0,0],[5,0],[5,5],[0,0]]]}},)"
                     << R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon",)"
                     << R"("coordinates": [[[0,0],[1e999,0],[5,5],[0,0]]]}}]})";
  const std::string folder = scratch_path("prepared");
  const std::string words = map + ": 1 of 2 features were skipped (50 %), and at most ";
  const auto strict_serve = [&map] {
    auto arguments = serve_arguments({map});
    arguments.push_back("--strict");
    return arguments;
  }();
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
      {{"check", map, "--max-skipped", "49%"}, "49% may be"},
      {{"check", map, "--strict"}, "0 may be"},
      {{"prepare", map, "--output", folder, "--max-skipped", "0"}, "0 may be"},
      {strict_serve, "0 may be"}};
  for (const auto& [arguments, says] : refused) {
    Program program(arguments);
    EXPECT_EQ(program.wait(), 1) << says;
    EXPECT_THAT(program.output(), HasSubstr(words + says));
  }
  EXPECT_THAT(names_in(folder), ::testing::IsEmpty()) << "what is refused is not prepared";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"check", map},
        {"check", map, "--max-skipped", "1"},
        {"prepare", map, "--output", folder, "--max-skipped", "50%"}}) {
    Program program(arguments);
    EXPECT_EQ(program.wait(), 0) << program.output();
  }
  std::filesystem::remove_all(folder);
  std::filesystem::remove(map);
}

TEST(ProgramTest, ListsTheTilesThatDifferInEveryFormat) {
  const auto diff = [](const std::string& later, const std::vector<std::string>& more, int status) {
    std::vector<std::string> arguments = {"diff", fixture("west.geojson"), later, "--zooms", "0-1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Program program(arguments);
    EXPECT_EQ(program.wait(), status) << program.output();
    return program.output();
  };
  const std::string later = fixture("rings.geojson");
  for (const char* certainty : {"bytes", "candidates", "fingerprints"}) {
    EXPECT_THAT(diff(later, {"--certainty", certainty}, 0),
                EndsWith("\n0/0/0\n1/0/0\n1/1/0\n1/0/1\n1/1/1\n"))
        << certainty;
  }
  EXPECT_THAT(diff(later, {"--format", "json"}, 0),
              EndsWith("\n[\"0/0/0\",\"1/0/0\",\"1/1/0\",\"1/0/1\",\"1/1/1\"]\n"));
  const std::string said = diff(later, {"--format", "geojson"}, 0);
  const auto collection = nlohmann::json::parse(said.substr(said.find("{\"type\"")));
  ASSERT_EQ(collection["features"].size(), 5u);
  const auto& east = collection["features"][2];
  EXPECT_EQ(east["properties"], nlohmann::json({{"z", 1}, {"x", 1}, {"y", 0}}));
  const auto& corner = east["geometry"]["coordinates"][0][2];
  EXPECT_NEAR(corner[0].get<double>(), 180, 1e-6);
  EXPECT_NEAR(corner[1].get<double>(), 85.0511288, 1e-6);
  EXPECT_THAT(diff(fixture("west.geojson"), {}, 0), Not(HasSubstr("0/0/0\n"))) << "nothing differs";
  EXPECT_THAT(diff(fixture("nosuch.geojson"), {}, 1), HasSubstr("nosuch.geojson: no such file"));
  EXPECT_THAT(diff(later, {"--format", "xml"}, 2),
              HasSubstr("--format takes geojson, json or text"));
  EXPECT_THAT(diff(later, {"--certainty", "x"}, 2),
              HasSubstr("--certainty takes bytes, candidates"));
}

TEST(ProgramTest, ExportsThePolygonsOfAZoomAndSaysWhatIsLeft) {
  const std::string path = scratch_path("coarse.geojson");
  std::filesystem::remove(path);
  const std::vector<std::string> arguments = {
      "export", fixture("rings.geojson"), "--zoom", "3", "--output", path};
  Program program(arguments);
  ASSERT_EQ(program.wait(), 0) << program.output();
  EXPECT_THAT(program.output(),
              AllOf(HasSubstr(path + " (GeoJSON): 1 features with 2 polygons"),
                    HasSubstr("12 of 12 vertices kept"), HasSubstr("0 features left out")));
  EXPECT_THAT(read_file(path), AllOf(HasSubstr("trapeze_id"), HasSubstr("MultiPolygon")));
  Program again(arguments);
  EXPECT_EQ(again.wait(), 1);
  EXPECT_THAT(again.output(), AllOf(HasSubstr(path), HasSubstr("--overwrite")));
  std::vector<std::string> rough = arguments;
  rough.insert(rough.end(), {"--overwrite", "--simplify", "10000"});
  Program replaced(rough);
  EXPECT_EQ(replaced.wait(), 0);
  EXPECT_THAT(replaced.output(), HasSubstr("1 polygons; 4 of 12 vertices kept"));
  std::filesystem::remove(path);
}

TEST(ProgramTest, PreparesAgainWithWhatHasNotChanged) {
  const std::string folder = scratch_path("prepared");
  std::filesystem::remove_all(folder);
  const auto prepare = [&](std::vector<std::string> more, int status) {
    more.insert(more.begin(), {"prepare", fixture("rings.geojson"), "--output", folder});
    Program program(more);
    EXPECT_EQ(program.wait(), status);
    return program.output();
  };
  EXPECT_THAT(prepare({"--reuse", "nosuch"}, 1), HasSubstr("nosuch: no such file"));
  EXPECT_THAT(prepare({"--reuse", folder}, 0),
              HasSubstr("nothing is reused: " + folder + "/rings.trapeze is not there"));
  const std::string file = folder + "/rings.trapeze";
  const std::string anew = read_file(file);
  EXPECT_THAT(prepare({"--reuse", folder}, 0),
              HasSubstr("1 of 1 features are unchanged and reused from " + file));
  EXPECT_EQ(read_file(file), anew);
  EXPECT_THAT(prepare({"--reuse", file, "--weights", "effective-area"}, 0),
              HasSubstr("nothing is reused: " + file + " was prepared with the weights"));
  EXPECT_THAT(prepare({"--reuse", fixture("rings.geojson")}, 1), HasSubstr("not a prepared file"));
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(file, 1000);
  EXPECT_THAT(prepare({"--reuse", file}, 1), HasSubstr(file + ": is damaged"));
}

// One made by --join, where many machines prepared the parts, is replaced and not joined by
// another.
TEST(ProgramTest, PreparesOneOverviewOfTheSameParts) {
  const std::string folder = scratch_path("parts");
  std::filesystem::remove_all(folder);
  const auto prepare = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "prepare");
    Program program(arguments);
    EXPECT_EQ(program.wait(), 0) << program.output();
  };
  for (const char* const part : {"1/2", "2/2"}) {
    prepare({fixture("rings.geojson"), "--part", part, "--output", folder});
  }
  prepare({"--join", folder + "/*.trapeze", "--output", folder});
  prepare({fixture("rings.geojson"), "--part", "1-2/2", "--output", folder});
  EXPECT_EQ(names_in(folder).size(), 3u);
  Program check({"check", folder + "/*.trapeze"});
  EXPECT_EQ(check.wait(), 0) << check.output();
  std::filesystem::remove_all(folder);
}

TEST(ProgramTest, PreparesFilesThatAreServedUnderTheSameTags) {
  const std::string folder = scratch_path("prepared");
  std::filesystem::remove_all(folder);
  Program prepare({"prepare", fixture("rings.geojson"), fixture("nosuch.fgb"),
                   fixture("west.geojson"), "--output", folder});
  EXPECT_EQ(prepare.wait(), 1) << "one of them is not there";
  EXPECT_THAT(prepare.output(), AllOf(HasSubstr("nosuch.fgb"), HasSubstr("rings.trapeze: 1 of 1"),
                                      HasSubstr("west.trapeze: 1 of 1")));
  Program again({"prepare", fixture("rings.geojson"), "--output", folder});
  EXPECT_EQ(again.wait(), 0) << again.output();
  const auto answer = [](const std::vector<std::string>& files) {
    Program program(serve_arguments(files));
    const std::uint16_t port = program.port();
    wait_until_ready(port);
    return RawClient(port).get("/tiles/rings,west/0/0/0.png");
  };
  const auto built = answer({fixture("rings.geojson"), fixture("west.geojson")});
  const auto prepared = answer({folder + "/rings.trapeze", folder + "/west.trapeze"});
  EXPECT_EQ(prepared.status, 200);
  EXPECT_EQ(prepared.body, built.body);
  EXPECT_EQ(prepared.headers.at("etag"), built.headers.at("etag"));
  Program check({"check", folder + "/rings.trapeze"});
  EXPECT_EQ(check.wait(), 0);
  EXPECT_THAT(check.output(), AllOf(HasSubstr("GeoJSON, prepared from " + fixture("rings.geojson")),
                                    ::testing::ContainsRegex("polygons +2")));
  std::filesystem::resize_file(folder + "/rings.trapeze", 1000);
  Program damaged(serve_arguments({folder + "/rings.trapeze"}));
  EXPECT_EQ(damaged.wait(), 1);
  EXPECT_THAT(damaged.output(), HasSubstr("rings.trapeze: is damaged"));
  std::filesystem::remove_all(folder);
}

// The arguments are in the order in which the shell expands `trapeze serve prepared/*.trapeze`.
TEST(ProgramTest, WhatIsPreparedForOtherGridsBelongsToTheLayerOfItsName) {
  const std::string folder = scratch_path("prepared_on_grids");
  std::filesystem::remove_all(folder);
  Program prepare(
      {"prepare", fixture("rings.geojson"), "--crs", "EPSG:3035,EPSG:5041", "--output", folder});
  ASSERT_EQ(prepare.wait(), 0) << prepare.output();
  const std::string mercator = folder + "/rings.trapeze";
  const std::string lambert = folder + "/rings.EPSG-3035.trapeze";
  {
    Program program(serve_arguments({lambert, folder + "/rings.EPSG-5041.trapeze", mercator}));
    const std::uint16_t port = program.port();
    wait_until_ready(port);
    RawClient client(port);
    for (const char* crs : {"EPSG:3035", "EPSG:5041"}) {
      const auto map = client.get(std::string("/map/rings.png?crs=") + crs +
                                  "&bbox=1000000,1000000,2000000,2000000&width=64");
      EXPECT_EQ(map.status, 200) << crs << ": " << map.body;
    }
    EXPECT_EQ(client.get("/tiles/rings/0/0/0.png").status, 200);
    EXPECT_EQ(client.get("/map/rings.png?crs=EPSG:2056&bbox=0,0,9,9&width=9").status, 400);
  }
  Program check({"check", mercator, lambert});
  EXPECT_EQ(check.wait(), 0) << check.output();
  const std::string old = folder + "/rings.2024-05.trapeze";  // "2024-05" is not a reference system
  std::filesystem::copy_file(mercator, old);
  Program check_old({"check", old});
  EXPECT_EQ(check_old.wait(), 0) << check_old.output();
  Program alone(serve_arguments({lambert}));
  EXPECT_EQ(alone.wait(), 1);
  EXPECT_THAT(alone.output(), HasSubstr(lambert));
  EXPECT_THAT(alone.output(), HasSubstr("or not for EPSG:3857"));
  std::filesystem::remove_all(folder);
}

TEST(ProgramTest, HelpShowsExamples) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"serve", "--help"},
                                                    {"check", "--help"},
                                                    {"config", "--help"},
                                                    {"prepare", "--help"},
                                                    {"export", "--help"},
                                                    {"render", "--help"}}) {
    Program program(arguments);
    EXPECT_EQ(program.wait(), 0);
    EXPECT_THAT(program.output(), HasSubstr("Example"));
  }
  Program version({"--version"});
  EXPECT_EQ(version.wait(), 0);
  EXPECT_THAT(version.output(), ::testing::StartsWith("trapeze 0."));
}

TEST(ProgramTest, HelpTellsTheDefaultsOfSettings) {
  Program program({"serve", "--help"});
  EXPECT_EQ(program.wait(), 0);
  const ServerConfig defaults;
  const std::string port = std::to_string(defaults.port);
  EXPECT_THAT(program.output(),
              AllOf(::testing::ContainsRegex("--port N +The port.*Default: " + port),
                    ::testing::ContainsRegex("--address IP +The.*Default: " + defaults.address),
                    ::testing::ContainsRegex("--renderer NAME .*\"software\"[.] Default: auto")));
}

}  // namespace
}  // namespace trapeze
