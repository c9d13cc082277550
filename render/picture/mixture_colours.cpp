#include "render/picture/mixture_colours.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "render/picture/channels.h"

namespace trapeze {
namespace {

constexpr float kRounding = 0.1f / 255;

constexpr std::size_t kBytes = sizeof(std::uint64_t);
constexpr std::uint64_t kLowBits = 0x7f7f7f7f7f7f7f7f;  // all but the highest bit of each byte

/// The highest bits of those bytes that are neither 0 nor 255.
std::uint64_t partial_bytes(std::uint64_t bytes) {
  const std::uint64_t changes = (bytes ^ bytes >> 1) & kLowBits;  // between adjacent bits
  return (changes + kLowBits) & ~kLowBits;
}

/// The highest bits of those bytes that are not 0.
std::uint64_t nonzero_bytes(std::uint64_t bytes) {
  return (((bytes & kLowBits) + kLowBits) | bytes) & ~kLowBits;
}

void set_highest_bit(std::size_t byte, std::span<std::uint64_t> words) {
  words[byte / kBytes] |= std::uint64_t{0x80} << byte % kBytes * 8;
}

/// Whether the layer consists of lines over at most one class, each of which is drawn over the
/// layers below independently of the others.
bool is_plain(const PictureParts::Layer& layer) {
  const PaintedLayer& painted = *layer.painted;
  const bool is_separable = layer.lines.empty() || painted.opacity == 1;
  return layer.classes.size() <= 1 && is_separable && painted.pattern == nullptr;
}

/// Draws a plain layer over the paint below it, without known relations. share_of(channel) is a
/// Number.
template <typename Number, typename ShareOf>
PaintOf<Number> with_plain_layer(const PictureParts::Layer& layer, PaintOf<Number> sum,
                                 const ShareOf& share_of) {
  const auto opacity = static_cast<float>(layer.painted->opacity);
  for (const PictureParts::Part& only : layer.classes) {
    if (only.colour.a == 0) continue;
    sum = over(to_paint(only.colour, Number(share_of(only.channel)), opacity), sum);
  }
  for (const PictureParts::Part& line : layer.lines) {
    sum = over(to_paint(line.colour, Number(share_of(line.channel))), sum);
  }
  return sum;
}

/// All layers over the background.
template <typename Number>
PaintOf<Number> over_background(const PaintOf<Number>& sum, const PaintOf<Number>& background) {
  return mixed(sum, 1.0f, background, 1.0f - sum.covered + sum.beneath);
}

// Several mixtures at the same time, using the vector extensions of g++ and clang: the same
// operations in the same order, so the colours are the same as one by one.
constexpr std::size_t kLanes = 4;
using Floats __attribute__((vector_size(kLanes * sizeof(float)))) = float;
using Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t)))) = std::int32_t;

PaintOf<Floats> in_all_lanes(const Paint& paint) {
  const auto in_all = [](float number) { return Floats{} + number; };
  return {in_all(paint.r),       in_all(paint.g),       in_all(paint.b),      in_all(paint.a),
          in_all(paint.covered), in_all(paint.beneath), in_all(paint.classes)};
}

std::array<Rgba, kLanes> to_rgba(const PaintOf<Floats>& paint) {
  const Floats scale = 1.0f / paint.a;  // ignored where it is transparent
  const auto to_bytes = [](Floats shares) {
    return __builtin_convertvector(to_byte_and_half(shares), Ints);
  };
  const Ints r = to_bytes(paint.r * scale);
  const Ints g = to_bytes(paint.g * scale);
  const Ints b = to_bytes(paint.b * scale);
  const Ints a = to_bytes(paint.a);
  std::array<Rgba, kLanes> colours;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto byte = [i](Ints bytes) { return static_cast<std::uint8_t>(bytes[i]); };
    colours[i] = a[i] == 0 ? kTransparent : Rgba{byte(r), byte(g), byte(b), byte(a)};
  }
  return colours;
}

}  // namespace

