#include "core/layer/class_dust.h"

#include <algorithm>
#include <cmath>

#include "core/layer/dust.h"

namespace trapeze {
namespace {

// In cells. Corners are rounded to cells, which changes the area of a narrow patch.
constexpr double kNarrowestPatch = 16;

std::uint64_t key_of(std::uint8_t feature_class, double x, double y, double pixel) {
  const auto number = [pixel](double v) {
    return static_cast<std::uint64_t>(std::max(0.0, (v - kGridMin) / pixel)) & 0xfffffff;
  };
  return std::uint64_t{feature_class} << 56 | number(y) << 28 | number(x);
}

/// The key distinguishes only pixels larger than the side of the grid divided by 2^28.
double told_apart(double pixel) {
  return std::max(pixel, static_cast<double>(kGridSize) / (1 << 28));
}

/// The box, shifted so that it lies within a pixel if it is no larger than one.
Box within_pixel(const Box& box, double x, double y, double pixel) {
  const auto shift = [pixel](std::int32_t min, std::int32_t max, double at) -> std::int64_t {
    const double begin = kGridMin + std::floor((at - kGridMin) / pixel) * pixel;
    if (max - min > pixel) return 0;
    return std::llround(std::max(begin - min, std::min(0.0, begin + pixel - max)));
  };
  const std::int64_t dx = shift(box.min_x, box.max_x, x);
  const std::int64_t dy = shift(box.min_y, box.max_y, y);
  const auto moved = [](std::int32_t v, std::int64_t by) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v + by, kGridMin, kGridMax));
  };
  return {moved(box.min_x, dx), moved(box.min_y, dy), moved(box.max_x, dx), moved(box.max_y, dy)};
}

}  // namespace

void ClassDust::gather(const GrainIndex& grains, const DustSelection& selection,
                       std::span<const std::uint8_t> classes, ClassShapes& shapes) {
  begin(shapes);
  add(grains, selection, classes, shapes);
  finish(selection.pixel, shapes);
}

void ClassDust::begin(ClassShapes& shapes) {
  sums_.clear();
  keys_.clear();
  shapes.motes.clear();
  shapes.patches.clear();
}

void ClassDust::add(const GrainIndex& grains, const DustSelection& selection,
                    std::span<const std::uint8_t> classes, ClassShapes& shapes) {
  const double pixel = told_apart(selection.pixel);
  grains.visit(selection.box, selection.births, [&](const FeatureGrain& grain) {
    const std::uint8_t feature_class = classes.empty() ? std::uint8_t{0} : classes[grain.row];
    if (feature_class == kNotDrawn) return;
    const Strip strip = grain.strip();
    if (strip.width >= std::max(pixel, kNarrowestPatch)) {
      shapes.patches.push_back({strip.corners(), feature_class, grain.doubled_area < 0});
    } else {
      add_motes(grain, feature_class, pixel);
    }
  });
}

void ClassDust::finish(double pixel_of_selections, ClassShapes& shapes) {
  const double pixel = told_apart(pixel_of_selections);
  for (const auto& [key, sum] : sums_) keys_.push_back(key);
  std::sort(keys_.begin(), keys_.end());
  for (const std::uint64_t key : keys_) {
    const Sum& sum = sums_[key];
    if (std::abs(sum.area) < kSmallestMote) continue;
    const double x = sum.x / sum.weight;
    const double y = sum.y / sum.weight;
    shapes.motes.push_back({within_pixel(box_of_mote(x, y, std::abs(sum.area)), x, y, pixel),
                            static_cast<std::uint8_t>(key >> 56), sum.area < 0});
  }
}

void ClassDust::add_motes(const FeatureGrain& grain, std::uint8_t feature_class, double pixel) {
  const Axis axis{grain.from, grain.to};
  const int count = count_of_motes(axis, pixel, kMostMotes);
  lay_out(axis, grain.area(), count, [&](double x, double y, double area) {
    Sum& sum = sums_[key_of(feature_class, x, y, pixel)];
    const double weight = std::abs(area);
    sum.x += weight * x;
    sum.y += weight * y;
    sum.area += area;
    sum.weight += weight;
  });
}

}  // namespace trapeze
