#include "render/picture/reduce_colours.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

/// A lattice of cells of channels; the centre of the first cell is 0.
class Lattice {
 public:
  explicit Lattice(int most_change) : step_(2 * most_change + 1) {
    for (std::size_t i = 0; i < middles_.size(); ++i) {
      middles_[i] = divided(static_cast<int>(i), step_) * step_;
    }
    // Opaque colours stay opaque, and no others become opaque.
    for (std::size_t a = 0; a < 255; ++a) opacities_[a] = std::min(middles_[a], 254);
    opacities_[255] = 255;
    distances_.fill(most_change + 1);
  }

  /// Opacities of flat colours attract those close to them, so that areas of constant opacity keep
  /// it. In case of a tie, the first one does.
  void attract(int opacity) {
    if (opacity == 255) return;
    for (int a = std::max(0, opacity - step_ / 2); a <= std::min(254, opacity + step_ / 2); ++a) {
      const auto i = static_cast<std::size_t>(a);
      if (std::abs(a - opacity) >= distances_[i]) continue;
      distances_[i] = std::abs(a - opacity);
      opacities_[i] = opacity;
    }
  }

  /// The centre of the cell.
  Channels middle_of(const Channels& channels) const {
    const int a = opacities_[static_cast<std::size_t>(channels.a)];
    return {std::min(middle(channels.r), a), std::min(middle(channels.g), a),
            std::min(middle(channels.b), a), a};
  }

 private:
  int middle(int value) const { return middles_[static_cast<std::size_t>(value)]; }

  int step_;
  std::array<int, 256> middles_{};
  std::array<int, 256> opacities_{};
  std::array<int, 256> distances_{};  // of opacities from the one that attracted them
};

/// For storage in a table of colours.
Rgba as_colour(const Channels& channels) {
  const auto byte = [](int channel) { return static_cast<std::uint8_t>(channel); };
  return {byte(channels.r), byte(channels.g), byte(channels.b), byte(channels.a)};
}

}  // namespace

/// Indexes colours by their channels, so that those close to a colour are found without examining
/// all.
class ColourReducer::Neighbourhood {
 public:
  Neighbourhood() { first_.fill(kNone); }

  /// Numbers are added in ascending order, from 0.
  void add(const Channels& channels) {
    std::uint32_t& first = first_[place_of(channels.r / kWidth, channels.g / kWidth)];
    next_.push_back(std::exchange(first, static_cast<std::uint32_t>(next_.size())));
  }

  /// Calls visit(number) for all colours none of whose channels differs by more than `reach`, and
  /// for some others. Removes those for which it returns false.
  template <typename Visit>
  void for_each_near(const Channels& channels, int reach, const Visit& visit) {
    const auto first_of = [reach](int channel) { return std::max(channel - reach, 0) / kWidth; };
    const auto last_of = [reach](int channel) { return std::min(channel + reach, 255) / kWidth; };
    for (int r = first_of(channels.r); r <= last_of(channels.r); ++r) {
      for (int g = first_of(channels.g); g <= last_of(channels.g); ++g) {
        std::uint32_t* link = &first_[place_of(r, g)];
        while (*link != kNone) {
          std::uint32_t& next = next_[*link];
          if (visit(*link)) {
            link = &next;
          } else {
            *link = next;
          }
        }
      }
    }
  }

 private:
  static constexpr int kWidth = 2 * kMostChange + 1;
  static constexpr int kSide = 255 / kWidth + 1;

  static std::size_t place_of(int r, int g) {
    return static_cast<std::size_t>(r) * kSide + static_cast<std::size_t>(g);
  }

  std::array<std::uint32_t, std::size_t{kSide} * kSide> first_;
  std::vector<std::uint32_t> next_;  // by number
};

/// A box around colours that may become one.
class ColourReducer::Box {
 public:
  Box(const Channels& first, int most_side) : least_(first), most_(first), most_side_(most_side) {}

