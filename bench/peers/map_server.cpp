#include "bench/peers/map_server.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "bench/measure/http_load.h"
#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

constexpr int kTileSide = 256;

std::string write_lighttpd_config(const std::string& folder, std::uint16_t port) {
  const std::string mapserver_config = folder + "/mapserver.conf";
  std::ofstream(mapserver_config) << "CONFIG\n  ENV\n    MS_MAP_PATTERN \".\"\n  END\nEND\n";
  const std::string path = folder + "/lighttpd.conf";
  std::ofstream file(path);
  file << "server.document-root = \"" << folder << "\"\n"
       << "server.bind = \"127.0.0.1\"\n"
       << "server.port = " << port << "\n"
       << "server.modules = (\"mod_fastcgi\")\n"
       << "server.max-keep-alive-requests = 65000\n"
       << "server.max-keep-alive-idle = 600\n"
       << "fastcgi.server = (\"/\" => ((\n"
       << "  \"socket\" => \"" << folder << "/mapserv.socket\",\n"
       << "  \"bin-path\" => \"/usr/bin/mapserv\",\n"
       << "  \"max-procs\" => " << std::thread::hardware_concurrency() << ",\n"
       << "  \"check-local\" => \"disable\",\n"
       << "  \"kill-signal\" => 9,\n"  // mapserv ignores any other signal while it waits
       << "  \"bin-environment\" => (\"MAPSERVER_CONFIG_FILE\" => \"" << mapserver_config
       << "\")\n)))\n";
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
  return path;
}

/// MapServer measures extents from the centre of the first pixel to that of the last.
std::string extent_of(const TileId& tile) {
  const double side = std::ldexp(2 * kMercatorHalfSide, -tile.z);
  const double half_pixel = side / kTileSide / 2;
  const double left = -kMercatorHalfSide + tile.x * side;
  const double top = kMercatorHalfSide - tile.y * side;
  char text[160];
  std::snprintf(text, sizeof text, "%.9f+%.9f+%.9f+%.9f", left + half_pixel,
                top - side + half_pixel, left + side - half_pixel, top - half_pixel);
  return text;
}

}  // namespace

MapServer::MapServer(const std::string& map_file)
    : map_file_(map_file),
      port_(free_port()),
      process_({"lighttpd", "-D", "-f", write_lighttpd_config(folder_.path(), port_)},
               folder_.path() + "/log") {
  await_answer();
}

void MapServer::await_answer() {
  const TileId in_the_corner_of_the_world{18, 0, 0};  // where there is nothing to draw
  const auto request = requests({"", {}, {in_the_corner_of_the_world}});
  for (int tries = 0; tries < 1000 && process_.is_running(); ++tries) {
    try {
      if (load_http(port_, request, {.connections = 1}).exchanges.front().is_png) return;
    } catch (const std::exception&) {  // not listening yet
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::ifstream text(folder_.path() + "/log");
  throw std::runtime_error("MapServer draws nothing:\n" +
                           std::string(std::istreambuf_iterator<char>(text), {}));
}

std::vector<std::string> MapServer::requests(const Trip& trip) const {
  std::vector<std::string> requests;
  for (const TileId& tile : trip.tiles) {
    requests.push_back(
        http_request("/?map=" + map_file_ + "&mode=map&mapsize=256+256&mapext=" + extent_of(tile)));
  }
  return requests;
}

}  // namespace trapeze
