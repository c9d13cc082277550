// Prepared files that were changed by somebody who also repairs the checksums: each is refused, or
// yields a layer that can be drawn and queried in every way. Without repaired checksums every
// change and every truncation is refused.
//
// Input: changes of seven bytes each to a file prepared from a few shapes: where (four bytes, taken
// modulo its size), how (one byte: set one byte, or set a word of four bytes to a small number, to
// one from the end of the range, or to its current value plus a little), and the value (two bytes).
// The remainder at the end: a byte, odd if nothing is to be repaired, then two bytes with the size
// to truncate the file to.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include "core/io/file/checksum.h"
#include "core/io/file/prepared_file.h"
#include "core/io/prepared/prepared_layer.h"
#include "core/layer/layer_builder.h"
#include "core/layer/untested_layer.h"
#include "render/software/software_renderer.h"
#include "tests/fuzz/input_share.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

constexpr std::size_t kBytesOfChange = 7;
constexpr std::size_t kMaxChanges = 16;
constexpr int kCornerPixels = 24;  // drawn of a tile for most inputs: whole tiles take a hundred
                                   // times as long and lead to the same places

struct alignas(kSectionAlignment) Block {
  std::array<std::byte, kSectionAlignment> bytes;
};

LoadedLayer sample() {
  LoadedLayer sample;
  FeatureTable features({{"name", FieldType::text}, {"size", FieldType::integer}});
  std::vector<LayerBuilder> builders(1);
  for (std::int32_t i = 0; i < 12; ++i) {
    Rings rings;
    const std::int32_t side = 1 << (2 * i);
    rings.add(
        std::vector<Point>{{0, 0}, {side, i}, {side, side}, {side / 2, side / 3}, {-i, side}});
    if (i % 4 == 3) rings.add(std::vector<Point>{{3, 3}, {side / 4, 4}, {5, side / 4}});
    const std::string name = "name " + std::to_string(i % 5);
    const std::vector<Value> values = {std::string_view(name),
                                       i % 3 == 0 ? Value() : Value(std::int64_t{i})};
    builders[0].add(features.append(i, values), rings);
  }
  sample.layer = LayerBuilder::join(builders, std::move(features));
  sample.report.notes = {{1, "a note"}};
  return sample;
}

/// The file that all inputs change; its size is a multiple of a block.
std::vector<Block> make_file() {
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("prepared_fuzz." + std::to_string(getpid()) + ".trapeze"))
                               .string();
  save_prepared_layer(path, sample(), 1, {"a source", {{"a source", 1, 2, 3}}});
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  std::filesystem::remove(path);
  std::vector<Block> blocks(bytes.size() / sizeof(Block));
  std::memcpy(blocks.data(), bytes.data(), bytes.size());
  return blocks;
}

void apply_change(const std::uint8_t* change, std::span<std::byte> file) {
  std::uint32_t place = 0;
  std::uint16_t value = 0;
  std::memcpy(&place, change, sizeof place);
  std::memcpy(&value, change + 5, sizeof value);
  const std::size_t at = place % file.size();
  if (change[4] % 4 == 0) {
    file[at] = static_cast<std::byte>(value);
    return;
  }
  const std::size_t word_at = at / 4 * 4;
  std::uint32_t word = 0;
  std::memcpy(&word, file.data() + word_at, sizeof word);
  if (change[4] % 4 == 1) word = value;
  if (change[4] % 4 == 2) word = 0u - value;
  if (change[4] % 4 == 3) word += static_cast<std::uint32_t>(static_cast<std::int8_t>(value));
  std::memcpy(file.data() + word_at, &word, sizeof word);
}

