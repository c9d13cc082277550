// A whole server: reloading layers while it serves, and the address for operators.
#include "server/service/service.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "render/make_renderer.h"
#include "server/config/load_config.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using testing::fixture;
using ::testing::HasSubstr;
using testing::RawClient;
using testing::RawResponse;

constexpr const char* kTile = "/tiles/shape/0/0/0.png";

bool holds_within(std::chrono::milliseconds patience, const std::function<bool()>& holds) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < end) {
    if (holds()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return holds();
}

std::uint16_t free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(probe, reinterpret_cast<const sockaddr*>(&address), size);
  getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
  close(probe);
  return ntohs(address.sin_port);
}

class ServiceTest : public ::testing::Test {
 protected:
  ServiceTest() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    replace_file("rings.geojson");
    config_.server.address = "127.0.0.1";
    config_.server.port = 0;
    config_.server.workers = 2;
    config_.server.renderer.kind = RendererKind::software;
    config_.server.watch_ms = 0;
  }
  ~ServiceTest() override {
    stop();
    std::filesystem::remove_all(folder_);
  }

  /// Replaces the layer's file with a fixture in one step.
  void replace_file(const std::string& name) const {
    std::filesystem::copy_file(fixture(name), file_ + ".new",
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::rename(file_ + ".new", file_);
  }

  void start() {
    const auto layers = [this] {
      if (before_reading_) before_reading_();
      auto named = layers_of_files({file_});
      named[0].style = testing::style_of("fill=f00");
      return named;
    };
    service_ =
        std::make_unique<Service>(config_, LayerSource{layers, "", [this] { return tables_; }});
    thread_ = std::thread([this] { service_->run(); });
    ASSERT_TRUE(holds_within(10s, [this] { return get("/ready").status == 200; }));
  }

  void stop() {
    if (!thread_.joinable()) return;
    service_->stop();
    thread_.join();
    service_.reset();
  }

  RawResponse get(const std::string& target) const {
    return RawClient(service_->port()).get(target);
  }
  std::string tag() const { return get(kTile).headers.at("etag"); }
  /// Whether /metrics has that line.
  bool tells(const std::string& line) const {
    return get("/metrics").body.find("\n" + line + "\n") != std::string::npos;
  }

  const std::string folder_ = ::testing::TempDir() + "/service_test_" +
                              ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::string file_ = folder_ + "/shape.geojson";
  std::function<void()> before_reading_;  // called in the thread that reads
  std::map<std::string, ValueTableConfig> tables_;
  Config config_;
  std::unique_ptr<Service> service_;
  std::thread thread_;
};

TEST_F(ServiceTest, ReadsItsLayersAgainWhenTold) {
  start();
  const std::string old_tag = tag();
  replace_file("west.geojson");
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(tag(), old_tag) << "nothing watches";
  service_->reload();
  EXPECT_TRUE(holds_within(10s, [&] { return tag() != old_tag; }));
  EXPECT_TRUE(tells("trapeze_data_loads_total{result=\"succeeded\"} 2"));
  replace_file("rings.geojson");
  service_->reload();
  EXPECT_TRUE(holds_within(10s, [&] { return tag() == old_tag; })) << "same data, same tags";
}

TEST_F(ServiceTest, TilesThatLookAsBeforeAreHeldAndKeptAfterReadingAgain) {
  start();
  const RawResponse empty = get("/tiles/shape/9/510/510.png");
  const RawResponse old_tile = get(kTile);
  replace_file("west.geojson");
  service_->reload();
  ASSERT_TRUE(holds_within(10s, [&] { return tag() != old_tile.headers.at("etag"); }));
  // A tile that has not been requested yet.
  const RawResponse other = get("/tiles/shape/9/509/509.png");
  EXPECT_EQ(other.headers.at("etag"), empty.headers.at("etag"));
  EXPECT_EQ(other.headers.at("x-cache"), "HIT");
  const RawResponse held =
      RawClient(service_->port())
          .get("/tiles/shape/9/508/508.png", "If-None-Match: " + empty.headers.at("etag") + "\r\n");
  EXPECT_EQ(held.status, 304);
  replace_file("rings.geojson");
  service_->reload();
  ASSERT_TRUE(holds_within(10s, [&] { return tag() == old_tile.headers.at("etag"); }));
  EXPECT_TRUE(tells("trapeze_tiles_total{outcome=\"kept\"} 2"));
}

