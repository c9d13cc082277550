// The container in which a prepared layer is stored: arrays one after another, each with a
// checksum, so that the file can be mapped and used as it is.
//
//   header, directory, padding | section, padding | section, padding | ...
//
// Every section begins at the next multiple of 64 bytes after the previous one: its position
// follows from the counts before it and is not stored. Padding is zero and is checked, so no byte
// can change unnoticed. Numbers have the byte order of the machine that wrote them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace trapeze {

/// Must be incremented when the header, the directory, the sections or their description change.
constexpr std::uint32_t kPreparedVersion = 9;

/// As in PNG: bytes that a text conversion would change.
constexpr std::array<std::uint8_t, 8> kPreparedMagic = {0x89, 'T', 'R', 'P', 'Z', '\r', '\n', 0x1a};
constexpr std::uint32_t kByteOrderMark = 0x01020304;
constexpr std::size_t kSectionAlignment = 64;

struct PreparedHeader {
  std::array<std::uint8_t, 8> magic = kPreparedMagic;
  std::uint32_t byte_order = kByteOrderMark;
  std::uint32_t version = kPreparedVersion;
  std::uint64_t file_size = 0;
  std::uint64_t fingerprint = 0;  // build_fingerprint of the options with which it was prepared
  std::uint64_t section_count = 0;
  std::uint64_t directory_checksum = 0;
  std::uint64_t unused = 0;
  std::uint64_t header_checksum = 0;  // of the fields above
};
static_assert(sizeof(PreparedHeader) == kSectionAlignment);

/// In storage order; the sections of a column occur once for each column.
enum class SectionKind : std::uint32_t {
  description = 1,
  vertices,
  edges,
  trapezoids,
  lifespans,
  feature_of,
  polygon_index,
  level_edge_index,
  mote_index,
  merged_mote_index,
  grains,
  overlaps,
  outline_points,
  ring_ends,
  outline_ends,
  loop_sizes,
  milestone_ends,
  milestones,
  milestone_levels,
  feature_units,
  group_units,
  group_members,
  group_overlaps,
  ids,
  string_bytes,
  string_ends,
  numbers,
  nulls,
  texts,
  label_anchors,
};
std::string name_of(SectionKind kind);

struct DirectoryEntry {
  SectionKind kind = SectionKind::description;
  std::uint32_t item_size = 1;
  std::uint64_t count = 0;
  std::uint64_t checksum = 0;
};

/// The file is not a prepared file, is damaged, or is of another version. The message does not
/// contain its name.
class PreparedFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file is of another version or byte order; it shows no sign of damage.
class OtherFormatError : public PreparedFileError {
 public:
  using PreparedFileError::PreparedFileError;
};

/// Whether `path` is a file that begins like a prepared file. Never throws.
bool is_prepared_file(const std::string& path);

/// Whether every byte of an item of that type is significant. Types with floats need a
/// specialization.
template <typename T>
inline constexpr bool kIsStorable =
    std::has_unique_object_representations_v<T> || std::is_same_v<T, std::byte>;

/// Collects sections and writes them as a file; until then it holds views of the caller's memory.
class SectionWriter {
 public:
  template <typename T>
  void add(SectionKind kind, std::span<const T> items) {
    static_assert(kIsStorable<T>);
    add_bytes({kind, sizeof(T), items.size(), 0}, std::as_bytes(items));
  }

  /// Writes the file, see write_atomically.
  void write(const std::string& path, std::uint64_t fingerprint) const;

 private:
  void add_bytes(DirectoryEntry entry, std::span<const std::byte> bytes);

  std::vector<DirectoryEntry> entries_;
  std::vector<std::span<const std::byte>> bytes_;
};

/// Reads the sections of a file in order. The file is not trusted: no returned section extends
/// beyond its end. Throws PreparedFileError.
class SectionReader {
 public:
  /// Which sections are checked.
  enum class Checked {
    all,
    first,  // only the first one, and no other may be taken
  };

  /// Checks the header, the directory and, on all cores, the checksum of every section that is to
  /// be checked. `file` begins at a multiple of 64 bytes and must outlive the sections taken from
  /// it.
  explicit SectionReader(std::span<const std::byte> file, Checked checked = Checked::all);

  std::uint64_t fingerprint() const { return header_.fingerprint; }

  /// Returns the next section, which must be of this kind.
  template <typename T>
  std::span<const T> take(SectionKind kind) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kSectionAlignment);
    const std::span<const std::byte> bytes = take_bytes(kind, sizeof(T));
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// Checks that no section remains.
  void finish() const;

 private:
  struct Section {
    DirectoryEntry entry;
    std::span<const std::byte> bytes;    // of the items
    std::span<const std::byte> padding;  // up to the next section
  };

  void read_directory(std::span<const std::byte> file);
  void check_sections(std::size_t count) const;
  std::span<const std::byte> take_bytes(SectionKind kind, std::size_t item_size);

  PreparedHeader header_;
  std::vector<Section> sections_;
  std::size_t next_ = 0;
};

}  // namespace trapeze