  /// False if the box would be too wide with the colour in it.
  bool take(const Channels& c) {
    if ((c.a == 255) != (most_.a == 255)) return false;
    const Channels least{std::min(least_.r, c.r), std::min(least_.g, c.g), std::min(least_.b, c.b),
                         std::min(least_.a, c.a)};
    const Channels most{std::max(most_.r, c.r), std::max(most_.g, c.g), std::max(most_.b, c.b),
                        std::max(most_.a, c.a)};
    if (difference(least, most).most > most_side_) return false;
    least_ = least;
    most_ = most;
    return true;
  }

  Channels middle() const {
    const auto between = [](int a, int b) { return (a + b) / 2; };
    return {between(least_.r, most_.r), between(least_.g, most_.g), between(least_.b, most_.b),
            between(least_.a, most_.a)};
  }

 private:
  Channels least_;
  Channels most_;
  int most_side_;
};

std::uint64_t ColourReducer::reduce(std::span<const Rgba> colours, std::span<const Origin> origins,
                                    std::span<const std::uint32_t> pixels, int most_change) {
  const Given given{colours, origins, pixels};
  channels_.clear();
  for (const Rgba colour : colours) channels_.push_back(channels_of(colour));
  put_into_lattice(given, most_change);
  if (made_.size() > kPaletteColours && most_change > 0 && may_be_gathered() &&
      !gather(given, most_change)) {
    put_into_lattice(given, most_change);
  }
  return change(given);
}

void ColourReducer::reduce(RunPicture& picture) {
  std::vector<std::uint32_t> pixels(picture.colours.size(), 0);
  std::uint32_t begin = 0;
  for (const Run& run : picture.runs) {
    pixels[run.colour] += run.end - begin;
    begin = run.end == static_cast<std::uint32_t>(picture.width) ? 0 : run.end;
  }
  reduce_within(most_change_of(picture.pixel_count()), [&](int change) {
    return reduce(picture.colours, picture.origins, pixels, change);
  });
  const RunPicture before = std::move(picture);
  picture = {before.width, before.height, colours(), origins(), {}, {}};
  recolour(before.runs, before.row_end, becomes_, picture);
}

// All colours except mixed ones remain. New colours are numbered in order of first occurrence.
void ColourReducer::begin(const Given& given) {
  made_.clear();
  new_channels_.clear();
  kept_.clear();
  becomes_.assign(given.colours.size(), kNone);
  std::vector<std::uint32_t> kept(becomes_.size(), kNone);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (given.pixels[i] == 0 || given.origins[i] == Origin::mixed) continue;
    kept[i] = kept_.number_of(given.colours[i], given.origins[i]);
  }
  std::vector<std::uint32_t> new_numbers(kept_.size(), kNone);  // by number among those kept
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (given.pixels[i] == 0) continue;
    if (kept[i] == kNone) kept[i] = kept_.look_up(given.colours[i]);
    if (kept[i] == kNone) continue;
    std::uint32_t& number = new_numbers[kept[i]];
    if (number == kNone) number = make(given.colours[i], kept_.origins()[kept[i]]);
    becomes_[i] = number;
  }
}

std::uint32_t ColourReducer::make(Rgba colour, Origin origin) {
  const std::uint32_t number = made_.number_of(colour, origin);
  if (number == new_channels_.size()) new_channels_.push_back(channels_of(colour));
  return number;
}

void ColourReducer::put_into_lattice(const Given& given, int most_change) {
  begin(given);
  Lattice lattice(most_change);
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    const bool is_kept = becomes_[i] != kNone;
    const Origin origin = is_kept ? made_.origins()[becomes_[i]] : given.origins[i];
    if (origin == Origin::flat) lattice.attract(given.colours[i].a);
  }
  cells_.clear();
  of_cells_.clear();
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (given.pixels[i] == 0 || becomes_[i] != kNone) continue;
    if (most_change == 0) {
      becomes_[i] = make(given.colours[i], Origin::mixed);
      continue;
    }
    const Channels middle = lattice.middle_of(channels_[i]);
    const std::uint32_t cell = cells_.number_of(as_colour(middle), Origin::mixed);
    if (cell == of_cells_.size()) of_cells_.push_back(make(straight(middle), Origin::mixed));
    becomes_[i] = of_cells_[cell];
  }
}

