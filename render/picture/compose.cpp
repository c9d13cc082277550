#include "render/picture/compose.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "render/mask/row_bits.h"
#include "render/picture/number_table.h"

namespace trapeze {
namespace {

// With more than so many colours, along edges and in the lattice, no other way gets them into a
// palette: none is tried, for it takes time.
constexpr std::size_t kMostToGather = 2 * kPaletteColours;

// What one or several layers show of a pixel. Colours are premultiplied; all from 0 to 1.
struct Paint {
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 0;
  float covered = 0;  // how much of the pixel they cover, however transparent they are
  float beneath = 0;  // how much of it shows what lies beneath them through what they cover
  float classes = 0;  // within a layer only: how many there are
};

// Of something that covers that share of the pixel.
Paint to_paint(Rgba colour, float share, float opacity = 1) {
  const float a = static_cast<float>(colour.a) / 255.0f * share * opacity;
  const float scale = a / 255.0f;
  return {static_cast<float>(colour.r) * scale, static_cast<float>(colour.g) * scale,
          static_cast<float>(colour.b) * scale, a, share};
}

// The colours of one times a factor, and those of the other times a factor; the rest is that of the
// other.
Paint mixed(const Paint& one, float of_one, const Paint& other, float of_other) {
  Paint sum = other;
  sum.r = one.r * of_one + other.r * of_other;
  sum.g = one.g * of_one + other.g * of_other;
  sum.b = one.b * of_one + other.b * of_other;
  sum.a = one.a * of_one + other.a * of_other;
  return sum;
}

Paint faded(const Paint& paint, float opacity) {
  Paint fainter = mixed(paint, opacity, {}, 0);
  fainter.covered = paint.covered;
  return fainter;
}

// Lays a paint over another one that covers the same places as often as chance has it.
Paint over(const Paint& above, const Paint& below) {
  Paint sum = mixed(above, 1, below, 1.0f - above.a);
  sum.covered = above.covered + below.covered * (1.0f - above.covered);
  sum.beneath =
      below.beneath * (1.0f - above.a) + (1.0f - below.covered) * (above.covered - above.a);
  return sum;
}

// How two layers that meet in a pixel share it.
template <typename Number>
struct Shares {
  Number covered = 0;  // by the lower one, and what it goes on below the upper one
  Number common = 0;   // by both
};

template <typename Number>
Shares<Number> shares_of(Number below, Number above, const Meeting& meeting) {
  const auto common_of = [&](Number covered) {
    const Number chance = covered * above;
    const Number relation = static_cast<Number>(meeting.relation) / Meeting::kNested;
    if (relation < 0) {
      const Number least = std::max(Number{0}, above + covered - 1);
      return chance + relation * (chance - least);
    }
    return chance + relation * (std::min(above, covered) - chance);
  };
  const Number neither = std::max(Number{0}, 1 - above - below + common_of(below));
  const Number covered = below + neither * static_cast<Number>(meeting.gap) / 255;
  return {covered, common_of(covered)};
}

// Lays a paint over another one, of which it is known how they lie in the pixel.
Paint over(const Paint& above, const Paint& below, const Meeting& meeting) {
  if (above.covered == 0 || below.covered == 0) return over(above, below);
  const auto [covered, common] = shares_of(below.covered, above.covered, meeting);
  const float opacity = above.a / above.covered;
  const float left = (1.0f - opacity * common / covered) * covered / below.covered;
  Paint sum = mixed(above, 1, below, left);
  sum.covered = above.covered + covered - common;
  sum.beneath = below.beneath * left + (above.covered - common) * (1.0f - opacity);
  return sum;
}

// Adds what shines of a class through others.
Paint added(const Paint& one, const Paint& other) {
  return mixed(one, 1, other, 1);
}

// Adds a class that lies beside others.
Paint beside(const Paint& one, const Paint& other) {
  Paint sum = added(one, other);
  sum.covered += one.covered;
  sum.classes += 1;
  return sum;
}

// A pattern's paint, wherever the classes below it are.
Paint within(const Paint& above, const Paint& below) {
  return mixed(above, below.covered, below, 1.0f - above.a);
}

// Where classes overlap, each has its share. And where they join, each value was rounded; the pixel
// is wholly covered all the same.
Paint settled(const Paint& sum) {
  constexpr float kHalfValue = 0.501f / 255;  // and what the sum lost in rounding
  const bool is_whole = sum.classes > 1 && sum.covered > 1 - kHalfValue * sum.classes;
  if (!is_whole && sum.covered <= 1) return sum;
  Paint paint = mixed(sum, 1 / sum.covered, {}, 0);
  paint.covered = 1;
  return paint;
}

std::uint8_t to_byte(float share) {
  return static_cast<std::uint8_t>(std::clamp(share, 0.0f, 1.0f) * 255.0f + 0.5f);
}

Rgba to_rgba(const Paint& paint) {
  const std::uint8_t a = to_byte(paint.a);
  if (a == 0) return kTransparent;
  const float scale = 1.0f / paint.a;
  return {to_byte(paint.r * scale), to_byte(paint.g * scale), to_byte(paint.b * scale), a};
}

/// Which values of which masks a run of pixels shows, and how layers meet in it, as far as that
/// fits into sixteen bytes.
struct MixtureKey {
  std::uint64_t low = 0;
  std::uint64_t high = 0;

