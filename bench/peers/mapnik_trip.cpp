// Draws tiles with Mapnik in this process, as fast as possible: one thread per core, each with its
// own map; every tile is drawn and encoded from scratch.
//
//   mapnik_trip MAP TILES RESULT [THREADS [FORMAT [PICTURES]]]
//
// MAP is a Mapnik map in XML, in metres of EPSG:3857; TILES has lines of z, x and y. RESULT gets
// the seconds of wall and of processor time, then the zoom and the milliseconds of every tile.
// FORMAT is a Mapnik format name, png8 by default. With PICTURES, a folder, every tile is also
// written there as z_x_y.png.
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <mapnik/agg_renderer.hpp>
#include <mapnik/datasource_cache.hpp>
#include <mapnik/image.hpp>
#include <mapnik/image_util.hpp>
#include <mapnik/load_map.hpp>
#include <mapnik/map.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned kTileSide = 256;
constexpr double kHalfWorld = 20037508.342789244;

struct Tile {
  int z = 0;
  double x = 0;
  double y = 0;
  double ms = 0;
  std::size_t bytes = 0;
};

struct Arguments {
  std::string map{};
  std::string tiles{};
  std::string result{};
  unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  std::string format = "png8";
  std::string pictures{};
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::vector<Tile> read_tiles(const std::string& path) {
  std::ifstream file(path);
  std::vector<Tile> tiles;
  for (Tile tile; file >> tile.z >> tile.x >> tile.y;) tiles.push_back(tile);
  if (tiles.empty()) throw std::runtime_error("there are no tiles in " + path);
  return tiles;
}

mapnik::box2d<double> extent_of(const Tile& tile) {
  const double side = std::ldexp(2 * kHalfWorld, -tile.z);
  const double left = -kHalfWorld + tile.x * side;
  const double top = kHalfWorld - tile.y * side;
  return {left, top - side, left + side, top};
}

std::string draw(mapnik::Map& map, const Tile& tile, const std::string& format) {
  map.zoom_to_box(extent_of(tile));
  mapnik::image_rgba8 image(kTileSide, kTileSide);
  mapnik::agg_renderer<mapnik::image_rgba8> renderer(map, image);
  renderer.apply();
  return mapnik::save_to_string(image, format);
}

void keep(const Tile& tile, const std::string& png, const std::string& folder) {
  const std::string name = std::to_string(tile.z) + "_" +
                           std::to_string(static_cast<long>(tile.x)) + "_" +
                           std::to_string(static_cast<long>(tile.y)) + ".png";
  std::ofstream(folder + "/" + name, std::ios::binary) << png;
}

void draw_all(const Arguments& arguments, std::vector<mapnik::Map>& maps,
              std::vector<Tile>& tiles) {
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (mapnik::Map& map : maps) {
    threads.emplace_back([&arguments, &map, &tiles, &next] {
      for (std::size_t i = next++; i < tiles.size(); i = next++) {
        const auto begin = Clock::now();
        const std::string png = draw(map, tiles[i], arguments.format);
        tiles[i].ms = 1000 * seconds_since(begin);
        tiles[i].bytes = png.size();
        if (!arguments.pictures.empty()) keep(tiles[i], png, arguments.pictures);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

void run(const Arguments& arguments) {
  mapnik::datasource_cache::instance().register_datasources(MAPNIK_PLUGINS);
  std::vector<Tile> tiles = read_tiles(arguments.tiles);
  std::vector<mapnik::Map> maps;
  for (unsigned i = 0; i < arguments.threads; ++i) {
    maps.emplace_back(static_cast<int>(kTileSide), static_cast<int>(kTileSide));
    mapnik::load_map(maps.back(), arguments.map);
    draw(maps.back(), tiles.front(), arguments.format);  // opens the files
  }
  const double cpu_before = cpu_seconds();
  const auto begin = Clock::now();
  draw_all(arguments, maps, tiles);
  const double seconds = seconds_since(begin);
  std::ofstream result(arguments.result);
  result << seconds << ' ' << cpu_seconds() - cpu_before << '\n';
  for (const Tile& tile : tiles) {
    result << tile.z << ' ' << tile.ms << ' ' << tile.bytes << '\n';
  }
  if (!result.flush()) throw std::runtime_error("cannot write " + arguments.result);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4 || argc > 7) {
    std::fprintf(stderr, "usage: mapnik_trip MAP TILES RESULT [THREADS [FORMAT [PICTURES]]]\n");
    return 2;
  }
  try {
    Arguments arguments{argv[1], argv[2], argv[3]};
    if (argc > 4) arguments.threads = static_cast<unsigned>(std::max(1, std::atoi(argv[4])));
    if (argc > 5) arguments.format = argv[5];
    if (argc > 6) arguments.pictures = argv[6];
    run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mapnik_trip: %s\n", error.what());
    return 1;
  }
}
