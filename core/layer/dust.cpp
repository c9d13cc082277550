#include "core/layer/dust.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace trapeze {
namespace {

std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 16) & 0x0000ffff0000ffffull;
  v = (v | v << 8) & 0x00ff00ff00ff00ffull;
  v = (v | v << 4) & 0x0f0f0f0f0f0f0f0full;
  v = (v | v << 2) & 0x3333333333333333ull;
  return (v | v << 1) & 0x5555555555555555ull;
}

/// Interleaved bits: two points are in the same square of 2^k cells if their codes agree except for
/// the last 2k bits.
std::uint64_t morton(double x, double y) {
  const auto biased = [](double v) {
    return static_cast<std::uint64_t>(
        std::clamp(std::floor(v) - kGridMin, 0.0, static_cast<double>(kGridSize)));
  };
  return spread_bits(biased(x)) | spread_bits(biased(y)) << 1;
}

std::int32_t cell(double v) {
  return static_cast<std::int32_t>(std::clamp(std::round(v), double{kGridMin}, double{kGridMax}));
}

Mote merged(const std::vector<Mote>& motes, Level level) {
  Mote sum{0, 0, 0, {level, kNeverDies}, true};
  double weight = 0;
  for (const Mote& m : motes) {
    const double w = std::abs(m.area);
    sum.x += w * m.x;
    sum.y += w * m.y;
    sum.area += m.area;
    weight += w;
  }
  sum.x /= weight;
  sum.y /= weight;
  return sum;
}

int count_of_motes(const Grain& grain, int most) {
  return count_of_motes(grain.axis, pixel_of_level(grain.born), most);
}

/// The motes that are alive or yet to be born, in order of place, octave by octave.
class Settling {
 public:
  Settling(const std::vector<Grain>& grains, int most) {
    std::vector<Mote> motes;
    for (const Grain& grain : grains) {
      lay_out(grain.axis, grain.area, count_of_motes(grain, most),
              [&](double x, double y, double area) {
                motes.push_back({x, y, area, {grain.born, kNeverDies}, false});
              });
    }
    std::erase_if(motes, [](const Mote& m) { return m.area == 0; });
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::size_t i = 0; i < motes.size(); ++i) {
      order.emplace_back(morton(motes[i].x, motes[i].y), static_cast<std::uint32_t>(i));
    }
    std::sort(order.begin(), order.end());
    for (const auto& [code, i] : order) {
      motes_.push_back(motes[i]);
      codes_.push_back(code);
    }
  }

  /// Merges the motes born by now that lie in one pixel of `level`.
  void merge_pixels(Level level) {
    const int bits = 2 * static_cast<int>(std::lround(std::log2(pixel_of_level(level))));
    kept_ = 0;
    for (std::size_t begin = 0; begin < motes_.size();) {
      std::size_t end = begin;
      while (end < motes_.size() && codes_[end] >> bits == codes_[begin] >> bits) ++end;
      merge_pixel(begin, end, level);
      begin = end;
    }
    motes_.resize(kept_);
    codes_.resize(kept_);
  }

  std::vector<Mote> finish() {
    for (const Mote& m : motes_) keep_if_seen(m);
    return std::move(settled_);
  }

 private:
  struct Placed {
    Mote mote;
    std::uint64_t code;
  };

  void merge_pixel(std::size_t begin, std::size_t end, Level level) {
    born_.clear();
    left_.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (motes_[i].lifespan.born <= level) {
        born_.push_back(motes_[i]);
      } else {
        left_.push_back({motes_[i], codes_[i]});
      }
    }
    if (born_.size() == 1) left_.push_back({born_.front(), codes_[begin]});
    if (born_.size() > 1) {
      left_.push_back({merged(born_, level), codes_[begin]});
      if (left_.back().mote.area == 0) left_.pop_back();
      for (Mote& m : born_) {
        m.lifespan.dies = level;
        keep_if_seen(m);
      }
    }
    // There are no more than before; within a pixel their order no longer matters.
    for (const Placed& placed : left_) {
      motes_[kept_] = placed.mote;
      codes_[kept_++] = placed.code;
    }
  }

  void keep_if_seen(const Mote& m) {
    if (m.lifespan.born < m.lifespan.dies && std::abs(m.area) >= kSmallestMote) {
      settled_.push_back(m);
    }
  }

  std::vector<Mote> motes_;
  std::vector<std::uint64_t> codes_;
  std::size_t kept_ = 0;
  std::vector<Mote> settled_;
  // Of the current pixel.
  std::vector<Mote> born_;
  std::vector<Placed> left_;
};

}  // namespace

double pixel_of_level(Level level) {
  return 4 * epsilon_of_level(level);
}

std::array<Point, 4> Strip::corners() const {
  const double x = (static_cast<double>(axis.from.x) + axis.to.x) / 2;
  const double y = (static_cast<double>(axis.from.y) + axis.to.y) / 2;
  const double dx = static_cast<double>(axis.to.x) - axis.from.x;
  const double dy = static_cast<double>(axis.to.y) - axis.from.y;
  const double span = std::hypot(dx, dy);
  const double along_x = span > 0 ? dx / span : 1;
  const double along_y = span > 0 ? dy / span : 0;
  const auto corner = [&](double along, double across) {
    return Point{cell(x + along * along_x - across * along_y),
                 cell(y + along * along_y + across * along_x)};
  };
  const double a = length / 2;
  const double b = width / 2;
  return {corner(-a, -b), corner(a, -b), corner(a, b), corner(-a, b)};
}

Box box_of_mote(double x, double y, double area) {
  const double width = std::max(1.0, std::round(std::sqrt(area)));
  const double height = std::max(1.0, std::round(area / width));
  // At the edges of the grid it is shifted, so that no part of it is cut off.
  const std::int32_t min_x = cell(std::min(x - width / 2, kGridMax - width));
  const std::int32_t min_y = cell(std::min(y - height / 2, kGridMax - height));
  return {min_x, min_y, cell(min_x + width), cell(min_y + height)};
}

int most_motes_of(const std::vector<Grain>& grains, std::size_t vertices) {
  constexpr std::size_t kMotes = std::size_t{1} << 16;
  constexpr std::size_t kMotesAVertex = 4;
  int most = kMostMotes;
  for (; most > 1; most /= 2) {
    std::size_t motes = 0;
    for (const Grain& grain : grains) {
      motes += static_cast<std::size_t>(count_of_motes(grain, most));
    }
    if (motes <= kMotes + kMotesAVertex * vertices) break;
  }
  return most;
}

std::vector<Mote> settle(const std::vector<Grain>& grains, std::size_t vertices) {
  Settling settling(grains, most_motes_of(grains, vertices));
  for (int level = 1; level <= kLastLevel; level += kLevelsPerOctave) {
    settling.merge_pixels(static_cast<Level>(level));
  }
  return settling.finish();
}

}  // namespace trapeze
