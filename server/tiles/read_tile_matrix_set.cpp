#include "server/tiles/read_tile_matrix_set.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "server/base/limits.h"

namespace trapeze {
namespace {

using Object = nlohmann::json;

constexpr std::size_t kMostMatrices = 100;
constexpr int kMostTilePixels = 4096;
constexpr double kMostTiles = 4e9;
constexpr std::size_t kMostBytes = std::size_t{4} << 20;
constexpr double kMostUnfit = 0.01;  // relative deviation allowed between scale and cell size

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what);
}

/// The member with the first of the names that is present; null if none is.
const Object* find(const Object& object, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const auto found = object.find(name);
    if (found != object.end()) return &*found;
  }
  return nullptr;
}

const Object& get(const Object& object, std::initializer_list<const char*> names,
                  const std::string& where) {
  const Object* found = find(object, names);
  if (found == nullptr) fail(fmt::format("{} has no {}", where, *names.begin()));
  return *found;
}

std::string text_in(const Object& object, std::initializer_list<const char*> names,
                    const std::string& where) {
  const Object& found = get(object, names, where);
  if (!found.is_string() || found.get<std::string>().empty()) {
    fail(fmt::format("{}: {} is no text", where, *names.begin()));
  }
  return found.get<std::string>();
}

std::string text_or_nothing(const Object& object, const char* name) {
  const Object* found = find(object, {name});
  return found != nullptr && found->is_string() ? found->get<std::string>() : std::string();
}

double number_in(const Object& object, const char* name, double least, double most,
                 const std::string& where) {
  const Object& found = get(object, {name}, where);
  const double number = found.is_number() ? found.get<double>() : std::nan("");
  if (!(number >= least && number <= most)) {  // also rejects NaN
    fail(fmt::format("{}: {} is no number from {} to {}", where, name, least, most));
  }
  return number;
}

int whole_in(const Object& object, const char* name, double most, const std::string& where) {
  const double number = number_in(object, name, 1, most, where);
  if (number != std::floor(number)) fail(fmt::format("{}: {} is no whole number", where, name));
  return static_cast<int>(number);
}

/// Accepts the URI, the URN or the name of a system: "EPSG:2056".
MapSystemPtr system_of(const std::string& text) {
  for (const MapSystemPtr& system : usual_map_systems()) {
    if (system->is_called(text)) return system;
  }
  std::vector<std::string> parts;
  std::string part;
  for (const char c : text + "/") {
    if (c != '/' && c != ':') {
      part += c;
    } else if (!part.empty()) {
      parts.push_back(std::exchange(part, {}));
    }
  }
  const bool is_uri = text.starts_with("http") || text.starts_with("urn:");
  // ".../def/crs/EPSG/0/2056" and "urn:ogc:def:crs:EPSG::2056".
  const auto crs = std::ranges::find(parts, "crs");
  const bool has_authority = !is_uri || (crs != parts.end() && crs + 1 != parts.end());
  if (parts.size() < 2 || !has_authority) fail(fmt::format("crs \"{}\" is not understood", text));
  return map_system_of_grid(fmt::format("{}:{}", is_uri ? *(crs + 1) : parts[0], parts.back()));
}

std::string crs_in(const Object& object) {
  const Object& crs = get(object, {"crs", "supportedCRS"}, "the tile matrix set");
  if (crs.is_string()) return crs.get<std::string>();
  if (crs.is_object() && crs.contains("uri") && crs["uri"].is_string()) {
    return crs["uri"].get<std::string>();
  }
  fail("crs is neither a URI nor has one: systems are known by name only");
}

/// In the axis order of the authority.
void read_origin(const Object& object, const MapSystem& system, const std::string& where,
                 TileMatrix& matrix) {
  const Object& origin = get(object, {"pointOfOrigin", "topLeftCorner"}, where);
  const bool is_pair =
      origin.is_array() && origin.size() == 2 && origin[0].is_number() && origin[1].is_number();
  if (!is_pair) fail(where + ": pointOfOrigin is no pair of numbers");
  matrix.west = origin[system.is_north_first ? 1 : 0].get<double>();
  matrix.origin_y = origin[system.is_north_first ? 0 : 1].get<double>();
  const std::string corner = text_or_nothing(object, "cornerOfOrigin");
  if (!corner.empty() && corner != "topLeft" && corner != "bottomLeft") {
    fail(where + ": cornerOfOrigin is topLeft or bottomLeft");
  }
  matrix.is_from_south = corner == "bottomLeft";
}