TEST_F(ServiceTest, TellsWhichTilesHaveChanged) {
  config_.admin.port = free_port();
  config_.changes.zooms = "0-3";
  config_.changes.command = "(echo $TRAPEZE_SINCE $TRAPEZE_GENERATION; cat) > " + folder_ +
                            "/said.new; mv " + folder_ + "/said.new " + folder_ + "/said";
  start();
  const auto ask = [this](const std::string& since) {
    return RawClient(config_.admin.port).get("/changes?since=" + since);
  };
  const auto generation = [this] {
    return nlohmann::json::parse(get("/catalog").body).at("generation").get<std::string>();
  };
  const std::string first = generation();
  EXPECT_EQ(nlohmann::json::parse(ask(first).body).at("layers").size(), 0u);
  EXPECT_EQ(ask("0123456789abcdef").status, 404);
  EXPECT_EQ(RawClient(config_.admin.port).get("/changes").status, 400);
  replace_file("west.geojson");
  service_->reload();
  ASSERT_TRUE(holds_within(10s, [&] { return generation() != first; }));
  ASSERT_TRUE(holds_within(10s, [&] { return ask(first).status == 200; }));
  const auto changes = nlohmann::json::parse(ask(first).body);
  EXPECT_EQ(changes.at("generation"), generation());
  const auto& layer = changes.at("layers").at(0);
  EXPECT_EQ(layer.at("name"), "shape");
  EXPECT_EQ(layer.at("all_from_zoom"), nullptr);
  const auto tiles = layer.at("tiles").get<std::vector<std::string>>();
  EXPECT_EQ(tiles.front(), "0/0/0");
  EXPECT_GT(tiles.size(), 4u);
  EXPECT_LT(tiles.size(), 1u + 4 + 16 + 64) << "not all";
  ASSERT_TRUE(holds_within(10s, [this] { return std::filesystem::exists(folder_ + "/said"); }));
  std::ifstream file(folder_ + "/said");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, first + " " + generation());
  for (const std::string& tile : tiles) {
    std::getline(file, line);
    ASSERT_EQ(line, "shape " + tile);
  }
  // After a change and its reversal the tiles are the same since either generation.
  replace_file("rings.geojson");
  service_->reload();
  ASSERT_TRUE(holds_within(10s, [&] { return generation() == first; }));
  EXPECT_EQ(ask(first).body.find("shape"), std::string::npos) << "nothing since it was as it is";
}

TEST_F(ServiceTest, ACommandThatDoesNotEndIsEndedWithTheServer) {
  config_.changes.zooms = "0";
  config_.changes.command = "echo > " + folder_ + "/began; trap '' TERM; sleep 600";
  start();
  replace_file("west.geojson");
  service_->reload();
  ASSERT_TRUE(holds_within(10s, [this] { return std::filesystem::exists(folder_ + "/began"); }));
  stop();  // otherwise the test would not end
}

TEST_F(ServiceTest, ReadsItsLayersAgainWhenTheirFileHasChanged) {
  config_.server.watch_ms = 30;
  start();
  const std::string old_tag = tag();
  replace_file("west.geojson");
  EXPECT_TRUE(holds_within(10s, [&] { return tag() != old_tag; }));
  std::this_thread::sleep_for(200ms);
  EXPECT_TRUE(tells("trapeze_data_loads_total{result=\"succeeded\"} 2")) << "once is enough";
}