  static constexpr std::size_t kBytes = 16;

  /// Sets a byte that is 0.
  void set(std::size_t byte, std::uint8_t value) { change(byte, 0, value); }
  void change(std::size_t byte, std::uint8_t from, std::uint8_t to) {
    const std::uint64_t bits = std::uint64_t{static_cast<std::uint8_t>(from ^ to)} << byte % 8 * 8;
    (byte < 8 ? low : high) ^= bits;
  }
  friend bool operator==(const MixtureKey&, const MixtureKey&) = default;
  std::uint64_t hash() const {
    return low * 0x9e3779b97f4a7c15 ^ std::rotl(high * 0xc2b2ae3d27d4eb4f, 29);
  }
};

void require_size(const Mask* mask, int width, int height) {
  if (mask == nullptr) return;
  if (mask->width() != width || mask->height() != height) {
    throw std::invalid_argument("a mask is not as large as the picture");
  }
}

}  // namespace

// Goes through a picture run by run. A run ends where a mask changes.
class Composer::Painter {
 public:
  /// Along edges, channels are at most so far from the exact ones; all are exact if that is 0.
  void paint(std::span<const PaintedLayer> layers, int width, int height, Rgba background,
             int most_change, RunPicture& picture) {
    picture.width = width;
    picture.height = height;
    picture.colours.clear();
    picture.origins.clear();
    picture.runs.clear();
    picture.row_end.clear();
    picture_ = &picture;
    background_ = to_paint(background, 1);
    columns_ = static_cast<std::size_t>(width);
    numbers_.clear();
    colours_.clear();
    edges_.clear();
    edge_numbers_.clear();
    step_colours_.clear();
    change_ = 0;
    most_change_ = most_change;
    begin(layers, height);
    changes_.resize(words_for(columns_));
    covered_.resize(words_for(columns_));
    for (int row = 0; row < height; ++row) paint_row(row);
  }

