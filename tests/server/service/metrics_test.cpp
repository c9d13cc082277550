#include "server/service/metrics.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

HttpRequest request_for(const std::string& target) {
  return {"GET", target, "", "", {}};
}

HttpResponse response_with(int status) {
  HttpResponse response;
  response.status = status;
  return response;
}

void count(Metrics& metrics, const std::string& target, int status, double seconds = 0.001) {
  const HttpRequest request = request_for(target);
  const HttpResponse response = response_with(status);
  metrics.count(Answered{request, response, std::chrono::duration<double>(seconds), 11, {}, {}});
}

/// Samples by name with labels. Fails on a line that does not follow the text format.
std::map<std::string, double> samples_of(const std::string& text) {
  const std::regex sample(
      R"(([a-z_]+(\{[a-z]+="([^"\\]|\\.)*"(,[a-z]+="([^"\\]|\\.)*")*\})?) ([-+0-9.einfNa]+))");
  std::map<std::string, double> samples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# HELP ") || line.starts_with("# TYPE ")) continue;
    std::smatch match;
    EXPECT_TRUE(std::regex_match(line, match, sample)) << line;
    EXPECT_TRUE(samples.emplace(match[1], std::stod(match[6])).second) << line;
  }
  return samples;
}

TEST(MetricsTest, CountsAnswersByRouteAndCode) {
  Metrics metrics;
  for (int i = 0; i < 3; ++i) count(metrics, "/tiles/a/0/0/0.png", 200);
  count(metrics, "/tiles/a/0/0/1.png", 404);
  count(metrics, "/wp-login.php", 404);
  count(metrics, "", 400);
  count(metrics, "/ready", 299);
  const auto samples = samples_of(metrics.text({}));
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="200",route="tiles"})"), 3);
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="404",route="tiles"})"), 1);
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="404",route="other"})"), 1);
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="400",route="other"})"), 1);
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="other",route="ready"})"), 1);
}

TEST(MetricsTest, HistogramsAreCumulativeInSeconds) {
  Metrics metrics;
  for (const double seconds : {0.00005, 0.003, 0.003, 0.7, 99.0}) {
    count(metrics, "/tiles/a/0/0/0.png", 200, seconds);
  }
  const auto samples = samples_of(metrics.text({}));
  const auto bucket = [&samples](const std::string& le) {
    return samples.at(R"(trapeze_request_seconds_bucket{route="tiles",le=")" + le + "\"}");
  };
  EXPECT_EQ(bucket("0.0001"), 1);
  EXPECT_EQ(bucket("0.0025"), 1);
  EXPECT_EQ(bucket("0.005"), 3);
  EXPECT_EQ(bucket("1"), 4);
  EXPECT_EQ(bucket("+Inf"), 5);
  EXPECT_EQ(samples.at(R"(trapeze_request_seconds_count{route="tiles"})"), 5);
  EXPECT_NEAR(samples.at(R"(trapeze_request_seconds_sum{route="tiles"})"), 99.70605, 1e-9);
}

TEST(MetricsTest, TilesAreCountedByOutcomeAndTimedByStage) {
  Metrics metrics;
  TileAnswer drawn{TileOutcome::drawn, {}};
  drawn.tile.times.encode_ms = 4;
  metrics.count(drawn);
  metrics.count(TileAnswer{TileOutcome::late, {}});
  TileAnswer colourful{TileOutcome::drawn, {}};
  colourful.tile.has_palette = false;
  metrics.count(colourful);
  const auto samples = samples_of(metrics.text({}));
  EXPECT_EQ(samples.at(R"(trapeze_tiles_total{outcome="drawn"})"), 2);
  EXPECT_EQ(samples.at("trapeze_tiles_in_full_colour_total"), 1);
  EXPECT_EQ(samples.at(R"(trapeze_tiles_total{outcome="late"})"), 1);
  EXPECT_EQ(samples.at(R"(trapeze_tiles_total{outcome="saturated"})"), 0);
  EXPECT_EQ(samples.at(R"(trapeze_tile_stage_seconds_count{stage="encode"})"), 2);
  EXPECT_DOUBLE_EQ(samples.at(R"(trapeze_tile_stage_seconds_sum{stage="encode"})"), 0.004);
  EXPECT_EQ(samples.at(R"(trapeze_tile_stage_seconds_count{stage="queue"})"), 2);
}

