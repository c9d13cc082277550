// GDAL's clients for tile services read our tiles, pixel for pixel.
#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "render/picture/png.h"
#include "server/http/http_server.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

struct CommandResult {
  int status = 0;
  std::string output;
};

CommandResult run_command(const std::string& command) {
  CommandResult result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (const std::size_t size = fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.output.append(buffer.data(), size);
  }
  result.status = pclose(pipe);
  return result;
}

class GdalClientsTest : public ::testing::Test {
 protected:
  GdalClientsTest() {
    HttpServerOptions options;
    options.address = "127.0.0.1";
    options.port = 0;
    server_ = std::make_unique<HttpServer>(options, sample_.handler());
    thread_ = std::thread([this] { server_->run(); });
    url_ = "http://127.0.0.1:" + std::to_string(server_->port());
    folder_ = ::testing::TempDir() + "/gdal_clients_test_" + std::to_string(server_->port());
    std::filesystem::create_directories(folder_);
  }
  ~GdalClientsTest() override {
    server_->stop();
    thread_.join();
    std::filesystem::remove_all(folder_);
  }

  /// The world as gdal_translate reads it from a source: 256 << zoom pixels wide and high, 512 at
  /// zoom 1.
  Picture world(const std::string& source, const std::string& options = {}, int zoom = 1) {
    const std::string size = std::to_string(256 << zoom);
    const std::string file = folder_ + "/world.png";
    // No files from earlier runs, none left behind, and no proxy.
    const CommandResult translated = run_command(
        "cd " + folder_ + " && no_proxy=127.0.0.1 GDAL_DEFAULT_WMS_CACHE_PATH=" + folder_ +
        "/cache gdal_translate -q -of PNG -outsize " + size + " " + size + " " + options + " '" +
        source + "' " + file);
    EXPECT_EQ(translated.status, 0) << translated.output;
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream),
                            std::istreambuf_iterator<char>()};
    return decode_png(bytes);
  }

  /// The number of pixels that differ from the tiles of that zoom, put together.
  int differences(const Picture& world, const std::string& layer, int zoom = 1) {
    EXPECT_EQ(world.width, 256 << zoom);
    EXPECT_EQ(world.height, 256 << zoom);
    int count = 0;
    for (int row = 0; row < 1 << zoom; ++row) {
      for (int column = 0; column < 1 << zoom; ++column) {
        const auto response =
            sample_.get("/tiles/" + layer + "/" + std::to_string(zoom) + "/" +
                        std::to_string(column) + "/" + std::to_string(row) + ".png");
        const Picture tile = decode_png(*response.body);
        for (int y = 0; y < 256; ++y) {
          for (int x = 0; x < 256; ++x) {
            count += world.at(column * 256 + x, row * 256 + y) != tile.at(x, y);
          }
        }
      }
    }
    return count;
  }

  testing::SampleSite sample_;
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
  std::string url_;
  std::string folder_;
};

TEST_F(GdalClientsTest, TheXyzClientReadsOurTiles) {
  const std::string file = folder_ + "/tiles.xml";
  std::ofstream(file) << "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>" << url_
                      << "/tiles/rings/${z}/${x}/${y}.png</ServerUrl></Service><DataWindow>"
                         "<UpperLeftX>-20037508.342789244</UpperLeftX>"
                         "<UpperLeftY>20037508.342789244</UpperLeftY>"
                         "<LowerRightX>20037508.342789244</LowerRightX>"
                         "<LowerRightY>-20037508.342789244</LowerRightY>"
                         "<TileLevel>20</TileLevel><TileCountX>1</TileCountX>"
                         "<TileCountY>1</TileCountY><YOrigin>top</YOrigin></DataWindow>"
                         "<Projection>EPSG:3857</Projection><BlockSizeX>256</BlockSizeX>"
                         "<BlockSizeY>256</BlockSizeY><BandsCount>4</BandsCount></GDAL_WMS>";
  EXPECT_EQ(differences(world(file), "rings"), 0);
}

TEST_F(GdalClientsTest, TheWmtsClientReadsOurTiles) {
  const std::string options = "-oo ZOOM_LEVEL=1 -oo EXTENT_METHOD=MOST_PRECISE_TILE_MATRIX";
  EXPECT_EQ(differences(world("WMTS:" + url_ + "/wmts.xml,layer=rings", options), "rings"), 0);
  EXPECT_EQ(
      differences(
          world("WMTS:" + url_ + "/wmts?service=WMTS&request=GetCapabilities,layer=west", options),
          "west"),
      0);
}

