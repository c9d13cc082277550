#include "core/io/source/open_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <cpl_conv.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kGeoJson = TRAPEZE_FIXTURES "/mixed.geojson";

class OpenSourceTest : public ::testing::Test {
 protected:
  // The message of the refusal; nothing may be written to standard error.
  std::string refusal(const std::string& path) {
    testing::internal::CaptureStderr();
    std::string words = "was opened";
    try {
      open_source(path);
    } catch (const std::runtime_error& error) {
      words = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    return words;
  }

  TemporaryFolder folder_;
};

TEST_F(OpenSourceTest, OpensAnAllowedFormat) {
  EXPECT_STREQ(open_source(kGeoJson)->GetDriverName(), "GeoJSON");
}

TEST_F(OpenSourceTest, SaysThatAFileIsMissing) {
  const std::string path = folder_.file("missing.fgb");
  EXPECT_EQ(refusal(path), path + ": no such file");
  EXPECT_THAT(refusal("/vsizip/" + path), HasSubstr("no such file"));
  EXPECT_THAT(refusal(""), HasSubstr("no such file"));
}

TEST_F(OpenSourceTest, SaysHowWhatIsUnderAnAddressIsNamed) {
  EXPECT_EQ(refusal("http://localhost:9/a.geojson"),
            "http://localhost:9/a.geojson: is an address and no file; "
            "/vsicurl/http://localhost:9/a.geojson reads what is there");
  EXPECT_THAT(
      refusal("https://me:secret@localhost/a.fgb"),
      AllOf(HasSubstr("/vsicurl/https://me:***@localhost/a.fgb"), Not(HasSubstr("secret"))));
  EXPECT_THAT(refusal("s3://maps/a.fgb"), HasSubstr("; /vsis3/maps/a.fgb reads"));
  EXPECT_THAT(refusal("gs://maps/a.fgb"), HasSubstr("; /vsigs/maps/a.fgb reads"));
}

TEST_F(OpenSourceTest, SaysThatAFileIsAFolder) {
  const std::string path = folder_.file("folder");
  std::filesystem::create_directory(path);
  EXPECT_THAT(refusal(path), AllOf(StartsWith(path), HasSubstr("is a folder")));
}

TEST_F(OpenSourceTest, SaysThatAFileIsAPipeAndDoesNotWaitForIt) {
  const std::string path = folder_.file("pipe.geojson");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_EQ(refusal(path), path + ": is a pipe; name a file");
}

TEST_F(OpenSourceTest, DoesNotReadTheFilesOfAFolderThatNobodyNamed) {
  const std::string path = folder_.file("shapes");
  std::filesystem::create_directory(path);
  write_source(path + "/a.shp", "ESRI Shapefile", {{.features = {{"POLYGON((0 0,1 0,1 1,0 0))"}}}});
  EXPECT_THAT(refusal(path), HasSubstr("is a folder"));
}

TEST_F(OpenSourceTest, SaysThatAFileCannotBeRead) {
  const std::string path = folder_.file("loop.fgb");
  std::filesystem::create_symlink(path, path);
  EXPECT_THAT(refusal(path),
              AllOf(StartsWith(path), HasSubstr("cannot be read"), HasSubstr("symbolic links")));
}

TEST_F(OpenSourceTest, SaysThatAFileIsEmpty) {
  const std::string path = folder_.write("empty.geojson", "");
  EXPECT_EQ(refusal(path), path + ": is empty");
}

TEST_F(OpenSourceTest, SaysThatAFileHoldsNoVectorData) {
  const std::string path = folder_.write("notes.txt", "this is no map\n");
  EXPECT_THAT(refusal(path), AllOf(StartsWith(path), HasSubstr("no vector data")));
}

TEST_F(OpenSourceTest, SaysThatAFileIsBroken) {
  const std::string path =
      folder_.write("broken.geojson", "{\"type\": \"FeatureCollection\", \"fea");
  EXPECT_THAT(refusal(path), AllOf(StartsWith(path), HasSubstr("broken (GeoJSON)")));
  const std::string flat = folder_.write("broken.fgb", std::string("fgb\3fgb\0", 8) + "nothing");
  EXPECT_THAT(refusal(flat), AllOf(StartsWith(flat), HasSubstr("broken (FlatGeobuf)")));
}

TEST_F(OpenSourceTest, RefusesVrtThatPointsElsewhere) {
  const std::string path =
      folder_.write("view.vrt", "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>" +
                                    kGeoJson + "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
  EXPECT_THAT(refusal(path), AllOf(StartsWith(path), HasSubstr("OGR_VRT"), HasSubstr("not allowed"),
                                   HasSubstr("FlatGeobuf")));
  std::filesystem::rename(path, folder_.file("view.geojson"));
  EXPECT_THAT(refusal(folder_.file("view.geojson")), HasSubstr("not allowed"));
  EXPECT_THAT(refusal("<OGRVRTDataSource></OGRVRTDataSource>"), HasSubstr("no such file"));
}

TEST_F(OpenSourceTest, RefusesFormatsThatAreNotOnTheList) {
  const std::string path = folder_.write("points.csv", "a,WKT\n1,\"POLYGON((0 0,1 0,1 1,0 0))\"\n");
  EXPECT_THAT(refusal(path),
              AllOf(HasSubstr("CSV"), HasSubstr("not allowed"), HasSubstr("`ogr2ogr copy.gpkg`")));
}

TEST_F(OpenSourceTest, OpensNoConnectionThatAFileAsksFor) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 8), 0);
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  const std::string url = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/crs";
  const std::string path = folder_.write(
      "link.geojson",
      R"({"type":"FeatureCollection","crs":{"type":"link","properties":{"href":")" + url +
          R"(","type":"ogcwkt"}},"features":[{"type":"Feature","properties":{},"geometry":)"
          R"({"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}}]})");
  refusal(path);
  pollfd waiting{listener, POLLIN, 0};
  EXPECT_EQ(poll(&waiting, 1, 100), 0) << "somebody connects";
  close(listener);
}

TEST_F(OpenSourceTest, LeavesNothingBesideAGmlFile) {
  const std::string path = folder_.file("a.gml");
  write_source(path, "GML", {{.features = {{"POLYGON((0 0,1 0,1 1,0 0))"}}}});
  std::filesystem::remove(folder_.file("a.xsd"));
  EXPECT_EQ(open_source(path)->GetLayerCount(), 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("a.gfs")));
}

TEST_F(OpenSourceTest, PassesOnWhyADatabaseCannotBeReached) {
  EXPECT_THAT(refusal("PG:host=127.0.0.1 port=1 dbname=none"),
              AllOf(StartsWith("PG:host"), HasSubstr("cannot be opened: ")));
}

TEST(ReadingSettingsTest, LastAsLongAsTheyLive) {
  {
    const ReadingSettings settings;
    EXPECT_STREQ(CPLGetConfigOption("OGR_ORGANIZE_POLYGONS", ""), "SKIP");
  }
  EXPECT_STREQ(CPLGetConfigOption("OGR_ORGANIZE_POLYGONS", ""), "");
}

}  // namespace
}  // namespace trapeze