  /// Of all channels of all pixels that were painted last, along edges.
  double change() const { return change_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::uint32_t kWhole = 0;  // the channel of what covers every pixel wholly

  // A mask, and its values in the run at hand.
  struct Channel {
    const Mask* mask = nullptr;
    const std::uint8_t* row = nullptr;
    std::uint8_t value = 0;
  };
  // A class of a layer, or one of its lines.
  struct Part {
    Rgba colour;
    bool is_beneath = false;
    std::uint32_t channel = kWhole;
  };
  struct LayerParts {
    const PaintedLayer* layer = nullptr;
    std::vector<Part> classes;
    std::vector<Part> lines;
    std::uint32_t pattern = kWhole;
    std::size_t next_meeting = 0;      // the first that is not in a row before
    const Meeting* meeting = nullptr;  // in the run at hand; null: none
  };

  void begin(std::span<const PaintedLayer> layers, int height) {
    channels_.assign(1, Channel{nullptr, nullptr, 255});
    layer_count_ = layers.size();
    if (layers_.size() < layer_count_) layers_.resize(layer_count_);
    std::size_t meeting_layers = 0;
    const auto channel_of = [&](const Mask* mask) {
      if (mask == nullptr) return kWhole;
      require_size(mask, static_cast<int>(columns_), height);
      channels_.push_back({mask});
      return static_cast<std::uint32_t>(channels_.size() - 1);
    };
    for (std::size_t k = 0; k < layer_count_; ++k) {
      LayerParts& parts = layers_[k];
      parts.layer = &layers[k];
      parts.classes.clear();
      parts.lines.clear();
      parts.next_meeting = 0;
      parts.meeting = nullptr;
      for (const PaintedClass& one : layers[k].classes) {
        parts.classes.push_back({one.colour, one.is_beneath, channel_of(one.mask)});
      }
      for (const PaintedClass& one : layers[k].lines) {
        parts.lines.push_back({one.colour, false, channel_of(one.mask)});
      }
      parts.pattern = channel_of(layers[k].pattern);
      meeting_layers += layers[k].meetings.empty() ? 0 : 1;
    }
    partial_.resize(channels_.size());
    // The first channel never changes.
    are_keys_short_ = channels_.size() - 1 + 2 * meeting_layers <= MixtureKey::kBytes;
  }

  void paint_row(int row) {
    std::fill(changes_.begin(), changes_.end(), 0);
    changes_[0] = 1;
    there_.clear();
    has_meetings_ = false;
    for (std::size_t k = 0; k < layer_count_; ++k) mark_layer(layers_[k], row);
    const std::size_t first_pixel = static_cast<std::size_t>(row) * columns_;
    // The run that began last ends where the next one begins.
    std::size_t begin = 0;
    std::uint32_t colour = kNone;
    const auto end_run = [&](std::size_t end) {
      if (colour == kNone) return;
      change_ += static_cast<double>(change_at_hand_) * static_cast<double>(end - begin);
    };
    for (std::size_t word = 0; word < changes_.size(); ++word) {
      for (std::uint64_t bits = changes_[word]; bits != 0; bits &= bits - 1) {
        const std::size_t column = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
        end_run(column);
        const std::uint32_t next = colour_at(column, first_pixel + column);
        if (next != colour && colour != kNone) {
          picture_->runs.push_back({static_cast<std::uint32_t>(column), colour});
        }
        begin = column;
        colour = next;
      }
    }
    end_run(columns_);
    picture_->runs.push_back({static_cast<std::uint32_t>(columns_), colour});
    picture_->row_end.push_back(static_cast<std::uint32_t>(picture_->runs.size()));
  }

  // Marks where the run at hand may end for what the layer shows in the row.
  void mark_layer(LayerParts& parts, int row) {
    for (const Part& part : parts.classes) mark(part.channel, row, changes_);
    for (const Part& part : parts.lines) mark(part.channel, row, changes_);
    if (parts.pattern != kWhole) mark_pattern(parts, row);
    const auto meetings = parts.layer->meetings;
    const std::size_t end = (static_cast<std::size_t>(row) + 1) * columns_;
    const std::size_t begin = end - columns_;
    std::size_t& next = parts.next_meeting;
    while (next < meetings.size() && meetings[next].pixel < begin) ++next;
    parts.meeting = nullptr;
    for (std::size_t i = next; i < meetings.size() && meetings[i].pixel < end; ++i) {
      has_meetings_ = true;
      const std::size_t column = meetings[i].pixel - begin;
      changes_[column / 64] |= std::uint64_t{1} << column % 64;
      if (column + 1 < columns_) {
        changes_[(column + 1) / 64] |= std::uint64_t{1} << (column + 1) % 64;
      }
    }
  }

  void mark(std::uint32_t number, int row, std::span<std::uint64_t> bits) {
    Channel& channel = channels_[number];
    if (number == kWhole) return;
    channel.row = channel.mask->row_begin(row);
    channel.value = 0;
    const bool has_changes = mark_changes({channel.row, columns_}, bits);
    if (has_changes || channel.row[0] != 0) there_.push_back(number);
  }

  // A pattern matters only where the layer covers something.
  void mark_pattern(LayerParts& parts, int row) {
    std::fill(covered_.begin(), covered_.end(), 0);
    for (const Part& part : parts.classes) {
      if (part.channel == kWhole) {
        std::fill(covered_.begin(), covered_.end(), ~std::uint64_t{0});
      } else {
        mark_covered({channels_[part.channel].row, columns_}, covered_);
      }
    }
    pattern_changes_.assign(changes_.size(), 0);
    mark(parts.pattern, row, pattern_changes_);
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      changes_[i] |= pattern_changes_[i] & covered_[i];
    }
  }

