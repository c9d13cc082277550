#include "bench/peers/peer_maps.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "bench/measure/child_process.h"

namespace trapeze {
namespace {

std::string shape_of(const TripLayer& layer, const std::string& folder) {
  return folder + "/" + layer.name + ".shp";
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

std::string suffix(Simplify simplify) {
  return simplify == Simplify::on ? "-simplify" : "";
}

std::string mapnik_layer(const TripLayer& layer, const std::string& folder, Simplify simplify) {
  const std::string more = simplify == Simplify::on ? " simplify=\"0.25\"" : "";
  return " <Style name=\"" + layer.name + "\"><Rule><PolygonSymbolizer fill=\"#" + layer.colour +
         "\"" + more + "/></Rule></Style>\n <Layer name=\"" + layer.name +
         "\" srs=\"epsg:3857\">\n  <StyleName>" + layer.name +
         "</StyleName>\n  <Datasource>\n   <Parameter name=\"type\">shape</Parameter>\n"
         "   <Parameter name=\"file\">" +
         shape_of(layer, folder) + "</Parameter>\n  </Datasource>\n </Layer>\n";
}

std::string mapserver_layer(const TripLayer& layer, const std::string& folder, Simplify simplify) {
  const std::string more =
      simplify == Simplify::on ? "    GEOMTRANSFORM (simplify([shape],[map_cellsize]*0.25))\n" : "";
  return "  LAYER\n    NAME \"" + layer.name +
         "\"\n    TYPE POLYGON\n    STATUS DEFAULT\n    DATA \"" + shape_of(layer, folder) +
         "\"\n" + more + "    CLASS STYLE COLOR \"#" + layer.colour + "\" END END\n  END\n";
}

constexpr const char* kMapServerHead = R"(MAP
  NAME "trip"
  SIZE 256 256
  UNITS METERS
  EXTENT -20037508.342789244 -20037508.342789244 20037508.342789244 20037508.342789244
  OUTPUTFORMAT
    NAME "png8"
    DRIVER AGG/PNG8
    MIMETYPE "image/png"
    EXTENSION "png"
    IMAGEMODE RGBA
    TRANSPARENT ON
  END
  IMAGETYPE "png8"
)";

}  // namespace

void write_shapes(const Trip& trip, const std::string& folder) {
  const std::string log = folder + "/shapes.log";
  for (const TripLayer& layer : trip.layers) {
    const std::string shape = shape_of(layer, folder);
    // Reversing rings takes minutes for a polygon with many, and no program here needs it.
    run_to_end({"ogr2ogr", "--config", "SHAPE_REWIND_ON_WRITE", "NO", "-f", "ESRI Shapefile",
                "-t_srs", "EPSG:3857", "-select", "", shape, layer.file},
               log);
    if (has_program("shapeindex")) run_to_end({"shapeindex", shape}, log);
    if (has_program("shptree")) run_to_end({"shptree", shape}, log);
  }
}

std::string write_mapnik_map(const Trip& trip, const std::string& folder, Simplify simplify) {
  std::string text = "<Map srs=\"epsg:3857\" buffer-size=\"0\">\n";
  for (const TripLayer& layer : trip.layers) text += mapnik_layer(layer, folder, simplify);
  const std::string path = folder + "/mapnik" + suffix(simplify) + ".xml";
  write_file(path, text + "</Map>\n");
  return path;
}

std::string write_mapserver_map(const Trip& trip, const std::string& folder, Simplify simplify) {
  std::string text = kMapServerHead;
  for (const TripLayer& layer : trip.layers) text += mapserver_layer(layer, folder, simplify);
  const std::string path = folder + "/mapserver" + suffix(simplify) + ".map";
  write_file(path, text + "END\n");
  return path;
}

std::string write_tiles(const Trip& trip, const std::string& folder) {
  std::string text;
  for (const TileId& tile : trip.tiles) {
    text +=
        std::to_string(tile.z) + ' ' + std::to_string(tile.x) + ' ' + std::to_string(tile.y) + '\n';
  }
  const std::string path = folder + "/" + trip.name + ".tiles";
  write_file(path, text);
  return path;
}

bool has_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/" + name).c_str(), X_OK) == 0) return true;
  }
  return false;
}

}  // namespace trapeze