TEST_F(ServiceTest, ReadsTablesOfValuesAgainWhenTheirFileHasChanged) {
  const auto write = [this](const std::string& table) {
    std::ofstream(folder_ + "/ranks.csv.new") << table;
    std::filesystem::rename(folder_ + "/ranks.csv.new", folder_ + "/ranks.csv");
  };
  const std::string target =
      std::string(kTile) + "?values=ranks&color-by=value&classes=1:lime,2:blue";
  const auto tag_now = [&] { return get(target).headers.at("etag"); };
  write("rank,colour\n1,1\n");
  tables_["ranks"].file = folder_ + "/ranks.csv";
  config_.server.watch_ms = 20;
  start();
  const std::string before = tag_now();
  write("rank,colour\n1,2\n");
  EXPECT_TRUE(holds_within(10s, [&] { return tag_now() != before; }));
  const std::string after = tag_now();
  // An invalid table leaves the old one in place.
  write("rank,colour\n1,2\n1,1\n");
  EXPECT_TRUE(holds_within(10s, [this] { return tells("trapeze_data_load_failed 1"); }));
  EXPECT_EQ(tag_now(), after);
}

TEST_F(ServiceTest, ReadsItsLayersAgainWhenTheWriteAheadLogOfAFileHasChanged) {
  config_.server.watch_ms = 30;
  start();
  std::ofstream(file_ + "-wal") << "a change";
  EXPECT_TRUE(
      holds_within(10s, [&] { return tells("trapeze_data_loads_total{result=\"succeeded\"} 2"); }));
  std::this_thread::sleep_for(200ms);
  EXPECT_TRUE(tells("trapeze_data_loads_total{result=\"succeeded\"} 2")) << "once is enough";
  std::filesystem::remove(file_ + "-wal");
  EXPECT_TRUE(
      holds_within(10s, [&] { return tells("trapeze_data_loads_total{result=\"succeeded\"} 3"); }));
}

TEST_F(ServiceTest, AFileThatIsBeingWrittenIsLeftAloneUntilItIsDone) {
  config_.server.watch_ms = 200;
  start();
  const std::string old_tag = tag();
  std::ifstream source(fixture("west.geojson"));
  const std::string text{std::istreambuf_iterator<char>(source), {}};
  std::ofstream writer(file_, std::ios::trunc);
  for (std::size_t i = 0; i < text.size(); i += text.size() / 10 + 1) {
    writer << text.substr(i, text.size() / 10 + 1) << std::flush;
    std::this_thread::sleep_for(80ms);
  }
  writer.close();
  EXPECT_TRUE(holds_within(10s, [&] { return tag() != old_tag; }));
  EXPECT_TRUE(tells("trapeze_data_loads_total{result=\"failed\"} 0")) << "no half file was read";
}

TEST_F(ServiceTest, BrokenAndMissingFilesLeaveTheOldLayersInPlace) {
  config_.server.watch_ms = 30;
  start();
  const RawResponse old_tile = get(kTile);
  std::ofstream(file_) << "{ this is no map";
  EXPECT_TRUE(holds_within(10s, [&] { return tells("trapeze_data_load_failed 1"); }));
  EXPECT_EQ(get(kTile).body, old_tile.body);
  EXPECT_EQ(get("/ready").status, 200);
  std::filesystem::remove(file_);
  EXPECT_TRUE(
      holds_within(10s, [&] { return tells("trapeze_data_loads_total{result=\"failed\"} 2"); }));
  EXPECT_EQ(get("/tiles/shape/1/0/0.png").status, 200);
  replace_file("west.geojson");
  EXPECT_TRUE(holds_within(10s, [&] { return tells("trapeze_data_load_failed 0"); }));
  EXPECT_NE(tag(), old_tile.headers.at("etag"));
}

TEST_F(ServiceTest, AFileThatIsMendedWhileItsReadingFailsIsReadAgain) {
  config_.server.watch_ms = 30;
  start();
  const std::string old_tag = tag();
  std::atomic<bool> is_to_fail = true;
  before_reading_ = [&] {
    if (!is_to_fail.exchange(false)) return;
    replace_file("west.geojson");
    throw std::runtime_error("what was there could not be read");
  };
  service_->reload();
  EXPECT_TRUE(holds_within(10s, [&] { return tag() != old_tag; }));
  EXPECT_TRUE(tells("trapeze_data_loads_total{result=\"failed\"} 1"));
  stop();
}

