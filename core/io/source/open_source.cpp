#include "core/io/source/open_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_http.h>
#include <cpl_vsi.h>

#include "core/io/file/prepared_file.h"
#include "core/io/source/gdal_messages.h"
#include "core/io/source/source_name.h"

namespace trapeze {
namespace {

// Drivers that read polygons from one named source and nothing else. VRT is excluded: such a file
// can name any other file, URL or database.
constexpr std::array kAllowedDrivers = {
    "FlatGeobuf", "GPKG", "GeoJSON", "GeoJSONSeq", "TopoJSON",    "ESRI Shapefile", "OSM",
    "GML",        "KML",  "LIBKML",  "SQLite",     "OpenFileGDB", "PostgreSQL",     "Parquet"};

CPLStringList allowed_drivers() {
  CPLStringList list;
  for (const char* name : kAllowedDrivers) list.AddString(name);
  return list;
}

std::string allowed_drivers_in_words() {
  std::string words;
  for (const char* name : kAllowedDrivers) {
    if (GDALGetDriverByName(name) == nullptr) continue;
    if (!words.empty()) words += ", ";
    words += name;
  }
  return words;
}

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> prefixes) {
  return std::ranges::any_of(prefixes,
                             [text](std::string_view prefix) { return text.starts_with(prefix); });
}

// Files in a cloud, whose service GDAL asks for credentials.
bool is_in_cloud(std::string_view path) {
  return starts_with_any(path, {"/vsis3", "/vsigs", "/vsiaz", "/vsiadls", "/vsioss", "/vsiswift"});
}

/// Whether a file in a cloud was opened.
std::atomic<bool>& may_ask_cloud() {
  static std::atomic<bool> may_ask = false;
  return may_ask;
}

/// Replaces GDAL's own downloads, such as that of the reference system to which a GeoJSON links.
CPLHTTPResult* refuse_download(const char* url, CSLConstList, GDALProgressFunc, void*,
                               CPLHTTPFetchWriteFunc, void*, void*) {
  if (may_ask_cloud()) return nullptr;  // let GDAL download it
  auto* result = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  result->nStatus = 1;
  result->pszErrBuf = CPLStrdup("nothing is fetched that a file refers to");
  CPLError(CE_Failure, CPLE_NotSupported, "refers to %s, which is not fetched", url);
  return result;
}

void register_drivers() {
  static std::once_flag once;
  std::call_once(once, [] {
    GDALAllRegister();
    // GDAL would take sizes and positions of the last .gz that it read for those of the file that
    // has replaced it, which then cannot be read, and would write a file beside each.
    CPLSetConfigOption("CPL_VSIL_GZIP_SAVE_INFO", "NO");
    CPLSetConfigOption("CPL_VSIL_GZIP_WRITE_PROPERTIES", "NO");
    CPLHTTPSetFetchCallback(refuse_download, nullptr);
  });
}

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(name_of_source(path) + ": " + what);
}

bool is_database_connection(std::string_view path) {
  return starts_with_any(path, {"PG:", "pg:", "PostgreSQL:", "postgresql://"});
}

bool is_in_archive_or_remote(std::string_view path) {
  return starts_with_any(path, {"/vsi"});
}

// A folder is a source only if it is a File Geodatabase. (Drivers that accept a folder as a set of
// layers would read files that nobody named.)
void check_folder(const std::string& path) {
  const char* const only_geodatabase[] = {"OpenFileGDB", nullptr};
  if (GDALIdentifyDriverEx(path.c_str(), GDAL_OF_VECTOR, only_geodatabase, nullptr) == nullptr) {
    fail(path, "is a folder; name a file in it");
  }
}

void check_contents(const std::string& path) {
  errno = 0;
  VSILFILE* file = VSIFOpenL(path.c_str(), "rb");
  if (file == nullptr) {
    fail(path, std::string("cannot be read: ") +
                   (errno != 0 ? std::strerror(errno) : "permission denied or broken"));
  }
  char byte = 0;
  const bool is_empty = VSIFReadL(&byte, 1, 1, file) == 0;
  VSIFCloseL(file);
  if (is_empty) fail(path, "is empty");
  if (is_prepared_file(path)) fail(path, "is a prepared layer; name its source");
}

/// The name in GDAL of a source given by URL; empty if the path is no URL.
std::string vsi_name_of(const std::string& path) {
  struct Scheme {
    std::string_view address;
    std::string_view prefix;  // replaces the scheme, or precedes the URL if that is kept
    bool is_kept;
  };
  static constexpr std::array<Scheme, 6> kSchemes = {{{"http://", "/vsicurl/", true},
                                                      {"https://", "/vsicurl/", true},
                                                      {"ftp://", "/vsicurl/", true},
                                                      {"s3://", "/vsis3/", false},
                                                      {"gs://", "/vsigs/", false},
                                                      {"az://", "/vsiaz/", false}}};
  for (const auto& [address, prefix, is_kept] : kSchemes) {
    if (!path.starts_with(address)) continue;
    return std::string(prefix) + path.substr(is_kept ? 0 : address.size());
  }
  return {};
}