  std::uint32_t colour_at(std::size_t column, std::size_t pixel) {
    change_at_hand_ = 0;
    partial_count_ = 0;
    MixtureKey key;
    for (const std::uint32_t number : there_) {
      Channel& channel = channels_[number];
      const std::uint8_t value = channel.row[column];
      channel.value = value;
      if (are_keys_short_) key.set(number - 1, value);
      if (!is_whole(value)) partial_[partial_count_++] = number;
    }
    meeting_count_ = 0;
    if (has_meetings_) meet(pixel, key);
    if (!are_keys_short_) return add_colour();
    if (most_change_ > 0 && partial_count_ > 0) {
      const std::uint32_t along_edge = colour_along_edge(key);
      if (along_edge != kNone) return along_edge;
    }
    std::uint32_t& known = numbers_[key];
    if (known == NumberTable<MixtureKey>::kNone) known = add_colour();
    return known;
  }

  static bool is_whole(std::uint8_t value) { return static_cast<std::uint8_t>(value + 1) <= 1; }

  // Finds the meetings in the run at hand, which are a part of the key.
  void meet(std::size_t pixel, MixtureKey& key) {
    std::size_t byte = channels_.size() - 1;
    for (std::size_t k = 0; k < layer_count_; ++k) {
      LayerParts& parts = layers_[k];
      if (parts.layer->meetings.empty()) continue;
      parts.meeting = meeting_at(parts, pixel);
      if (parts.meeting != nullptr) {
        ++meeting_count_;
        if (are_keys_short_) {
          key.set(byte, static_cast<std::uint8_t>(parts.meeting->relation));
          key.set(byte + 1, parts.meeting->gap);
        }
      }
      byte += 2;
    }
  }

  static const Meeting* meeting_at(LayerParts& parts, std::size_t pixel) {
    const auto meetings = parts.layer->meetings;
    std::size_t& next = parts.next_meeting;
    while (next < meetings.size() && meetings[next].pixel < pixel) ++next;
    return next < meetings.size() && meetings[next].pixel == pixel ? &meetings[next] : nullptr;
  }

  std::uint32_t add_colour() {
    const bool is_flat = partial_count_ == 0 && meeting_count_ == 0;
    return number_of(to_rgba(mixture_at_hand()), is_flat ? Origin::flat : Origin::mixed);
  }

  std::uint32_t number_of(Rgba colour, Origin origin) {
    std::uint32_t& number = colours_[ColourKey(colour)];
    if (number == NumberTable<ColourKey>::kNone) {
      number = static_cast<std::uint32_t>(picture_->colours.size());
      picture_->colours.push_back(colour);
      picture_->origins.push_back(origin);
    }
    picture_->origins[number] = std::min(picture_->origins[number], origin);
    return number;
  }

  // An edge is where one mask has a part of the pixel, or where two lie side by side and have all
  // of it together. Whatever the others show, colours go in even steps from one side to the other.
  struct Edge {
    Paint from;
    Paint to;
    std::uint32_t steps = 0;       // 0: colours between them are not on a line
    float step = 0;                // its share
    std::uint32_t first_step = 0;  // index of its colour in step_colours_
    float difference = 0;          // of both sides: the sum of the channels, of 255
  };

  bool is_edge_at_hand() const {
    if (partial_count_ == 1) return meeting_count_ == 0;
    if (partial_count_ != 2 || meeting_count_ > 1) return false;
    const int both = channels_[partial_[0]].value + channels_[partial_[1]].value;
    if (std::abs(both - 255) > 1) return false;
    for (std::size_t k = 0; k < layer_count_ && meeting_count_ > 0; ++k) {
      const Meeting* meeting = layers_[k].meeting;
      if (meeting != nullptr && meeting->relation != Meeting::kSideBySide) return false;
    }
    return true;
  }