TEST_F(ServiceTest, UnderLoadEveryAnswerIsOldOrNewAndNoneIsLost) {
  config_.server.cache_mb = 0;  // so that every tile is drawn
  start();
  std::map<std::string, std::string> pictures;  // by tag
  pictures[tag()] = get(kTile).body;
  replace_file("west.geojson");
  service_->reload();
  ASSERT_TRUE(holds_within(10s, [&] { return !pictures.contains(tag()); }));
  pictures[tag()] = get(kTile).body;
  std::atomic<bool> is_over = false;
  std::atomic<int> answers = 0;
  std::atomic<int> wrong = 0;
  std::mutex mutex;
  std::set<std::string> seen;
  std::vector<std::thread> clients;
  for (int i = 0; i < 3; ++i) {
    clients.emplace_back([&] {
      RawClient client(service_->port());
      while (!is_over) {
        const RawResponse response = client.get(kTile);
        const auto expected = pictures.find(response.headers.at("etag"));
        const bool is_right = response.status == 200 && expected != pictures.end() &&
                              expected->second == response.body;
        wrong += is_right ? 0 : 1;
        ++answers;
        const std::lock_guard lock(mutex);
        seen.insert(response.headers.at("etag"));
      }
    });
  }
  for (int i = 0; i < 20; ++i) {
    replace_file(i % 2 == 0 ? "rings.geojson" : "west.geojson");
    const int before = answers;
    service_->reload();
    holds_within(2s, [&] { return !service_->is_loading() && answers > before + 20; });
  }
  is_over = true;
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(wrong, 0) << "of " << answers;
  EXPECT_GT(answers, 400);
  EXPECT_EQ(seen.size(), 2u) << "both were served";
}

TEST_F(ServiceTest, TheAdminAddressTellsMoreAndServesNoTiles) {
  config_.admin.port = free_port();
  config_.server.metrics = false;
  start();
  const auto admin = [this](const std::string& target) {
    return RawClient(config_.admin.port).get(target);
  };
  EXPECT_EQ(get("/metrics").status, 404) << "configured away";
  EXPECT_THAT(admin("/metrics").body, HasSubstr("trapeze_layer_bytes{layer=\"shape\"}"));
  EXPECT_THAT(admin("/metrics").headers.at("content-type"), HasSubstr("text/plain; version=0.0.4"));
  EXPECT_EQ(admin("/health").status, 200);
  EXPECT_EQ(admin(kTile).status, 404);
  const RawResponse ready = admin("/ready");
  EXPECT_EQ(ready.status, 200);
  auto state = nlohmann::json::parse(ready.body);
  EXPECT_EQ(state["status"], "ready");
  EXPECT_EQ(state["layers"][0]["name"], "shape");
  EXPECT_EQ(state["layers"][0]["vertices"], 12);
  EXPECT_TRUE(state["last_load_problem"].is_null());
  std::ofstream(file_) << "nothing";
  service_->reload();
  EXPECT_TRUE(holds_within(10s, [&] {
    state = nlohmann::json::parse(admin("/ready").body);
    return state["last_load_problem"].is_string();
  }));
  EXPECT_THAT(state["last_load_problem"].get<std::string>(), HasSubstr("shape.geojson"));
  RawClient poster(config_.admin.port);
  poster.send("POST /ready HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n");
  EXPECT_EQ(poster.receive().status, 405);
}

TEST_F(ServiceTest, WritesALineForEveryRequest) {
  config_.log.access = folder_ + "/access.log";
  config_.log.access_format = LogFormat::json;
  start();
  get(kTile);
  stop();
  std::ifstream log(config_.log.access);
  bool has_tile = false;
  for (std::string line; std::getline(log, line);) {
    const auto json = nlohmann::json::parse(line);
    has_tile = has_tile || (json["target"] == kTile && json["status"] == 200);
  }
  EXPECT_TRUE(has_tile);
}