// In degrees, for which version 1.3.0 puts the latitude first.
TEST_F(GdalClientsTest, TheWmsClientReadsOurMapsInDegrees) {
  for (const char* version : {"1.1.1", "1.3.0"}) {
    const std::string system = version == std::string("1.1.1") ? "SRS" : "CRS";
    const std::string order = version == std::string("1.1.1") ? "xyXY" : "yxYX";
    const std::string file = folder_ + "/degrees" + version + ".xml";
    std::ofstream(file) << "<GDAL_WMS><Service name=\"WMS\"><Version>" << version
                        << "</Version><ServerUrl>" << url_ << "/wms?</ServerUrl><" << system
                        << ">EPSG:4326</" << system << "><BBoxOrder>" << order
                        << "</BBoxOrder><ImageFormat>image/png</ImageFormat>"
                           "<Transparent>TRUE</Transparent>"
                           "<Layers>rings</Layers></Service><DataWindow>"
                           "<UpperLeftX>-180</UpperLeftX><UpperLeftY>90</UpperLeftY>"
                           "<LowerRightX>180</LowerRightX><LowerRightY>-90</LowerRightY>"
                           "<SizeX>512</SizeX><SizeY>512</SizeY></DataWindow>"
                           "<BlockSizeX>512</BlockSizeX><BlockSizeY>512</BlockSizeY>"
                           "<Projection>EPSG:4326</Projection><BandsCount>4</BandsCount>"
                           "</GDAL_WMS>";
    const Picture read = world(file);
    const Picture own = decode_png(
        *sample_.get("/map/rings.png?crs=CRS:84&bbox=-180,-90,180,90&width=512&height=512").body);
    ASSERT_EQ(read.width, own.width);
    int count = 0;
    for (int y = 0; y < 512; ++y) {
      for (int x = 0; x < 512; ++x) count += read.at(x, y) != own.at(x, y);
    }
    EXPECT_EQ(count, 0) << version;
  }
}

TEST_F(GdalClientsTest, TheWmsClientReadsOurMaps) {
  for (const char* version : {"1.1.1", "1.3.0"}) {
    const std::string system = version == std::string("1.1.1") ? "SRS" : "CRS";
    const std::string file = folder_ + "/wms" + version + ".xml";
    std::ofstream(file) << "<GDAL_WMS><Service name=\"WMS\"><Version>" << version
                        << "</Version><ServerUrl>" << url_ << "/wms?</ServerUrl><" << system
                        << ">EPSG:3857</" << system
                        << "><ImageFormat>image/png</ImageFormat><Transparent>TRUE</Transparent>"
                           "<Layers>rings</Layers></Service><DataWindow>"
                           "<UpperLeftX>-20037508.342789244</UpperLeftX>"
                           "<UpperLeftY>20037508.342789244</UpperLeftY>"
                           "<LowerRightX>20037508.342789244</LowerRightX>"
                           "<LowerRightY>-20037508.342789244</LowerRightY>"
                           "<SizeX>512</SizeX><SizeY>512</SizeY></DataWindow>"
                           "<BlockSizeX>256</BlockSizeX><BlockSizeY>256</BlockSizeY>"
                           "<Projection>EPSG:3857</Projection><BandsCount>4</BandsCount>"
                           "</GDAL_WMS>";
    EXPECT_EQ(differences(world(file), "rings"), 0) << version;
  }
  const CommandResult listed = run_command("no_proxy=127.0.0.1 gdalinfo 'WMS:" + url_ +
                                           "/wms?service=WMS&request=GetCapabilities'");
  EXPECT_EQ(listed.status, 0);
  EXPECT_THAT(listed.output, ::testing::HasSubstr("LAYERS=rings&SRS=EPSG:3857&BBOX=-10018754.1"));
}

TEST_F(GdalClientsTest, TheOgcApiClientReadsOurTiles) {
  // GDAL 3.6 reads the bounds of a collection as metres, so the options set the bounds of the
  // world.
  const std::string options =
      "-oo API=TILES -oo TILEMATRIXSET=WebMercatorQuad -oo MINX=-20037508.342789244 -oo "
      "MINY=-20037508.342789244 "
      "-oo MAXX=20037508.342789244 -oo MAXY=20037508.342789244";
  for (const int zoom : {1, 3}) {  // at 3, the layer has neither the first nor the last rows
    const Picture picture = world("OGCAPI:" + url_ + "/ogc/collections/rings", options, zoom);
    EXPECT_EQ(differences(picture, "rings", zoom), 0) << zoom;
  }
}

}  // namespace
}  // namespace trapeze