void MixtureColours::begin(const PictureParts& parts, const Mixtures& mixtures, Rgba background) {
  parts_ = &parts;
  mixtures_ = &mixtures;
  background_ = to_paint(background, 1.0f);
  are_layers_plain_ = std::ranges::all_of(parts.layers(), is_plain);
  channel_bits_.assign(mixtures.words_each, 0);
  relation_bits_.assign(mixtures.words_each, 0);
  const std::size_t channels = parts.channel_count();
  for (std::size_t i = 1; i < channels; ++i) set_highest_bit(i, channel_bits_);
  for (std::size_t i = channels; i < parts.value_count(); i += 2) {
    set_highest_bit(i, relation_bits_);
  }
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
  colours_.resize(kinds_.size());
  origins_.resize(kinds_.size());
  if (most_change > 0) set_steps(most_change);
  wanted_.clear();
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    const Kind& kind = kinds_[i];
    const bool is_exact = most_change == 0 || kind.edge == kNone ||
                          !is_close_once_rounded(edges_[kind.edge], kind.value);
    if (!is_exact) {
      colour_along(edges_[kind.edge], i);
    } else if (kind.is_exact_known) {
      set_exact(i, kind.exact);
    } else if (are_layers_plain_ && !kind.has_meetings) {
      wanted_.push_back(static_cast<std::uint32_t>(i));
    } else {
      values_ = mixtures_->values_of(i);
      set_exact(i, to_rgba(mixture_at_hand()));
    }
  }
  find_exact_in_lanes(wanted_);
}

void MixtureColours::set_exact(std::size_t mixture, Rgba colour) {
  Kind& kind = kinds_[mixture];
  kind.exact = colour;
  kind.is_exact_known = true;
  colours_[mixture] = colour;
  origins_[mixture] = kind.origin;
}

// For mixtures without meetings, of plain layers.
void MixtureColours::find_exact_in_lanes(std::span<const std::uint32_t> mixtures) {
  const PaintOf<Floats> background = in_all_lanes(background_);
  std::array<const std::uint8_t*, kLanes> values{};
  const auto share_of = [&values](std::uint32_t channel) {
    const Ints here{values[0][channel], values[1][channel], values[2][channel], values[3][channel]};
    return __builtin_convertvector(here, Floats) / 255.0f;
  };
  for (std::size_t first = 0; first < mixtures.size(); first += kLanes) {
    // Unused lanes repeat the last mixture.
    const auto in_lane = [&](std::size_t i) {
      return mixtures[std::min(first + i, mixtures.size() - 1)];
    };
    for (std::size_t i = 0; i < kLanes; ++i) values[i] = mixtures_->values_of(in_lane(i));
    PaintOf<Floats> sum;
    for (const PictureParts::Layer& layer : parts_->layers()) {
      sum = with_plain_layer(layer, sum, share_of);
    }
    const std::array colours = to_rgba(over_background(sum, background));
    for (std::size_t i = 0; i < kLanes; ++i) set_exact(in_lane(i), colours[i]);
  }
}

MixtureColours::Kind MixtureColours::kind_of(std::size_t mixture) {
  take_values(mixture);
  Kind kind;
  kind.has_meetings = meeting_count_ > 0;
  kind.origin = partial_count_ == 0 && !kind.has_meetings ? Origin::flat : Origin::mixed;
  if (!is_edge_at_hand()) return kind;
  const std::uint32_t edge = edge_at_hand();
  if (!edges_[edge].is_on_line) return kind;
  kind.edge = edge;
  kind.value = values_[partial_[0]];
  return kind;
}

void MixtureColours::take_values(std::size_t mixture) {
  values_ = mixtures_->values_of(mixture);
  partial_count_ = 0;
  meeting_count_ = 0;
  const std::size_t first_word = mixture * mixtures_->words_each;
  for (std::size_t i = 0; i < mixtures_->words_each; ++i) {
    const std::uint64_t word = mixtures_->words[first_word + i];
    for (std::uint64_t rest = partial_bytes(word) & channel_bits_[i]; rest != 0; rest &= rest - 1) {
      const auto byte = static_cast<std::size_t>(std::countr_zero(rest)) / 8;
      if (partial_count_ < partial_.size()) {
        partial_[partial_count_] = static_cast<std::uint32_t>(i * kBytes + byte);
      }
      ++partial_count_;
    }
    for (std::uint64_t rest = nonzero_bytes(word) & relation_bits_[i]; rest != 0;
         rest &= rest - 1) {
      ++meeting_count_;
    }
  }
}