void read_scale(const Object& object, const MapSystem& system, const std::string& where,
                TileMatrix& matrix) {
  constexpr double kMost = 1e12;
  matrix.scale_denominator = number_in(object, "scaleDenominator", 1e-3, kMost, where);
  const double fit = matrix.scale_denominator * kMetresPerPixel / system.metres_per_unit;
  matrix.cell_size =
      object.contains("cellSize") ? number_in(object, "cellSize", 1e-12, kMost, where) : fit;
  if (std::abs(matrix.cell_size - fit) > kMostUnfit * fit) {
    fail(fmt::format("{}: cellSize {} does not fit scaleDenominator {}, of which it would be {}",
                     where, matrix.cell_size, matrix.scale_denominator, fit));
  }
}

TileMatrix read_matrix(const Object& object, const MapSystem& system, std::size_t number) {
  if (!object.is_object()) fail(fmt::format("tile matrix {} is no object", number));
  TileMatrix matrix;
  matrix.id = text_in(object, {"id", "identifier"}, fmt::format("tile matrix {}", number));
  const std::string where = fmt::format("tile matrix \"{}\"", matrix.id);
  if (matrix.id.find_first_of("/@?# ") != std::string::npos || matrix.id.size() > 64) {
    fail(where + ": its id cannot stand in an address");
  }
  const Object* widths = find(object, {"variableMatrixWidths"});
  if (widths != nullptr && !widths->empty()) {
    fail(where + " has variableMatrixWidths: rows whose tiles are joined are not served");
  }
  read_scale(object, system, where, matrix);
  read_origin(object, system, where, matrix);
  matrix.tile_width = whole_in(object, "tileWidth", kMostTilePixels, where);
  matrix.tile_height = whole_in(object, "tileHeight", kMostTilePixels, where);
  matrix.width = static_cast<std::uint32_t>(number_in(object, "matrixWidth", 1, kMostTiles, where));
  matrix.height =
      static_cast<std::uint32_t>(number_in(object, "matrixHeight", 1, kMostTiles, where));
  return matrix;
}

}  // namespace

TileMatrixSetPtr parse_tile_matrix_set(std::string_view json) {
  const Object object = Object::parse(json, nullptr, false);
  if (object.is_discarded() || !object.is_object()) fail("is no JSON object");
  TileMatrixSet set;
  set.id = text_in(object, {"id", "identifier"}, "the tile matrix set");
  if (!is_url_name(set.id)) {
    fail(fmt::format("id \"{}\" is not 1 to 64 letters, digits, '_' or '-'", set.id));
  }
  set.title = text_or_nothing(object, "title");
  if (set.title.empty()) set.title = set.id;
  set.uri = text_or_nothing(object, "uri");
  set.scale_set = text_or_nothing(object, "wellKnownScaleSet");
  set.system = system_of(crs_in(object));
  const Object& matrices = get(object, {"tileMatrices", "tileMatrix"}, "the tile matrix set");
  if (!matrices.is_array() || matrices.empty() || matrices.size() > kMostMatrices) {
    fail(fmt::format("tileMatrices is no list of 1 to {} matrices", kMostMatrices));
  }
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    TileMatrix matrix = read_matrix(matrices[i], *set.system, i);
    if (set.find(matrix.id) != nullptr)
      fail(fmt::format("two tile matrices are \"{}\"", matrix.id));
    set.matrices.push_back(std::move(matrix));
  }
  return std::make_shared<const TileMatrixSet>(std::move(set));
}

TileMatrixSetPtr read_tile_matrix_set(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string json;
  for (std::istreambuf_iterator<char> c(file), end; c != end && json.size() <= kMostBytes; ++c) {
    json += *c;
  }
  if (!file.is_open() || file.bad()) fail(path + ": cannot be read");
  if (json.size() > kMostBytes) fail(path + ": is larger than a tile matrix set can be");
  try {
    return parse_tile_matrix_set(json);
  } catch (const std::exception& error) {
    fail(fmt::format("{}: {}", path, error.what()));
  }
}

TileMatrixSets tile_matrix_sets_with(const std::vector<std::string>& files) {
  TileMatrixSets sets = TileMatrixSets::built_in();
  for (const std::string& file : files) {
    try {
      sets.add(read_tile_matrix_set(file));
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      fail(what.starts_with(file) ? what : fmt::format("{}: {}", file, what));
    }
  }
  return sets;
}

}  // namespace trapeze