  // kNone if there is no edge at hand.
  std::uint32_t colour_along_edge(MixtureKey key) {
    if (!is_edge_at_hand()) return kNone;
    const std::uint32_t value = channels_[partial_[0]].value;
    // With values that no flat colour's key has.
    for (std::size_t i = 0; i < partial_count_; ++i) {
      key.change(partial_[i] - 1, channels_[partial_[i]].value, static_cast<std::uint8_t>(i + 1));
    }
    const Edge& edge = edge_of(key);
    if (edge.steps == 0) return kNone;
    const std::uint32_t step = (2 * value * edge.steps + 255) / 510;
    const float share = static_cast<float>(step) * edge.step;
    change_at_hand_ = edge.difference * std::abs(share - static_cast<float>(value) / 255);
    std::uint32_t& colour = step_colours_[edge.first_step + step];
    if (colour == kNone) {
      const Paint mixture = mixed(edge.to, share, edge.from, 1 - share);
      const bool is_side = step == 0 || step == edge.steps;
      colour = number_of(to_rgba(mixture), is_side ? Origin::flat : Origin::edge);
    }
    return colour;
  }

  const Edge& edge_of(const MixtureKey& key) {
    std::uint32_t& number = edge_numbers_[key];
    if (number != NumberTable<MixtureKey>::kNone) return edges_[number];
    number = static_cast<std::uint32_t>(edges_.size());
    Edge edge{mixture_with({0, 255}), mixture_with({255, 0})};
    const std::array apart{std::abs(edge.from.r - edge.to.r), std::abs(edge.from.g - edge.to.g),
                           std::abs(edge.from.b - edge.to.b), std::abs(edge.from.a - edge.to.a)};
    edge.difference = 255 * (apart[0] + apart[1] + apart[2] + apart[3]);
    if (is_on_line(edge)) {
      const float most = 255 * *std::ranges::max_element(apart);
      const auto steps = static_cast<int>(std::ceil(most / static_cast<float>(2 * most_change_)));
      edge.steps = static_cast<std::uint32_t>(std::max(1, steps));
      edge.step = 1.0f / static_cast<float>(edge.steps);
      edge.first_step = static_cast<std::uint32_t>(step_colours_.size());
      step_colours_.resize(step_colours_.size() + edge.steps + 1, kNone);
    }
    return edges_.emplace_back(edge);
  }

  // Whether values between the two sides give the colours between them.
  bool is_on_line(const Edge& edge) {
    constexpr float kRounding = 0.1f / 255;
    const auto is_near = [](float a, float b) { return std::abs(a - b) < kRounding; };
    constexpr std::array<std::uint8_t, 3> kValues{51, 128, 204};
    return std::ranges::all_of(kValues, [&](std::uint8_t value) {
      const Paint mixture = mixture_with({value, static_cast<std::uint8_t>(255 - value)});
      const float share = static_cast<float>(value) / 255;
      const Paint between = mixed(edge.to, share, edge.from, 1 - share);
      return is_near(mixture.r, between.r) && is_near(mixture.g, between.g) &&
             is_near(mixture.b, between.b) && is_near(mixture.a, between.a);
    });
  }

  using EdgeValues = std::array<std::uint8_t, 2>;

  Paint mixture_with(EdgeValues values) {
    const EdgeValues were = exchange_values(values);
    const Paint mixture = mixture_at_hand();
    exchange_values(were);
    return mixture;
  }

  EdgeValues exchange_values(EdgeValues values) {
    for (std::size_t i = 0; i < partial_count_; ++i) {
      std::swap(channels_[partial_[i]].value, values[i]);
    }
    return values;
  }

  // Of the values and meetings at hand, over the background.
  Paint mixture_at_hand() const {
    Paint sum;
    for (std::size_t k = 0; k < layer_count_; ++k) sum = with_layer(layers_[k], sum);
    return mixed(sum, 1, background_, 1.0f - sum.covered + sum.beneath);
  }

  Paint with_layer(const LayerParts& parts, const Paint& below) const {
    const auto opacity = static_cast<float>(parts.layer->opacity);
    const bool is_separable = parts.lines.empty() || opacity == 1;
    if (parts.classes.size() > 1 || !is_separable) {
      const Paint together = faded(of_layer(parts), opacity);
      return laid_over(together, below, parts.meeting);
    }
    Paint sum = below;
    for (const Part& only : parts.classes) {
      const float share = share_of(only.channel);
      if (share == 0) continue;
      if (parts.layer->pattern != nullptr) {
        const Paint fill = to_paint(only.colour, share);
        const Paint pattern = to_paint(parts.layer->pattern_colour, share_of(parts.pattern));
        sum = laid_over(faded(within(pattern, fill), opacity), sum, parts.meeting);
      } else if (only.colour.a > 0) {
        sum = laid_over(to_paint(only.colour, share, opacity), sum, parts.meeting);
      }
    }
    return with_lines(parts, sum);
  }

