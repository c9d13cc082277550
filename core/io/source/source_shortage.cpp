#include "core/io/source/source_shortage.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <ogrsf_frmts.h>

namespace trapeze {
namespace {

constexpr std::uint64_t kShapeHeader = 100;  // bytes before the first record of .shp and .shx
constexpr std::uint64_t kIndexRecord = 8;    // bytes of a record of .shx: offset and length in
                                             // words
constexpr std::uint64_t kRecordHeader = 8;   // bytes of a record of .shp that its length does not
                                             // include
constexpr std::size_t kIndexBlock = 8192;    // records of .shx read in one block

struct CloseFile {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// A file accessed through GDAL; it may lie in an archive.
class SourceFile {
 public:
  explicit SourceFile(const std::string& path) : file_(VSIFOpenL(path.c_str(), "rb")) {}

  bool is_open() const { return file_ != nullptr; }
  std::uint64_t size() {
    VSIFSeekL(file_.get(), 0, SEEK_END);
    return VSIFTellL(file_.get());
  }
  /// Reads as many of the bytes as exist.
  std::vector<std::uint8_t> read(std::uint64_t offset, std::size_t bytes) {
    std::vector<std::uint8_t> read(bytes);
    VSIFSeekL(file_.get(), offset, SEEK_SET);
    read.resize(VSIFReadL(read.data(), 1, bytes, file_.get()));
    return read;
  }

 private:
  std::unique_ptr<VSILFILE, CloseFile> file_;
};

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
         std::uint32_t{bytes[2]} << 8 | bytes[3];
}

std::uint32_t little_endian_16(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8;
}

std::uint32_t little_endian_32(const std::uint8_t* bytes) {
  return little_endian_16(bytes) | little_endian_16(bytes + 2) << 16;
}

std::string of_all(std::uint64_t part, std::uint64_t all, const std::string& what) {
  return std::to_string(part) + " of its " + std::to_string(all) + " " + what;
}

/// How many of the records listed in a .shx extend beyond so many bytes.
std::uint64_t records_beyond(SourceFile& index, std::uint64_t records, std::uint64_t size) {
  std::uint64_t beyond = 0;
  for (std::uint64_t first = 0; first < records; first += kIndexBlock) {
    const std::vector<std::uint8_t> block =
        index.read(kShapeHeader + first * kIndexRecord, kIndexBlock * kIndexRecord);
    for (std::size_t at = 0; at + kIndexRecord <= block.size(); at += kIndexRecord) {
      const std::uint64_t offset = std::uint64_t{big_endian(&block[at])} * 2;
      const std::uint64_t length = std::uint64_t{big_endian(&block[at + 4])} * 2;
      if (length > 0 && offset + kRecordHeader + length > size) ++beyond;
    }
  }
  return beyond;
}

/// The number of records of a .shx. The file is complete, or GDAL would not have opened it.
std::uint64_t records_of(SourceFile& index) {
  const std::vector<std::uint8_t> header = index.read(0, kShapeHeader);
  if (header.size() < kShapeHeader) return 0;
  const std::uint64_t bytes = std::uint64_t{big_endian(&header[24])} * 2;
  return bytes < kShapeHeader ? 0 : (bytes - kShapeHeader) / kIndexRecord;
}

struct TableSize {
  std::uint64_t rows = 0;
  std::uint64_t row_bytes = 0;
  std::uint64_t header_bytes = 0;