TEST(MetricsTest, TellsTheStateOfTheParts) {
  Metrics metrics;
  EXPECT_EQ(samples_of(metrics.text({})).at("trapeze_ready"), 0);
  metrics.count_load(true);
  metrics.count_load(false);
  ServerFigures figures;
  figures.data = testing::sample_dataset();
  figures.cache = {1000, 3, 17, 5};
  figures.cache_budget = 4096;
  figures.tiles = {4, 2};
  figures.queue_limit = 256;
  figures.connections = 9;
  figures.refused_connections = 1;
  figures.renderer = "soft\"ware\n";
  const std::string text = metrics.text(figures);
  const auto samples = samples_of(text);
  EXPECT_EQ(samples.at("trapeze_ready"), 1);
  EXPECT_EQ(samples.at("trapeze_cache_hits_total"), 17);
  EXPECT_EQ(samples.at("trapeze_cache_misses_total"), 5);
  EXPECT_EQ(samples.at("trapeze_cache_bytes"), 1000);
  EXPECT_EQ(samples.at("trapeze_queue_length"), 4);
  EXPECT_EQ(samples.at("trapeze_tiles_in_flight"), 2);
  EXPECT_EQ(samples.at("trapeze_connections"), 9);
  EXPECT_EQ(samples.at(R"(trapeze_layer_vertices{layer="rings"})"), 12);
  EXPECT_GT(samples.at(R"(trapeze_layer_bytes{layer="west"})"), 0);
  EXPECT_EQ(samples.at("trapeze_data_info{generation=\"" + figures.data->generation() + "\"}"), 1);
  EXPECT_EQ(samples.at(R"(trapeze_data_loads_total{result="failed"})"), 1);
  EXPECT_EQ(samples.at("trapeze_data_load_failed"), 1);
  EXPECT_GT(samples.at("trapeze_data_loaded_timestamp_seconds"), 1.6e9);
  EXPECT_GT(samples.at("process_resident_memory_bytes"), 1e6);
  EXPECT_GE(samples.at("process_resident_memory_peak_bytes"),
            samples.at("process_resident_memory_bytes"));
  EXPECT_GT(samples.at("process_open_fds"), 2);
  EXPECT_GT(samples.at("process_start_time_seconds"), 1.6e9);
  EXPECT_THAT(text, HasSubstr(R"(renderer="soft\"ware\n")"));
}

TEST(MetricsTest, TheDashboardAsksForNothingElse) {
  Metrics metrics;
  count(metrics, "/tiles/a/0/0/0.png", 200);
  ServerFigures figures;
  figures.data = testing::sample_dataset();
  const std::string text = metrics.text(figures);
  std::ifstream file(TRAPEZE_CONFIG_FOLDER "/../docker/grafana/trapeze.json");
  const std::string dashboard{std::istreambuf_iterator<char>(file), {}};
  const std::regex name(R"(\b(trapeze|process)_[a-z_]+(?=\{|, ))");
  int names = 0;
  for (std::sregex_iterator found(dashboard.begin(), dashboard.end(), name), end; found != end;
       ++found, ++names) {
    EXPECT_THAT(text, HasSubstr("\n" + found->str())) << "no such metric";
  }
  EXPECT_GT(names, 30);
}

TEST(MetricsTest, CountsFromManyThreads) {
  Metrics metrics;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&metrics] {
      for (int k = 0; k < 500; ++k) {
        count(metrics, "/tiles/a/0/0/0.png", k % 2 == 0 ? 200 : 304);
        if (k % 100 == 0) {
          EXPECT_THAT(metrics.text({}), HasSubstr("trapeze_requests_total"));
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto samples = samples_of(metrics.text({}));
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="200",route="tiles"})"), 1000);
  EXPECT_EQ(samples.at(R"(trapeze_requests_total{code="304",route="tiles"})"), 1000);
  EXPECT_EQ(samples.at(R"(trapeze_request_seconds_count{route="tiles"})"), 2000);
}

}  // namespace
}  // namespace trapeze
