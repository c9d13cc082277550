#include "render/mask/row_bits.h"

namespace trapeze {
namespace {

/// Sets the bits of runs whose value satisfies is_marked(value). Returns whether there are any.
template <typename IsMarked>
bool mark_runs(std::span<const MaskRun> row, std::span<std::uint64_t> bits,
               const IsMarked& is_marked) {
  bool any = false;
  std::size_t begin = 0;
  for (const MaskRun& run : row) {
    if (is_marked(run.value)) {
      set_bits(begin, run.end, bits);
      any = true;
    }
    begin = run.end;
  }
  return any;
}

}  // namespace

void mark_changes(std::span<const MaskRun> row, std::span<std::uint64_t> bits) {
  for (const MaskRun& run : row.first(row.size() - 1)) {
    bits[run.end / 64] |= std::uint64_t{1} << run.end % 64;
  }
}

void mark_covered(std::span<const MaskRun> row, std::span<std::uint64_t> bits) {
  mark_runs(row, bits, [](std::uint8_t value) { return value != 0; });
}

bool mark_partial(std::span<const MaskRun> row, std::span<std::uint64_t> bits) {
  return mark_runs(row, bits, [](std::uint8_t value) { return value != 0 && value != 255; });
}

}  // namespace trapeze