/// Draws in software, and records which meshes were drawn and which are to be forgotten.
class NotingRenderer : public MaskRenderer {
 public:
  struct Notes {
    std::mutex mutex;
    std::set<std::uint64_t> kept;
    std::size_t drawn = 0;
  };
  explicit NotingRenderer(Notes& notes)
      : notes_(notes), renderer_(std::move(make_renderer({RendererKind::software, {}}).renderer)) {}

  DrawTimes draw(std::span<const MaskTask> tasks) override {
    {
      const std::lock_guard lock(notes_.mutex);
      for (const MaskTask& task : tasks) {
        for (const MeshPart& part : task.parts) notes_.kept.insert(part.mesh.id);
        ++notes_.drawn;
      }
    }
    return renderer_->draw(tasks);
  }
  void forget(std::uint64_t mesh) override {
    const std::lock_guard lock(notes_.mutex);
    notes_.kept.erase(mesh);
  }
  std::string_view name() const override { return "noting"; }
  std::string description() const override { return "for tests"; }

 private:
  Notes& notes_;
  std::unique_ptr<MaskRenderer> renderer_;
};

TEST(ReloaderTest, TheRendererForgetsMeshesThatAreNotServedAnyMore) {
  NotingRenderer::Notes notes;
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  renderers.push_back(std::make_unique<NotingRenderer>(notes));
  CurrentDataset data;
  Metrics metrics;
  TileCache cache(0);
  TileService tiles({}, std::move(renderers));
  const Site site({}, {}, data, tiles, cache);
  const TemporaryFolder folder;
  const auto replace_file = [&folder](int generation) {
    std::filesystem::copy_file(fixture("rings.geojson"), folder.file("rings.geojson"),
                               std::filesystem::copy_options::overwrite_existing);
    // Guarantees a new modification time, however fast the test runs.
    std::filesystem::last_write_time(folder.file("rings.geojson"),
                                     std::filesystem::file_time_type{} + generation * 1s);
  };
  replace_file(0);
  const auto layers = [&folder] {
    auto rings = layers_of_files({folder.file("rings.geojson")});
    rings[0].fast_topology = true;
    return rings;
  };
  // The Reloader wakes up only for reload(): frequent requests must not keep it from freeing old
  // layers.
  Reloader reloader(
      {layers, ""}, {1h}, data, tiles, metrics, nullptr, [] { FAIL(); }, [] {});
  reloader.start();
  ASSERT_TRUE(holds_within(10s, [&] { return data.get() != nullptr; }));
  const auto draw = [&](const char* query) {
    std::atomic<int> status = 0;
    const std::string target = std::string("/tiles/rings/1/0/0.png?simplify=0") + query;
    site.handle({"GET", target, "a", "", {}},
                [&status](const HttpResponse& response) { status = response.status; });
    EXPECT_TRUE(holds_within(5s, [&status] { return status == 200; }));
  };
  const auto reload = [&] {
    const auto old_data = data.get().get();
    reloader.reload();
    EXPECT_TRUE(holds_within(10s, [&] { return data.get().get() != old_data; }));
  };
  for (int i = 0; i < 5; ++i) {
    draw("");
    draw("&topology=fast");
    reload();
    replace_file(i + 1);
    reload();
  }
  EXPECT_EQ(notes.drawn, 10u);
  EXPECT_TRUE(holds_within(5s, [&notes] {
    const std::lock_guard lock(notes.mutex);
    return notes.kept.empty();
  })) << "five generations with two meshes each are gone, the sixth was not drawn";
}

