#include "core/dust.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace trapeze {
namespace {

constexpr double kSmallestArea = 0.5;  // cells squared
constexpr int kMaxMotesOfGrain = 256;

std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffffull;
  v = (v | v << 8) & 0x00ff00ff00ff00ffull;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0full;
  v = (v | v << 2) & 0x3333333333333333ull;
  return (v | v << 1) & 0x5555555555555555ull;
}

/// Interleaved bits: two points are in one square of 2^k cells if their codes agree but for the
/// last 2k bits.
std::uint64_t morton(double x, double y) {
  const auto biased = [](double v) {
    return static_cast<std::uint64_t>(
        std::clamp(std::floor(v) - kGridMin, 0.0, static_cast<double>(kGridSize)));
  };
  return spread_bits(biased(x)) | spread_bits(biased(y)) << 1;
}

/// A grain is laid out along its segment, a mote a pixel.
void lay_out(const Grain& grain, std::vector<Mote>& motes) {
  const double dx = static_cast<double>(grain.to.x) - grain.from.x;
  const double dy = static_cast<double>(grain.to.y) - grain.from.y;
  const double pixels = std::hypot(dx, dy) / pixel_of_level(grain.born);
  const int count = std::clamp(static_cast<int>(std::ceil(pixels)), 1, kMaxMotesOfGrain);
  for (int i = 0; i < count; ++i) {
    const double along = (i + 0.5) / count;
    motes.push_back({grain.from.x + along * dx,
                     grain.from.y + along * dy,
                     grain.area / count,
                     {grain.born, kNeverDies},
                     false});
  }
}

Mote merged(const std::vector<Mote>& motes, std::size_t begin, std::size_t end, Level level) {
  Mote sum{0, 0, 0, {level, kNeverDies}, true};
  double weight = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double w = std::abs(motes[i].area);
    sum.x += w * motes[i].x;
    sum.y += w * motes[i].y;
    sum.area += motes[i].area;
    weight += w;
  }
  sum.x /= weight;
  sum.y /= weight;
  return sum;
}

}  // namespace

double pixel_of_level(Level level) {
  return 4 * epsilon_of_level(level);
}

std::vector<Mote> settle(const std::vector<Grain>& grains) {
  std::vector<Mote> motes;
  for (const Grain& grain : grains) lay_out(grain, motes);
  std::erase_if(motes, [](const Mote& m) { return m.area == 0; });
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::size_t i = 0; i < motes.size(); ++i) {
    order.emplace_back(morton(motes[i].x, motes[i].y), static_cast<std::uint32_t>(i));
  }
  std::sort(order.begin(), order.end());

  // Alive or yet unborn, in order of place; merging keeps the order.
  std::vector<Mote> settled;
  std::vector<Mote> now;
  std::vector<std::uint64_t> codes;
  for (const auto& [code, i] : order) {
    now.push_back(motes[i]);
    codes.push_back(code);
  }
  const auto keep = [&settled](const Mote& m) {
    if (m.lifespan.born < m.lifespan.dies && std::abs(m.area) >= kSmallestArea)
      settled.push_back(m);
  };
  std::vector<Mote> born;
  for (int level = 1; level <= kLastLevel; level += kLevelsPerOctave) {
    const int square =
        2 * static_cast<int>(std::lround(std::log2(pixel_of_level(static_cast<Level>(level)))));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < now.size();) {
      std::size_t end = i;
      born.clear();
      const std::uint64_t cell = codes[i] >> square;
      const std::uint64_t code = codes[i];
      const std::size_t first_kept = kept;
      for (; end < now.size() && codes[end] >> square == cell; ++end) {
        if (now[end].lifespan.born <= level) {
          born.push_back(now[end]);
        } else {
          now[kept] = now[end];
          codes[kept++] = codes[end];
        }
      }
      i = end;
      if (born.empty()) continue;
      // The one that stands for them goes before what is not born yet; both share the cell.
      Mote one = born.front();
      if (born.size() > 1) {
        one = merged(born, 0, born.size(), static_cast<Level>(level));
        for (Mote& m : born) {
          m.lifespan.dies = static_cast<Level>(level);
          keep(m);
        }
      }
      if (one.area == 0) continue;
      for (std::size_t k = kept; k > first_kept; --k) {
        now[k] = now[k - 1];
        codes[k] = codes[k - 1];
      }
      now[first_kept] = one;
      codes[first_kept] = code;
      ++kept;
    }
    now.resize(kept);
    codes.resize(kept);
  }
  for (const Mote& m : now) keep(m);
  return settled;
}

}  // namespace trapeze
