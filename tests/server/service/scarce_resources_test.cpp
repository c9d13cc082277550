// The behaviour of a server that cannot allocate memory or start threads.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <system_error>
#include <thread>

#include "render/make_renderer.h"
#include "server/config/load_config.h"
#include "server/http/http_server.h"
#include "server/service/reloader.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/service/scarcity.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using testing::fixture;
using ::testing::HasSubstr;
using testing::Scarcity;

/// A round island with `vertices` vertices.
void write_island(const std::string& path, int vertices) {
  std::ofstream file(path);
  file << R"({"type": "Polygon", "coordinates": [[)";
  for (int i = 0; i <= vertices; ++i) {
    const double angle = 2 * std::numbers::pi * (i % vertices) / vertices;
    file << (i == 0 ? "[" : ",[") << 20 * std::cos(angle) << ',' << 20 * std::sin(angle) << ']';
  }
  file << "]]}";
}

class ScarceResourcesTest : public ::testing::Test {
 protected:
  ScarceResourcesTest() {
    reloader_.start();
    EXPECT_TRUE(has_loaded([this] { return data_.get() != nullptr; }));
  }

  static std::string copy_of_map(const std::string& path) {
    std::filesystem::copy_file(fixture("rings.geojson"), path);
    return path;
  }

  template <typename Holds>
  bool has_loaded(const Holds& holds) const {
    for (int i = 0; i < 6000 && !(holds() && !reloader_.is_loading()); ++i) {
      std::this_thread::sleep_for(5ms);
    }
    return holds() && !reloader_.is_loading();
  }

  /// Reads the layer again while only `count` allocations or threads are available, and expects
  /// that the old layer stays if that fails. Returns whether it failed.
  bool fails_with(Scarcity::Of what, int count, const std::string& words) {
    const auto before = data_.get();
    {
      const Scarcity scarcity(what, count);
      reloader_.reload();
      EXPECT_TRUE(
          has_loaded([&] { return data_.get() != before || !reloader_.last_problem().empty(); }));
    }
    if (data_.get() != before) return false;
    EXPECT_THAT(reloader_.last_problem(), HasSubstr(words)) << count;
    return true;
  }

  /// Allows more and more of them until the layer is read.
  void expect_to_fail_well(Scarcity::Of what, const std::string& words) {
    const std::uint64_t old = data_.get()->layers()[0].revision;
    write_island(file_, 30'000);
    int failures = 0;
    for (int count = 0; fails_with(what, count, words); count += 1 + count / 4) {
      ++failures;
      ASSERT_EQ(data_.get()->layers()[0].revision, old);
      ASSERT_TRUE(cleared_problem()) << "or the next one could not be told from it";
    }
    EXPECT_GT(failures, 1);
    EXPECT_NE(data_.get()->layers()[0].revision, old);
  }

  /// Reads the old map as if nothing had happened.
  bool cleared_problem() {
    const std::string island = folder_.file("island");
    std::filesystem::rename(file_, island);
    copy_of_map(file_);
    const auto before = data_.get();
    reloader_.reload();
    const bool is_read =
        has_loaded([&] { return data_.get() != before && reloader_.last_problem().empty(); });
    std::filesystem::rename(island, file_);
    return is_read;
  }

  const TemporaryFolder folder_;
  const std::string file_ = copy_of_map(folder_.file("map.geojson"));  // copied before it is read
  CurrentDataset data_;
  Metrics metrics_;
  TileService tiles_{{}, make_renderers({RendererKind::software, {}}, 1).renderers};
  Reloader reloader_{{[this] { return layers_of_files({file_}); }, ""},
                     {0ms},
                     data_,
                     tiles_,
                     metrics_,
                     nullptr,
                     [] { FAIL(); },
                     [] {}};
};

TEST_F(ScarceResourcesTest, WithoutMemoryToReadAgainTheOldLayersAreServed) {
  expect_to_fail_well(Scarcity::Of::large_arrays, "there is not enough memory");
}

TEST_F(ScarceResourcesTest, WithoutThreadsToReadAgainTheOldLayersAreServed) {
  expect_to_fail_well(Scarcity::Of::threads, "no more threads can be started");
}

TEST(ScarceThreadsTest, AServerThatCannotStartItsThreadsSaysSo) {
  HttpServerOptions options;
  options.address = "127.0.0.1";
  options.port = 0;
  options.threads = 4;
  for (const int count : {0, 2}) {
    HttpServer server(options, [](const HttpRequest&, const Respond&) {});
    const Scarcity scarcity(Scarcity::Of::threads, count);
    EXPECT_THROW(server.run(), std::system_error);
  }
}

TEST(ScarceThreadsTest, WorkersThatCannotAllBeStartedEndInOrder) {
  for (const int count : {0, 2}) {
    auto renderers = make_renderers({RendererKind::software, {}}, 4).renderers;
    const Scarcity scarcity(Scarcity::Of::threads, count);
    EXPECT_THROW(TileService({}, std::move(renderers)), std::system_error);
  }
}

}  // namespace
}  // namespace trapeze