TEST(ReloaderTest, TheRendererKeepsMeshesOfLayersThatAreServedOn) {
  NotingRenderer::Notes notes;
  std::vector<std::unique_ptr<MaskRenderer>> renderers;
  renderers.push_back(std::make_unique<NotingRenderer>(notes));
  const auto layers = [] { return layers_of_files({fixture("rings.geojson")}); };
  CurrentDataset data;
  Metrics metrics;
  TileService tiles({}, std::move(renderers));
  {
    Reloader reloader(
        {layers, ""}, {1h}, data, tiles, metrics, nullptr, [] { FAIL(); }, [] {});
    reloader.start();
    ASSERT_TRUE(holds_within(10s, [&] { return data.get() != nullptr; }));
    const std::uint64_t mesh = data.get()->layers()[0].layer->mesh().id;
    {
      const std::lock_guard lock(notes.mutex);
      notes.kept.insert(mesh);
    }
    for (int i = 0; i < 3; ++i) {
      const Dataset* const before = data.get().get();
      reloader.reload();
      ASSERT_TRUE(holds_within(10s, [&] { return data.get().get() != before; }));
      EXPECT_EQ(data.get()->layers()[0].layer->mesh().id, mesh);
    }
  }
  const std::lock_guard lock(notes.mutex);
  EXPECT_EQ(notes.kept.size(), 1u);
}

TEST(ReloaderTest, ALayerThatLostMostOfItsFeaturesIsNotTakenUnlessItMayShrink) {
  const TemporaryFolder folder;
  const auto write_bands = [&folder](int bands) {
    std::string text = R"({"type": "FeatureCollection", "features": [)";
    for (int i = 0; i < bands; ++i) {
      text += fmt::format(R"({0}{{"type": "Feature", "properties": {{}}, "geometry": {{)"
                          R"("type": "Polygon", "coordinates": )"
                          R"([[[{1},0],[{1}.5,0],[{1}.5,9],[{1},0]]]}}}})",
                          i == 0 ? "" : ",", i);
    }
    folder.write("bands.geojson", text + "]}");
  };
  write_bands(9);
  std::atomic<bool> may_shrink = false;
  const auto layers = [&] {
    auto bands = layers_of_files({folder.file("bands.geojson")});
    bands[0].may_shrink = may_shrink;
    return bands;
  };
  CurrentDataset data;
  Metrics metrics;
  TileService tiles({}, make_renderers({RendererKind::software, {}}, 1).renderers);
  Reloader reloader(
      {layers, ""}, {1h}, data, tiles, metrics, nullptr, [] { FAIL(); }, [] {});
  reloader.start();
  ASSERT_TRUE(holds_within(10s, [&] { return data.get() != nullptr; }));
  const auto bands_served = [&data] { return data.get()->layers()[0].report.loaded; };
  write_bands(4);
  reloader.reload();
  EXPECT_TRUE(holds_within(10s, [&] { return !reloader.last_problem().empty(); }));
  EXPECT_THAT(reloader.last_problem(),
              AllOf(HasSubstr("bands.geojson: 4 features can be drawn, fewer than half of the 9"),
                    HasSubstr("may_shrink = true")));
  EXPECT_EQ(bands_served(), 9u) << "the old layer stays";
  may_shrink = true;
  reloader.reload();
  EXPECT_TRUE(holds_within(10s, [&] { return bands_served() == 4; }));
  EXPECT_TRUE(holds_within(10s, [&] { return reloader.last_problem().empty(); }));
}

TEST(ReloaderTest, GivesUpIfTheLayersCannotBeReadTheFirstTime) {
  CurrentDataset data;
  Metrics metrics;
  TileService tiles({}, make_renderers({RendererKind::software, {}}, 1).renderers);
  std::atomic<bool> has_given_up = false;
  const auto layers = []() -> std::vector<LayerConfig> {
    throw std::runtime_error("there is no map");
  };
  Reloader reloader(
      {layers, ""}, {0ms}, data, tiles, metrics, nullptr, [&] { has_given_up = true; },
      [] { FAIL() << "nothing is loaded"; });
  reloader.start();
  EXPECT_TRUE(holds_within(5s, [&] { return has_given_up.load(); }));
  EXPECT_THROW(reloader.rethrow_failure(), std::runtime_error);
  EXPECT_FALSE(reloader.is_loading());
}

}  // namespace
}  // namespace trapeze
