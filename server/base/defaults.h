// Defaults of settings that are also needed outside the configuration: parts of the server created
// without a configuration use the same values.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace trapeze::defaults {

constexpr std::string_view kAddress = "0.0.0.0";
constexpr std::uint16_t kPort = 8080;
constexpr unsigned kThreads = 2;  // for sockets
constexpr std::size_t kConnections = 1024;
constexpr std::size_t kConnectionsPerAddress = 256;
constexpr std::uint32_t kHeaderBytes = 8192;
// Enough for twice the largest style, with every parameter of 30 layers in full.
constexpr std::uint32_t kBodyBytes = 1024 * 1024;
constexpr std::chrono::milliseconds kIdleTimeout{30'000};
constexpr std::chrono::milliseconds kReadTimeout{10'000};
constexpr std::chrono::milliseconds kWriteTimeout{30'000};
constexpr std::chrono::milliseconds kDrainTimeout{10'000};

constexpr std::size_t kQueue = 256;  // tiles that may wait for a worker
// In units of drawing_cost(): 25 million are a second of a worker.
constexpr std::uint64_t kOrdinaryTile = 250'000;  // up to this, cost is not limited
constexpr std::uint64_t kDearTile = 500'000;      // above this, a tile uses the second queue
constexpr std::uint64_t kTileCost = 100'000'000;
constexpr double kCostPerSecond = 25'000'000;
constexpr double kCostBurst = 250'000'000;
constexpr std::uint64_t kMapPixels = 16'777'216;  // of the picture of a window
constexpr std::chrono::milliseconds kDeadline{10'000};
constexpr unsigned kBatch = 8;  // tiles

constexpr std::string_view kCacheControl = "public, max-age=3600";  // of tiles
constexpr unsigned kPostedStylesMegabytes = 64;
constexpr unsigned kPostedValuesMegabytes = 64;
constexpr std::uint32_t kValuesBytes = 8 * 1024 * 1024;  // of a posted table
constexpr std::size_t kValuesRows = 100'000;

}  // namespace trapeze::defaults