  // The layer by itself.
  Paint of_layer(const LayerParts& parts) const {
    Paint sum;
    for (const Part& one : parts.classes) {
      const float share = share_of(one.channel);
      if (share == 0) continue;
      const Paint paint = to_paint(one.colour, share);
      sum = one.is_beneath ? added(paint, sum) : beside(paint, sum);
    }
    sum = settled(sum);
    if (parts.layer->pattern != nullptr) {
      const float share = share_of(parts.pattern);
      if (share > 0) sum = within(to_paint(parts.layer->pattern_colour, share), sum);
    }
    return with_lines(parts, sum);
  }

  Paint with_lines(const LayerParts& parts, Paint sum) const {
    for (const Part& line : parts.lines) {
      const float share = share_of(line.channel);
      if (share > 0) sum = over(to_paint(line.colour, share), sum);
    }
    return sum;
  }

  static Paint laid_over(const Paint& above, const Paint& below, const Meeting* meeting) {
    return meeting == nullptr ? over(above, below) : over(above, below, *meeting);
  }

  float share_of(std::uint32_t channel) const {
    return static_cast<float>(channels_[channel].value) / 255.0f;
  }

  RunPicture* picture_ = nullptr;
  Paint background_;
  std::size_t columns_ = 0;
  std::vector<Channel> channels_;
  std::vector<LayerParts> layers_;
  std::size_t layer_count_ = 0;
  bool are_keys_short_ = true;
  std::vector<std::uint32_t> there_;  // channels that have a value in the row, besides the first
  // By pixel of the row.
  std::vector<std::uint64_t> changes_;
  std::vector<std::uint64_t> pattern_changes_;
  std::vector<std::uint64_t> covered_;
  NumberTable<MixtureKey> numbers_;  // of colours
  int most_change_ = 0;
  NumberTable<MixtureKey> edge_numbers_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> step_colours_;  // of all edges; kNone: not met yet
  // Of the run at hand.
  std::vector<std::uint32_t> partial_;  // channels that have a part of the pixel
  std::size_t partial_count_ = 0;
  std::size_t meeting_count_ = 0;
  float change_at_hand_ = 0;
  bool has_meetings_ = false;  // in the row at hand
  double change_ = 0;
  NumberTable<ColourKey> colours_;
};

double covered_by(double below, double above, const Meeting& meeting) {
  const auto [covered, common] = shares_of(below, above, meeting);
  return above + covered - common;
}

std::vector<PaintedLayer> plain_layers(std::span<const PaintedClass> classes) {
  std::vector<PaintedLayer> layers(classes.size());
  for (std::size_t i = 0; i < classes.size(); ++i) layers[i].classes = classes.subspan(i, 1);
  return layers;
}

Composer::Composer() : painter_(std::make_unique<Painter>()) {}
Composer::~Composer() = default;
Composer::Composer(Composer&&) noexcept = default;
Composer& Composer::operator=(Composer&&) noexcept = default;

void Composer::compose(std::span<const PaintedLayer> layers, int width, int height, Rgba background,
                       Quality quality, RunPicture& picture) {
  const double most = 4 * kMostMeanChange * static_cast<double>(width) * height;
  // The sum of all changes.
  const auto paint = [&](int along_edges, int of_others, RunPicture& out) {
    painter_->paint(layers, width, height, background, along_edges, out);
    if (painter_->change() > most) return painter_->change();
    return painter_->change() + static_cast<double>(reducer_.reduce(out, of_others));
  };
  if (quality == Quality::exact) {
    paint(0, 0, picture);
    return;
  }
  int change = kMostChange;
  while (true) {
    const double sum = paint(change, change, picture);
    if (sum <= most) break;
    // The mean grows with the most.
    change = std::min(change - 1, static_cast<int>(change * most / sum));
  }
  const std::size_t colours = picture.colours.size();
  if (colours <= kPaletteColours || colours > kMostToGather) return;
  // Steps along edges take much of a palette: colours that are close to each other in this picture
  // may take less.
  const bool is_within = paint(0, kMostChange, other_) <= most;
  if (is_within && other_.colours.size() <= kPaletteColours) std::swap(picture, other_);
}

}  // namespace trapeze