// Distinguishes a name that does not exist from one that exists but cannot be accessed, such as a
// loop of links, or from which no data may ever arrive.
void check_exists(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::symlink_status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    const std::string name = vsi_name_of(path);
    if (name.empty()) fail(path, "no such file");
    fail(path, "is an address and no file; " + name_of_source(name) + " reads what is there");
  }
  if (error) fail(path, "cannot be read: " + error.message());
  if (std::filesystem::is_fifo(path, error)) fail(path, "is a pipe; name a file");
}

void check_readable(const std::string& path) {
  const bool is_local = !is_in_archive_or_remote(path);
  if (is_local) check_exists(path);
  VSIStatBufL status;
  const bool found = VSIStatL(path.c_str(), &status) == 0;
  if (found && VSI_ISDIR(status.st_mode)) {
    if (is_local) check_folder(path);
    return;
  }
  if (!found && !is_local) fail(path, "no such file");
  check_contents(path);
}

// Explains why an existing, readable file could not be opened with an allowed driver.
[[noreturn]] void explain_refusal(const std::string& path, const std::string& message) {
  GDALDriverH any =
      GDALIdentifyDriverEx(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_RASTER, nullptr, nullptr);
  if (any == nullptr) {
    fail(path, "contains no vector data in a supported format" +
                   (message.empty() ? "" : " (" + message + ")"));
  }
  const std::string name = GDALGetDriverShortName(any);
  if (std::ranges::find(kAllowedDrivers, name) != std::end(kAllowedDrivers)) {
    fail(path, "is broken (" + name + "): " + message);
  }
  fail(path, "is of the format " + name + ", which is not allowed; allowed are " +
                 allowed_drivers_in_words() + ": make a copy by `ogr2ogr copy.gpkg` and its name");
}

CPLStringList options_for(const std::string& path, const CPLStringList& drivers) {
  CPLStringList options;
  GDALDriverH driver = GDALIdentifyDriverEx(path.c_str(), GDAL_OF_VECTOR, drivers.List(), nullptr);
  // Reading must not leave a .gfs file beside the source.
  if (driver != nullptr && std::string_view(GDALGetDriverShortName(driver)) == "GML") {
    options.AddNameValue("WRITE_GFS", "NO");
  }
  return options;
}

}  // namespace

GDALDatasetUniquePtr open_source(const std::string& path, std::string* warning) {
  register_drivers();
  if (is_in_cloud(path)) may_ask_cloud() = true;
  GdalMessages messages;
  if (!is_database_connection(path)) check_readable(path);
  const CPLStringList drivers = allowed_drivers();
  const CPLStringList options = options_for(path, drivers);
  messages.clear();
  GDALDatasetUniquePtr dataset(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                        drivers.List(), options.List()));
  if (dataset == nullptr && is_database_connection(path)) {
    fail(path, "cannot be opened: " + messages.text());
  }
  if (dataset == nullptr) explain_refusal(path, std::string(messages.text()));
  if (warning != nullptr) *warning = messages.text();
  if (dataset->GetLayerCount() > 0) return dataset;
  if (!messages.has_failure()) fail(path, "has no layer of vector data");
  fail(path, std::string("is broken (") + dataset->GetDriverName() + "): " + messages.text());
}

bool has_clockwise_shells(const std::string& driver) {
  return driver == "ESRI Shapefile" || driver == "OpenFileGDB";
}

ReadingSettings::ReadingSettings() {
  CPLSetThreadLocalConfigOption("OGR_ORGANIZE_POLYGONS", "SKIP");
  CPLSetThreadLocalConfigOption("OGR_GEOJSON_MAX_OBJ_SIZE", "0");
  if (CPLGetConfigOption("CPL_TMPDIR", nullptr) == nullptr) {
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    if (!error) CPLSetThreadLocalConfigOption("CPL_TMPDIR", folder.c_str());
  }
}

ReadingSettings::~ReadingSettings() {
  CPLSetThreadLocalConfigOption("OGR_ORGANIZE_POLYGONS", nullptr);
  CPLSetThreadLocalConfigOption("OGR_GEOJSON_MAX_OBJ_SIZE", nullptr);
  CPLSetThreadLocalConfigOption("CPL_TMPDIR", nullptr);
}

}  // namespace trapeze