/// Corrects checksums and zeroes paddings, as a forger would, as far as the counts are usable.
void mend_sections(std::span<std::byte> directory, std::span<std::byte> sections) {
  for (std::size_t at = 0; at < directory.size(); at += sizeof(DirectoryEntry)) {
    DirectoryEntry entry;
    std::memcpy(&entry, directory.data() + at, sizeof entry);
    if (entry.item_size == 0 || entry.count > sections.size() / entry.item_size) return;
    const std::size_t size = entry.count * entry.item_size;
    const std::size_t padded =
        (size + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
    if (padded > sections.size()) return;
    entry.checksum = checksum(sections.first(size));
    std::memcpy(directory.data() + at, &entry, sizeof entry);
    std::ranges::fill(sections.subspan(size, padded - size), std::byte{});
    sections = sections.subspan(padded);
  }
}

void mend(std::span<std::byte> file) {
  PreparedHeader header;
  if (file.size() < sizeof header) return;
  std::memcpy(&header, file.data(), sizeof header);
  header.magic = kPreparedMagic;
  header.byte_order = kByteOrderMark;
  header.version = kPreparedVersion;
  header.file_size = file.size();
  const std::span<std::byte> rest = file.subspan(sizeof header);
  if (header.section_count <= rest.size() / sizeof(DirectoryEntry)) {
    const std::size_t size = header.section_count * sizeof(DirectoryEntry);
    const std::size_t padded = std::min(
        rest.size(), (size + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment);
    std::ranges::fill(rest.subspan(size, padded - size), std::byte{});
    mend_sections(rest.first(size), rest.subspan(padded));
    header.directory_checksum = checksum(rest.first(size));
  }
  header.header_checksum = checksum(std::as_bytes(std::span(&header, 1)).first(sizeof header - 8));
  std::memcpy(file.data(), &header, sizeof header);
}

/// The north-western corner of a tile, or the whole tile.
View view_of(int zoom, bool is_whole) {
  const std::uint32_t middle = zoom == 0 ? 0 : 1u << (zoom - 1);
  View view = View::of_tile({zoom, middle, middle}, 1);
  if (!is_whole) view.width = view.height = kCornerPixels;
  return view;
}

/// The sum over all edges of the mesh.
double lengths_along(const Layer& layer, Level level) {
  double sum = 0;
  for (std::uint32_t edge = 0; edge < layer.mesh().edges.size(); ++edge) {
    const auto [upper, lower] = along_edge(layer.mesh(), layer.outline(), edge, level);
    sum += std::abs(upper - lower) + extent_of(layer.outline().loop_size(edge));
  }
  return sum;
}

/// All queries that a server makes to a layer; the slowest only for some of the inputs.
void use(const Layer& layer, std::uint32_t hash) {
  const bool whole_tiles = hash % 16 == 0;
  const bool builds_again = hash / 16 % 8 == 0;
  static SoftwareRenderer renderer;
  static Mask mask;
  std::vector<TrapezoidRange> ranges;
  std::vector<Box> places;
  double outline_lengths = 0;
  for (int zoom = 0; zoom <= 24; zoom += 3) {
    const View view = view_of(zoom, whole_tiles);
    const Layer::Selection selection{view.box(), static_cast<Level>(kLastLevel - 2 * zoom)};
    layer.select(selection, ranges);
    renderer.draw(layer.mesh(), ranges, view, mask);
    layer.fill_box(selection, ranges);
    layer.small_polygons(selection, places);
    outline_lengths += lengths_along(layer, selection.level);
  }
  Rings rings;
  std::size_t bytes = outline_lengths > 0;
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    for (int field = 0; field < static_cast<int>(layer.features().fields().size()); ++field) {
      const Value value = layer.features().value(row, field);
      if (const auto* text = std::get_if<std::string_view>(&value)) {
        for (const char c : *text) bytes += static_cast<std::uint8_t>(c);
      }
    }
    layer.append_outline(row, rings);
  }
  for (std::uint32_t t = 0; t < layer.mesh().trapezoids.size(); ++t) {
    const std::uint32_t row = layer.feature_of(t);
    if (row != Layer::kNoFeature) bytes += static_cast<std::size_t>(layer.features().id(row));
  }
  // Prevents the compiler from removing the reads.
  [[maybe_unused]] volatile const std::size_t seen =
      bytes + rings.points.size() +
      (builds_again ? build_without_topology_test(layer)->memory() : layer.memory());
}

/// The final steps after all changes to the file.
struct Ending {
  bool is_mended = true;
  std::size_t size = 0;
};

Ending ending_from(std::span<const std::uint8_t> input, std::size_t file_size) {
  const auto rest = input.subspan(input.size() - input.size() % kBytesOfChange);
  Ending ending{true, file_size};
  if (!rest.empty()) ending.is_mended = rest[0] % 2 == 0;
  if (rest.size() >= 3) ending.size = (rest[1] | rest[2] << 8) % (file_size + 1);
  return ending;
}

/// Null if the file is refused.
std::unique_ptr<Layer> layer_of(std::span<const std::byte> file) {
  try {
    return std::move(layer_of_prepared_bytes(file, nullptr).layer);
  } catch (const PreparedFileError&) {
    return nullptr;
  } catch (const std::invalid_argument&) {
    return nullptr;
  }
}

void check(std::span<const std::uint8_t> input) {
  static const std::vector<Block> original = make_file();
  std::vector<Block> blocks = original;
  auto file = std::as_writable_bytes(std::span(blocks));
  for (std::size_t i = 0; i < kMaxChanges && (i + 1) * kBytesOfChange <= input.size(); ++i) {
    apply_change(input.data() + i * kBytesOfChange, file);
  }
  const Ending ending = ending_from(input, file.size());
  file = file.first(ending.size);
  if (ending.is_mended) mend(file);
  const auto layer = layer_of(file);
  if (layer == nullptr) return;
  const bool is_whole = std::ranges::equal(file, std::as_bytes(std::span(original)));
  fuzzing::require(ending.is_mended || is_whole, "a damaged file is taken for a whole one");
  use(*layer, fuzzing::hash_of(input.data(), input.size()));
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check({data, size});
  return 0;
}