/// Boxes around colours number about half as many as the cells of the lattice.
bool ColourReducer::may_be_gathered() const {
  return kept_.size() + (made_.size() - kept_.size()) / 2 <= kPaletteColours;
}

// Each box starts with the colour that has the most pixels of those left. False if there are too
// many.
bool ColourReducer::gather(const Given& given, int most_change) {
  begin(given);
  if (made_.size() > kPaletteColours) return false;
  number_others(given);
  Neighbourhood kept;
  for (const Channels& channels : new_channels_) kept.add(channels);
  struct Left {
    Channels channels;
    std::uint32_t number;  // among the others
  };
  std::vector<Left> left;
  std::vector<std::uint32_t> of_others(others_.size());  // indexes of new colours
  for (std::uint32_t i = 0; i < others_.size(); ++i) {
    const Channels channels = channels_of(others_.colours()[i]);
    of_others[i] = nearest(kept, channels, most_change);
    if (of_others[i] == kNone) left.push_back({channels, i});
  }
  std::ranges::sort(left, {}, [&](const Left& one) {
    return std::tuple(~pixels_of_others_[one.number], bits_of(others_.colours()[one.number]));
  });
  Neighbourhood all_left;
  for (const Left& one : left) all_left.add(one.channels);
  std::vector<std::uint32_t> becomes(left.size(), kNone);
  std::vector<std::uint32_t> near;
  for (std::uint32_t first = 0; first < left.size(); ++first) {
    if (becomes[first] != kNone) continue;
    if (made_.size() >= kPaletteColours) return false;
    const Channels& around = left[first].channels;
    near.clear();
    all_left.for_each_near(around, 2 * most_change, [&](std::uint32_t k) {
      const bool is_left = becomes[k] == kNone && k != first;
      const bool fits = difference(left[k].channels, around).most <= 2 * most_change;
      if (is_left && fits) near.push_back(k);
      return is_left;
    });
    std::ranges::sort(near);
    Box box(around, 2 * most_change);
    std::erase_if(near, [&](std::uint32_t k) { return !box.take(left[k].channels); });
    becomes[first] = make(straight(box.middle()), Origin::mixed);
    for (const std::uint32_t k : near) becomes[k] = becomes[first];
  }
  for (std::size_t k = 0; k < left.size(); ++k) of_others[left[k].number] = becomes[k];
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (becomes_[i] == kNone && given.pixels[i] > 0) becomes_[i] = of_others[numbers_[i]];
  }
  return true;
}

/// Collects the colours that do not remain, without duplicates, each with all of its pixels.
void ColourReducer::number_others(const Given& given) {
  others_.clear();
  pixels_of_others_.clear();
  numbers_.resize(given.colours.size());
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (becomes_[i] != kNone || given.pixels[i] == 0) continue;
    numbers_[i] = others_.number_of(given.colours[i], Origin::mixed);
    if (numbers_[i] == pixels_of_others_.size()) pixels_of_others_.push_back(0);
    pixels_of_others_[numbers_[i]] += given.pixels[i];
  }
}

/// The nearest new colour; kNone if all are too far away. In case of a tie, the first one.
std::uint32_t ColourReducer::nearest(Neighbourhood& kept, const Channels& channels,
                                     int most_change) const {
  std::uint32_t nearest = kNone;
  std::tuple least{most_change + 1, 0, kNone};
  kept.for_each_near(channels, most_change, [&](std::uint32_t k) {
    const bool are_opaque_alike = (new_channels_[k].a == 255) == (channels.a == 255);
    const Difference apart = difference(new_channels_[k], channels);
    const std::tuple distance{apart.most, apart.sum, k};
    if (are_opaque_alike && distance < least) {
      least = distance;
      nearest = k;
    }
    return true;
  });
  return nearest;
}

std::uint64_t ColourReducer::change(const Given& given) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (given.pixels[i] == 0) continue;
    const Difference change = difference(new_channels_[becomes_[i]], channels_[i]);
    sum += std::uint64_t{given.pixels[i]} * static_cast<std::uint64_t>(change.sum);
  }
  return sum;
}

}  // namespace trapeze
