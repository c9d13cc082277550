#include "core/class_dust.h"

#include <algorithm>
#include <cmath>

#include "core/dust.h"

namespace trapeze {
namespace {

constexpr double kSmallestArea = 0.5;  // cells squared

std::uint64_t key_of(std::uint8_t feature_class, double x, double y, double pixel) {
  const auto number = [pixel](double v) {
    return static_cast<std::uint64_t>(std::max(0.0, (v - kGridMin) / pixel)) & 0xfffffff;
  };
  return std::uint64_t{feature_class} << 56 | number(y) << 28 | number(x);
}

}  // namespace

void ClassDust::gather(const GrainIndex& grains, const Box& box, Level level, double pixel,
                       std::span<const std::uint8_t> classes, std::vector<ClassMote>& motes) {
  sums_.clear();
  keys_.clear();
  motes.clear();
  // Pixels of more cells than the grid's side over 2^28 are told apart.
  pixel = std::max(pixel, static_cast<double>(kGridSize) / (1 << 28));
  grains.visit(box, level, [&](const FeatureGrain& grain) {
    const std::uint8_t feature_class = classes[grain.row];
    if (feature_class == kNotDrawn) return;
    const double grain_area = static_cast<double>(grain.doubled_area) / 2;
    lay_out(grain.from, grain.to, grain_area, pixel, [&](double x, double y, double area) {
      Sum& sum = sums_[key_of(feature_class, x, y, pixel)];
      const double weight = std::abs(area);
      sum.x += weight * x;
      sum.y += weight * y;
      sum.area += area;
      sum.weight += weight;
    });
  });
  for (const auto& [key, sum] : sums_) keys_.push_back(key);
  std::sort(keys_.begin(), keys_.end());
  for (const std::uint64_t key : keys_) {
    const Sum& sum = sums_[key];
    if (std::abs(sum.area) < kSmallestArea) continue;
    motes.push_back({box_of_mote(sum.x / sum.weight, sum.y / sum.weight, std::abs(sum.area)),
                     static_cast<std::uint8_t>(key >> 56), sum.area < 0});
  }
}

}  // namespace trapeze