bool MixtureColours::is_edge_at_hand() const {
  if (partial_count_ == 1) return meeting_count_ == 0;
  if (partial_count_ != 2 || meeting_count_ > 1) return false;
  const int both = values_[partial_[0]] + values_[partial_[1]];
  if (std::abs(both - 255) > 1) return false;
  if (meeting_count_ == 0) return true;
  return std::ranges::all_of(parts_->layers(), [this](const PictureParts::Layer& layer) {
    const std::int8_t relation = meeting_of(layer).relation;
    return relation == 0 || relation == Meeting::kSideBySide;
  });
}

// The key of an edge consists of all values except those of the masks that have the edge, which are
// replaced by values that occur in no mixture.
std::uint32_t MixtureColours::edge_at_hand() {
  const std::size_t size = mixtures_->words_each;
  words_.resize(size);
  std::memcpy(words_.data(), values_, size * sizeof words_[0]);
  values_ = reinterpret_cast<const std::uint8_t*>(words_.data());
  const auto values = exchange_values({1, 2});
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

// Whether values between the two sides give colours on the line between them.
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
  step_mixtures_.assign(colours, kNone);
}

void MixtureColours::colour_along(const Edge& edge, std::size_t mixture) {
  const std::uint32_t step = edge.nearest_step(kinds_[mixture].value);
  std::uint32_t& first = step_mixtures_[edge.first_step + step];
  if (first == kNone) {
    first = static_cast<std::uint32_t>(mixture);
    colours_[mixture] = to_rgba(edge.between(static_cast<float>(step) * edge.step));
    const bool is_side = step == 0 || step == edge.steps;
    origins_[mixture] = is_side ? Origin::flat : Origin::edge;
  }
  colours_[mixture] = colours_[first];
  origins_[mixture] = origins_[first];
}

// In translucent colours, the opacity is rounded separately from the premultiplied channels, which
// may then change by up to a whole unit of 255 instead of half of one.
bool MixtureColours::is_close_once_rounded(const Edge& edge, std::uint8_t value) {
  const float exact = static_cast<float>(value) / 255;
  const float share = edge.nearest_share(value);
  if (edge.is_opaque || edge.most_apart * std::abs(share - exact) <= kMostChange - 1) return true;
  const Channels one = channels_of(to_rgba(edge.between(share)));
  const Channels other = channels_of(to_rgba(edge.between(exact)));
  return difference(one, other).most <= kMostChange;
}

// In the copy of the current values.
std::array<std::uint8_t, 2> MixtureColours::exchange_values(std::array<std::uint8_t, 2> values) {
  auto* copy = reinterpret_cast<std::uint8_t*>(words_.data());
  for (std::size_t i = 0; i < partial_count_; ++i) std::swap(copy[partial_[i]], values[i]);
  return values;
}

Paint MixtureColours::mixture_with(std::array<std::uint8_t, 2> values) {
  const auto were = exchange_values(values);
  const Paint mixture = mixture_at_hand();
  exchange_values(were);
  return mixture;
}

// For the current values, over the background.
Paint MixtureColours::mixture_at_hand() const {
  Paint sum;
  for (const PictureParts::Layer& layer : parts_->layers()) sum = with_layer(layer, sum);
  return over_background(sum, background_);
}

Paint MixtureColours::with_layer(const PictureParts::Layer& layer, const Paint& below) const {
  if (is_plain(layer) && meeting_of(layer).relation == 0) {
    return with_plain_layer(layer, below, [this](std::uint32_t i) { return share_of(i); });
  }
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

// With relation 0 if there is none.
Meeting MixtureColours::meeting_of(const PictureParts::Layer& layer) const {
  if (layer.meeting == PictureParts::kNone) return {};
  return {0, static_cast<std::int8_t>(values_[layer.meeting]), values_[layer.meeting + 1]};
}

}  // namespace trapeze
