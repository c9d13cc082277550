#include "core/io/file/prepared_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/grid/for_each_in_parallel.h"
#include "core/io/file/atomic_file.h"
#include "core/io/file/checksum.h"

namespace trapeze {
namespace {

constexpr std::size_t kBytesForAThread = std::size_t{1} << 21;
constexpr std::array<std::byte, kSectionAlignment> kPadding{};

[[noreturn]] void reject_file(const std::string& words) {
  throw PreparedFileError(words);
}

std::size_t padding_after(std::size_t size) {
  return (kSectionAlignment - size % kSectionAlignment) % kSectionAlignment;
}

/// The header's own checksum is its last field.
std::uint64_t checksum_of_header(const PreparedHeader& header) {
  const auto bytes = std::as_bytes(std::span(&header, 1));
  return checksum(bytes.first(bytes.size() - sizeof header.header_checksum));
}

bool is_zero(std::span<const std::byte> bytes) {
  return std::ranges::all_of(bytes, [](std::byte byte) { return byte == std::byte{}; });
}

PreparedHeader read_header(std::span<const std::byte> file) {
  PreparedHeader header;
  if (file.size() < sizeof header) reject_file("is cut off");
  std::memcpy(&header, file.data(), sizeof header);
  if (header.magic != kPreparedMagic) reject_file("is not a prepared file");
  if (header.byte_order != kByteOrderMark) {
    throw OtherFormatError("was prepared on a machine of another byte order");
  }
  if (header.version != kPreparedVersion) {
    throw OtherFormatError("has format " + std::to_string(header.version) +
                           ", and this version of Trapeze reads " +
                           std::to_string(kPreparedVersion));
  }
  if (header.header_checksum != checksum_of_header(header)) reject_file("is damaged: its header");
  if (header.file_size != file.size()) {
    reject_file("is damaged: it has " + std::to_string(file.size()) + " of " +
                std::to_string(header.file_size) + " bytes");
  }
  return header;
}

/// Takes bytes off the front of a file.
class Cutter {
 public:
  explicit Cutter(std::span<const std::byte> rest) : rest_(rest) {}

  std::span<const std::byte> cut(std::size_t size) {
    if (size > rest_.size()) reject_file("is damaged: its directory leads beyond its end");
    const auto front = rest_.first(size);
    rest_ = rest_.subspan(size);
    return front;
  }
  std::span<const std::byte> cut(std::uint64_t count, std::uint64_t item_size) {
    if (item_size == 0 || count > rest_.size() / item_size) {
      reject_file("is damaged: its directory leads beyond its end");
    }
    return cut(count * item_size);
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
};

}  // namespace

std::string name_of(SectionKind kind) {
  static constexpr std::array<const char*, 30> kNames = {"description",
                                                         "vertices",
                                                         "edges",
                                                         "trapezoids",
                                                         "lifespans",
                                                         "features",
                                                         "index",
                                                         "index of level edges",
                                                         "index of dust",
                                                         "index of merged dust",
                                                         "grains",
                                                         "overlaps",
                                                         "outlines",
                                                         "ends of rings",
                                                         "ends of outlines",
                                                         "sizes of loops",
                                                         "ends of milestones",
                                                         "milestones",
                                                         "levels of milestones",
                                                         "features built by themselves",
                                                         "groups",
                                                         "features of groups",
                                                         "overlaps in groups",
                                                         "ids",
                                                         "texts",
                                                         "ends of texts",
                                                         "numbers of a column",
                                                         "nulls of a column",
                                                         "texts of a column",
                                                         "places of labels"};
  static_assert(kNames.size() == static_cast<std::size_t>(SectionKind::label_anchors));
  const auto number = static_cast<std::uint32_t>(kind);
  return number >= 1 && number <= kNames.size() ? kNames[number - 1] : "unknown section";
}

bool is_prepared_file(const std::string& path) {
  // Not for a pipe, which would lose its beginning to this check.
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::array<char, kPreparedMagic.size()> begin{};
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), begin.size());
  return file && std::memcmp(begin.data(), kPreparedMagic.data(), begin.size()) == 0;
}

void SectionWriter::add_bytes(DirectoryEntry entry, std::span<const std::byte> bytes) {
  entry.checksum = checksum(bytes);
  entries_.push_back(entry);
  bytes_.push_back(bytes);
}

void SectionWriter::write(const std::string& path, std::uint64_t fingerprint) const {
  PreparedHeader header;
  std::vector<std::span<const std::byte>> pieces = {std::as_bytes(std::span(&header, 1))};
  const auto add = [&](std::span<const std::byte> bytes) {
    const auto padding = std::span(kPadding).first(padding_after(bytes.size()));
    pieces.insert(pieces.end(), {bytes, padding});
    header.file_size += bytes.size() + padding.size();
  };
  const auto directory = std::as_bytes(std::span(entries_));
  header.file_size = sizeof header;
  add(directory);
  for (const std::span<const std::byte> bytes : bytes_) add(bytes);
  header.fingerprint = fingerprint;
  header.section_count = entries_.size();
  header.directory_checksum = checksum(directory);
  header.header_checksum = checksum_of_header(header);
  write_atomically(path, pieces);
}

SectionReader::SectionReader(std::span<const std::byte> file, Checked checked)
    : header_(read_header(file)) {
  read_directory(file);
  check_sections(checked == Checked::all ? sections_.size()
                                         : std::min<std::size_t>(1, sections_.size()));
}

void SectionReader::read_directory(std::span<const std::byte> file) {
  Cutter rest(file.subspan(sizeof header_));
  const auto directory = rest.cut(header_.section_count, sizeof(DirectoryEntry));
  const bool is_intact = checksum(directory) == header_.directory_checksum;
  if (!is_intact || !is_zero(rest.cut(padding_after(directory.size())))) {
    reject_file("is damaged: its directory");
  }
  sections_.resize(header_.section_count);
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    Section& section = sections_[i];
    std::memcpy(&section.entry, directory.data() + i * sizeof(DirectoryEntry),
                sizeof(DirectoryEntry));
    section.bytes = rest.cut(section.entry.count, section.entry.item_size);
    section.padding = rest.cut(padding_after(section.bytes.size()));
  }
  if (!rest.is_at_end()) reject_file("is damaged: there is more than its directory says");
}

/// Checks the first `count` sections.
void SectionReader::check_sections(std::size_t count) const {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < count; ++i) bytes += sections_[i].bytes.size();
  for_each_in_parallel(count, 1 + bytes / kBytesForAThread, [this](std::size_t i) {
    const Section& section = sections_[i];
    if (checksum(section.bytes) != section.entry.checksum || !is_zero(section.padding)) {
      reject_file("is damaged: its section \"" + name_of(section.entry.kind) + "\"");
    }
  });
}

std::span<const std::byte> SectionReader::take_bytes(SectionKind kind, std::size_t item_size) {
  if (next_ == sections_.size() || sections_[next_].entry.kind != kind ||
      sections_[next_].entry.item_size != item_size) {
    reject_file("is damaged: it has no section \"" + name_of(kind) + "\" where it should be");
  }
  return sections_[next_++].bytes;
}

void SectionReader::finish() const {
  if (next_ != sections_.size()) reject_file("is damaged: it has sections that nothing needs");
}

}  // namespace trapeze
