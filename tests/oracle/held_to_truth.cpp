#include "tests/oracle/held_to_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

namespace trapeze::oracle {
namespace {

constexpr double kInside = 2;  // pixels away from all edges

std::vector<std::int64_t> some_ids(const std::vector<const TrueFeature*>& features) {
  constexpr std::size_t kMost = 256;
  const std::size_t step = 3 + features.size() / kMost;
  std::vector<std::int64_t> ids;
  for (std::size_t i = 0; i < features.size(); i += step) ids.push_back(features[i]->id);
  return ids;
}

Limits limits_of(const std::string& layers, const std::string& text,
                 std::span<const Exception> exceptions) {
  for (const Exception& exception : exceptions) {
    const bool applies =
        exception.layers == layers && text.find(exception.cases) != std::string::npos;
    if (applies) return exception.limits;
  }
  return {};
}

/// For one style, over all zooms.
struct Worst {
  double mean = 0;
  double share = 0;
  double off = 0;
  std::string place;
};

}  // namespace

void HeldToTruth::look_at(TileName name, const TrueClasses& classes) {
  const TrueTile truth(subject_.layers, name);
  const std::vector<StyleCase> styles = subject_.layers.size() == 1
                                            ? styles_of_layer(classes, some_ids(truth.features(0)))
                                            : styles_of_pair(subject_.names[0], subject_.names[1]);
  std::vector<std::vector<TruePaint>> paints;
  for (const StyleCase& style : styles) paints.push_back(style.paints);
  const std::vector<TruePicture> pictures = truth.paint(paints, workspace_);
  std::map<double, std::vector<bool>> near_edges;  // by width of the line
  for (std::size_t i = 0; i < styles.size(); ++i) {
    const StyleCase& style = styles[i];
    std::vector<bool>& near = near_edges[style.line_width];
    if (near.empty()) near = truth.near_edges(kInside + style.line_width / 2);
    for (const auto& [label, program] : subject_.programs) {
      const Picture picture = program->tile(subject_.names, name, style.query);
      distances_[{label, style.name, name.zoom}].add(
          compare(picture, {&pictures[i], &near, style.is_opaque, text_of(name)}));
    }
  }
}

std::string text_of(const HeldToTruth::Case& one) {
  return one.program + ", " + one.style + ", zoom " + std::to_string(one.zoom);
}

void expect_true(const HeldToTruth& held, const std::string& layers,
                 std::span<const Exception> exceptions) {
  std::map<std::string, Worst> worst_of;
  for (const auto& [one, distance] : held.distances()) {
    const std::string text = text_of(one);
    const Limits limits = limits_of(layers, text, exceptions);
    EXPECT_LE(distance.mean(), limits.mean) << text;
    EXPECT_LE(distance.share(), limits.share) << text << ": " << distance.worst_place;
    EXPECT_LE(distance.inner_different, limits.inner_different)
        << text << ": " << distance.first_inner_place;
    Worst& worst = worst_of[one.program + ", " + one.style];
    worst.mean = std::max(worst.mean, distance.mean());
    worst.share = std::max(worst.share, distance.share());
    if (distance.worst <= worst.off) continue;
    worst.off = distance.worst;
    worst.place = distance.worst_place;
  }
  for (const auto& [style, worst] : worst_of) {
    std::printf("%s: %s: mean at most %.3f/255, over 64 at most %.4f %%, worst %.0f in %s\n",
                layers.c_str(), style.c_str(), worst.mean, 100 * worst.share, worst.off,
                worst.place.c_str());
  }
}

}  // namespace trapeze::oracle
