#include "render/picture/mixture_colours.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "render/picture/channels.h"

namespace trapeze {
namespace {

constexpr float kRounding = 0.1f / 255;

bool is_whole(std::uint8_t value) {
  return static_cast<std::uint8_t>(value + 1) <= 1;  // nothing or all
}

}  // namespace

void MixtureColours::begin(const PictureParts& parts, const Mixtures& mixtures, Rgba background) {
  parts_ = &parts;
  mixtures_ = &mixtures;
  background_ = to_paint(background, 1);
  words_.resize(mixtures.words_each);
  values_ = reinterpret_cast<std::uint8_t*>(words_.data());
  edges_.clear();
  edge_words_.clear();
  edge_numbers_.clear();
  kinds_.clear();
  kinds_.reserve(mixtures.size());
  for (std::size_t i = 0; i < mixtures.size(); ++i) kinds_.push_back(kind_of(i));
}

double MixtureColours::change_along_edges(int most_change) {
  if (most_change == 0) return 0;
  set_steps(most_change);
  double sum = 0;
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (kinds_[i].edge == kNone) continue;
    const Edge& edge = edges_[kinds_[i].edge];
    const std::uint8_t value = kinds_[i].value;
    const float share = edge.nearest_share(value);
    const float change = edge.sum_apart * std::abs(share - static_cast<float>(value) / 255);
    sum += static_cast<double>(change) * mixtures_->pixels[i];
  }
  return sum;
}

void MixtureColours::colour(int most_change) {
  colours_.clear();
  numbers_.resize(kinds_.size());
  if (most_change > 0) set_steps(most_change);
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    const Kind& kind = kinds_[i];
    const bool is_exact = most_change == 0 || kind.edge == kNone ||
                          !is_close_once_rounded(edges_[kind.edge], kind.value);
    numbers_[i] = is_exact ? colours_.number_of(exact_colour(i), kind.origin)
                           : colour_along(edges_[kind.edge], kind.value);
  }
}

MixtureColours::Kind MixtureColours::kind_of(std::size_t mixture) {
  take_values(mixture);
  Kind kind;
  kind.origin = partial_.empty() && meeting_count_ == 0 ? Origin::flat : Origin::mixed;
  if (!is_edge_at_hand()) return kind;
  const std::uint32_t edge = edge_at_hand();
  if (!edges_[edge].is_on_line) return kind;
  kind.edge = edge;
  kind.value = values_[partial_[0]];
  return kind;
}

void MixtureColours::take_values(std::size_t mixture) {
  std::memcpy(words_.data(), mixtures_->values_of(mixture), words_.size() * sizeof words_[0]);
  partial_.clear();
  const std::uint32_t channels = parts_->channel_count();
  for (std::uint32_t channel = 1; channel < channels; ++channel) {
    if (!is_whole(values_[channel])) partial_.push_back(channel);
  }
  meeting_count_ = 0;
  for (std::size_t i = channels; i < parts_->value_count(); i += 2) {
    meeting_count_ += values_[i] != 0 ? 1 : 0;
  }
}

bool MixtureColours::is_edge_at_hand() const {
  if (partial_.size() == 1) return meeting_count_ == 0;
  if (partial_.size() != 2 || meeting_count_ > 1) return false;
  const int both = values_[partial_[0]] + values_[partial_[1]];
  if (std::abs(both - 255) > 1) return false;
  if (meeting_count_ == 0) return true;
  return std::ranges::all_of(parts_->layers(), [this](const PictureParts::Layer& layer) {
    const std::int8_t relation = meeting_of(layer).relation;
    return relation == 0 || relation == Meeting::kSideBySide;
  });
}

// Edges are told from each other by all values but those of the masks whose edges they are, which
// get values that are no mixture's for that.
std::uint32_t MixtureColours::edge_at_hand() {
  const auto values = exchange_values({1, 2});
  const std::size_t size = words_.size();
  std::uint32_t& number = edge_numbers_.find(hash_of(words_), [&](std::uint32_t edge) {
    return std::ranges::equal(words_, std::span(edge_words_).subspan(edge * size, size));
  });
  const bool is_new = number == NumberTable::kNone;
  if (is_new) {
    number = static_cast<std::uint32_t>(edges_.size());
    edge_words_.insert(edge_words_.end(), words_.begin(), words_.end());
  }
  exchange_values(values);
  if (is_new) edges_.push_back(make_edge());
  return number;
}

MixtureColours::Edge MixtureColours::make_edge() {
  Edge edge;
  edge.from = mixture_with({0, 255});
  edge.to = mixture_with({255, 0});
  const std::array apart{std::abs(edge.from.r - edge.to.r), std::abs(edge.from.g - edge.to.g),
                         std::abs(edge.from.b - edge.to.b), std::abs(edge.from.a - edge.to.a)};
  edge.most_apart = 255 * *std::ranges::max_element(apart);
  edge.sum_apart = 255 * (apart[0] + apart[1] + apart[2] + apart[3]);
  edge.is_opaque = std::min(edge.from.a, edge.to.a) > 1 - kRounding;
  edge.is_on_line = is_on_line(edge);
  return edge;
}

// Whether values between the two sides give the colours between them.
bool MixtureColours::is_on_line(const Edge& edge) {
  const auto is_near = [](float a, float b) { return std::abs(a - b) < kRounding; };
  constexpr std::array<std::uint8_t, 3> kValues{51, 128, 204};
  return std::ranges::all_of(kValues, [&](std::uint8_t value) {
    const Paint mixture = mixture_with({value, static_cast<std::uint8_t>(255 - value)});
    const float share = static_cast<float>(value) / 255;
    const Paint between = edge.between(share);
    return is_near(mixture.r, between.r) && is_near(mixture.g, between.g) &&
           is_near(mixture.b, between.b) && is_near(mixture.a, between.a);
  });
}