  /// The number of rows in a file of so many bytes.
  std::uint64_t rows_in(std::uint64_t bytes) const {
    if (bytes <= header_bytes || row_bytes == 0) return 0;
    return std::min((bytes - header_bytes) / row_bytes, rows);
  }
};

/// None if the file is too short to contain this.
std::optional<TableSize> size_of_table(SourceFile& table) {
  constexpr std::size_t kFixedHeader = 32;
  const std::vector<std::uint8_t> header = table.read(0, kFixedHeader);
  if (header.size() < kFixedHeader) return std::nullopt;
  return TableSize{little_endian_32(&header[4]), little_endian_16(&header[10]),
                   little_endian_16(&header[8])};
}

std::string shortage_of_table(const std::string& path, std::optional<std::uint64_t> shapes) {
  SourceFile table(path);
  if (!table.is_open()) return {};
  const std::uint64_t bytes = table.size();
  const auto size = size_of_table(table);
  if (!size || bytes < size->header_bytes) return "its .dbf is cut off within the header";
  if (const std::uint64_t there = size->rows_in(bytes); there < size->rows) {
    return "its .dbf is cut off: it holds " + of_all(there, size->rows, "rows");
  }
  if (shapes && *shapes != size->rows) {
    return "its files do not belong together: the .shx lists " + std::to_string(*shapes) +
           " shapes, the .dbf has " + std::to_string(size->rows) + " rows";
  }
  return {};
}

/// The file beside the shapes with that ending, in lower or upper case; empty if there is none.
/// GDAL does not list a file that it could not open.
std::string beside(const std::string& shapes, const std::array<const char*, 2>& endings) {
  for (const char* ending : endings) {
    std::string path = CPLResetExtension(shapes.c_str(), ending);
    VSIStatBufL status;
    if (VSIStatExL(path.c_str(), &status, VSI_STAT_EXISTS_FLAG) == 0) return path;
  }
  return {};
}

std::string shortage_of_shapefile(const std::string& path) {
  SourceFile shapes(path);
  SourceFile index(beside(path, {"shx", "SHX"}));
  std::optional<std::uint64_t> records;
  if (shapes.is_open() && index.is_open()) {
    records = records_of(index);
    const std::uint64_t beyond = records_beyond(index, *records, shapes.size());
    if (beyond > 0) {
      return "its .shp is cut off: it holds " + of_all(*records - beyond, *records, "shapes");
    }
  }
  const std::string table = beside(path, {"dbf", "DBF"});
  return table.empty() ? std::string() : shortage_of_table(table, records);
}

std::string shortage_of_shapefiles(GDALDataset& dataset) {
  const CPLStringList files(dataset.GetFileList());
  for (int i = 0; i < files.Count(); ++i) {
    if (!EQUAL(CPLGetExtension(files[i]), "shp")) continue;
    std::string shortage = shortage_of_shapefile(files[i]);
    if (!shortage.empty()) return shortage;
  }
  return {};
}

/// SQLite reads the missing part of its last page as zeros.
std::string shortage_of_database(const std::string& path) {
  constexpr std::string_view kBegin("SQLite format 3\0", 16);
  SourceFile file(path);
  if (!file.is_open()) return {};
  const std::vector<std::uint8_t> header = file.read(0, 18);
  if (header.size() < 18 || !std::equal(kBegin.begin(), kBegin.end(), header.begin())) return {};
  const std::uint64_t stored = std::uint64_t{header[16]} << 8 | header[17];
  const std::uint64_t page = stored == 1 ? 65536 : stored;
  const std::uint64_t over = page == 0 ? 0 : file.size() % page;
  if (over == 0) return {};
  return "is cut off: its last page lacks " + of_all(page - over, page, "bytes");
}

/// Finds where the first object or list of a JSON text ends.
class JsonValueEnd {
 public:
  bool is_passed() const { return is_passed_; }
  void take(char c) {
    if (is_escaped_) {
      is_escaped_ = false;
    } else if (is_in_string_) {
      is_escaped_ = c == '\\';
      is_in_string_ = c != '"';
    } else if (c == '"') {
      is_in_string_ = true;
    } else if (c == '{' || c == '[') {
      ++depth_;
    } else if (c == '}' || c == ']') {
      is_passed_ = --depth_ <= 0;
    }
  }

 private:
  bool is_in_string_ = false;
  bool is_escaped_ = false;
  bool is_passed_ = false;
  std::int64_t depth_ = 0;
};

/// GDAL reads the first value of a text that is not a collection of features, and passes over what
/// follows: all other features of a sequence that it does not recognize as one.
std::string shortage_of_json(GDALDataset& dataset) {
  constexpr std::size_t kBlock = 65536;
  constexpr std::string_view kBlank(" \t\r\n\0);", 7);  // the brackets are those of JSONP
  if (dataset.GetLayerCount() != 1 || dataset.GetLayer(0)->GetFeatureCount(FALSE) != 1) return {};
  SourceFile file(dataset.GetDescription());
  if (!file.is_open()) return {};
  JsonValueEnd end;
  std::uint64_t offset = 0;
  for (;;) {
    const std::vector<std::uint8_t> block = file.read(offset, kBlock);
    if (block.empty()) return {};
    for (const std::uint8_t byte : block) {
      const char c = static_cast<char>(byte);
      if (!end.is_passed()) {
        end.take(c);
      } else if (kBlank.find(c) == std::string_view::npos) {
        return "only its first feature would be read, and more follows it: a sequence of GeoJSON "
               "has one feature a line and begins without a byte order mark";
      }
    }
    offset += block.size();
  }
}

}  // namespace

std::string shortage_of_files(GDALDataset& dataset) {
  const std::string driver = dataset.GetDriverName();
  if (driver == "GeoJSON") return shortage_of_json(dataset);
  if (driver == "ESRI Shapefile") return shortage_of_shapefiles(dataset);
  if (driver == "GPKG" || driver == "SQLite") return shortage_of_database(dataset.GetDescription());
  return {};
}

// Shapefile is not among them: it counts rows marked as deleted, which are not read.
bool tells_feature_count(const std::string& driver) {
  constexpr std::array<std::string_view, 5> kDrivers = {"FlatGeobuf", "GPKG", "SQLite",
                                                        "OpenFileGDB", "Parquet"};
  return std::ranges::find(kDrivers, driver) != kDrivers.end();
}

GIntBig count_readable(OGRLayer& layer) {
  OGRFeatureDefn& definition = *layer.GetLayerDefn();
  CPLStringList ignored;
  for (int i = 0; i < definition.GetFieldCount(); ++i) {
    ignored.AddString(definition.GetFieldDefn(i)->GetNameRef());
  }
  ignored.AddString("OGR_GEOMETRY");
  layer.SetAttributeFilter(nullptr);
  layer.SetIgnoredFields(const_cast<const char**>(ignored.List()));
  layer.ResetReading();
  GIntBig count = 0;
  while (OGRFeatureUniquePtr(layer.GetNextFeature()) != nullptr) ++count;
  layer.SetIgnoredFields(nullptr);
  return count;
}

}  // namespace trapeze
