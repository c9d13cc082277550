#include "tests/oracle/compare.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trapeze::oracle {
namespace {

constexpr double kPlainlyDifferent = 64;

// In 255ths.
std::array<double, 4> premultiplied(Rgba colour) {
  const double a = colour.a / 255.0;
  return {colour.r * a, colour.g * a, colour.b * a, static_cast<double>(colour.a)};
}

std::string text_of_channels(std::array<double, 4> channels) {
  std::string text;
  for (const double channel : channels) text += " " + std::to_string(std::lround(channel));
  return text;
}

}  // namespace

double Distance::mean() const {
  return pixels == 0 ? 0 : sum / static_cast<double>(4 * pixels);
}

double Distance::share() const {
  return pixels == 0 ? 0 : static_cast<double>(plainly_different) / static_cast<double>(pixels);
}

void Distance::add(const Distance& other) {
  pixels += other.pixels;
  sum += other.sum;
  plainly_different += other.plainly_different;
  inner += other.inner;
  if (inner_different == 0) first_inner_place = other.first_inner_place;
  inner_different += other.inner_different;
  if (other.worst <= worst) return;
  worst = other.worst;
  worst_place = other.worst_place;
}

Distance compare(const Picture& picture, const Comparison& comparison) {
  Distance distance;
  const bool fits = picture.width == kPixels && picture.height == kPixels;
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      PixelSum truth = comparison.truth->at(column, row);
      for (double& channel : truth) channel *= 255;
      const auto drawn =
          fits ? premultiplied(picture.at(column, row)) : std::array<double, 4>{999, 999, 999, 999};
      double off = 0;
      bool is_equal = true;
      for (std::size_t i = 0; i < drawn.size(); ++i) {
        off = std::max(off, std::abs(drawn[i] - truth[i]));
        distance.sum += std::abs(drawn[i] - truth[i]);
        // Opacity is rounded as well unless colours are opaque.
        const double bound = comparison.is_opaque ? 0.51 : 1.51;
        is_equal = is_equal && std::abs(drawn[i] - truth[i]) <= bound;
      }
      const auto here = [&] {
        return comparison.place + " pixel " + std::to_string(column) + "," + std::to_string(row) +
               " is" + text_of_channels(drawn) + " and not" + text_of_channels(truth);
      };
      ++distance.pixels;
      if (off > kPlainlyDifferent) ++distance.plainly_different;
      if (off > distance.worst) {
        distance.worst = off;
        distance.worst_place = here();
      }
      const auto i = static_cast<std::size_t>(row) * kPixels + static_cast<std::size_t>(column);
      if ((*comparison.near_edges)[i]) continue;
      ++distance.inner;
      if (is_equal) continue;
      if (distance.inner_different++ == 0) distance.first_inner_place = here();
    }
  }
  return distance;
}

}  // namespace trapeze::oracle