void MixtureColours::set_steps(int most_change) {
  std::uint32_t colours = 0;
  for (Edge& edge : edges_) {
    const auto steps = std::ceil(edge.most_apart / static_cast<float>(2 * most_change));
    edge.steps = static_cast<std::uint32_t>(std::max(1.0f, steps));
    edge.step = 1.0f / static_cast<float>(edge.steps);
    edge.first_step = colours;
    colours += edge.steps + 1;
  }
  step_colours_.assign(colours, kNone);
}

std::uint32_t MixtureColours::colour_along(const Edge& edge, std::uint8_t value) {
  const std::uint32_t step = edge.nearest_step(value);
  std::uint32_t& colour = step_colours_[edge.first_step + step];
  if (colour == kNone) {
    const Paint mixture = edge.between(static_cast<float>(step) * edge.step);
    const bool is_side = step == 0 || step == edge.steps;
    colour = colours_.number_of(to_rgba(mixture), is_side ? Origin::flat : Origin::edge);
  }
  return colour;
}

// Where a colour lets others through, its opacity is rounded apart from what it is made of, which
// then moves by up to a whole value of 255 instead of half of one.
bool MixtureColours::is_close_once_rounded(const Edge& edge, std::uint8_t value) {
  const float exact = static_cast<float>(value) / 255;
  const float share = edge.nearest_share(value);
  if (edge.is_opaque || edge.most_apart * std::abs(share - exact) <= kMostChange - 1) return true;
  const Channels one = channels_of(to_rgba(edge.between(share)));
  const Channels other = channels_of(to_rgba(edge.between(exact)));
  return difference(one, other).most <= kMostChange;
}

Rgba MixtureColours::exact_colour(std::size_t mixture) {
  Kind& kind = kinds_[mixture];
  if (!kind.is_exact_known) {
    take_values(mixture);
    kind.exact = to_rgba(mixture_at_hand());
    kind.is_exact_known = true;
  }
  return kind.exact;
}

std::array<std::uint8_t, 2> MixtureColours::exchange_values(std::array<std::uint8_t, 2> values) {
  for (std::size_t i = 0; i < partial_.size(); ++i) std::swap(values_[partial_[i]], values[i]);
  return values;
}

Paint MixtureColours::mixture_with(std::array<std::uint8_t, 2> values) {
  const auto were = exchange_values(values);
  const Paint mixture = mixture_at_hand();
  exchange_values(were);
  return mixture;
}

// Of the values at hand, over the background.
Paint MixtureColours::mixture_at_hand() const {
  Paint sum;
  for (const PictureParts::Layer& layer : parts_->layers()) sum = with_layer(layer, sum);
  return mixed(sum, 1, background_, 1.0f - sum.covered + sum.beneath);
}

Paint MixtureColours::with_layer(const PictureParts::Layer& layer, const Paint& below) const {
  const PaintedLayer& painted = *layer.painted;
  const auto opacity = static_cast<float>(painted.opacity);
  const bool is_separable = layer.lines.empty() || opacity == 1;
  if (layer.classes.size() > 1 || !is_separable) {
    return laid_over(layer, faded(of_layer(layer), opacity), below);
  }
  Paint sum = below;
  for (const PictureParts::Part& only : layer.classes) {
    const float share = share_of(only.channel);
    if (share == 0) continue;
    if (painted.pattern != nullptr) {
      const Paint fill = to_paint(only.colour, share);
      const Paint pattern = to_paint(painted.pattern_colour, share_of(layer.pattern));
      sum = laid_over(layer, faded(within(pattern, fill), opacity), sum);
    } else if (only.colour.a > 0) {
      sum = laid_over(layer, to_paint(only.colour, share, opacity), sum);
    }
  }
  return with_lines(layer, sum);
}

// The layer by itself.
Paint MixtureColours::of_layer(const PictureParts::Layer& layer) const {
  Paint sum;
  for (const PictureParts::Part& one : layer.classes) {
    const float share = share_of(one.channel);
    if (share == 0) continue;
    const Paint paint = to_paint(one.colour, share);
    sum = one.is_beneath ? added(paint, sum) : beside(paint, sum);
  }
  sum = settled(sum);
  if (layer.painted->pattern != nullptr) {
    const float share = share_of(layer.pattern);
    if (share > 0) sum = within(to_paint(layer.painted->pattern_colour, share), sum);
  }
  return with_lines(layer, sum);
}

Paint MixtureColours::with_lines(const PictureParts::Layer& layer, Paint sum) const {
  for (const PictureParts::Part& line : layer.lines) {
    const float share = share_of(line.channel);
    if (share > 0) sum = over(to_paint(line.colour, share), sum);
  }
  return sum;
}

Paint MixtureColours::laid_over(const PictureParts::Layer& layer, const Paint& above,
                                const Paint& below) const {
  const Meeting meeting = meeting_of(layer);
  return meeting.relation == 0 ? over(above, below) : over(above, below, meeting);
}

// Of relation 0 if there is none.
Meeting MixtureColours::meeting_of(const PictureParts::Layer& layer) const {
  if (layer.meeting == PictureParts::kNone) return {};
  return {0, static_cast<std::int8_t>(values_[layer.meeting]), values_[layer.meeting + 1]};
}

}  // namespace trapeze
