#include "render/picture/reduce_colours.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

/// Cells of channels, the first of which has its middle at 0. Opacities of flat colours attract
/// those close to them, so that what is as opaque everywhere remains so.
class Lattice {
 public:
  Lattice(std::span<const Rgba> colours, std::span<const Origin> origins, int most_change)
      : step_(2 * most_change + 1) {
    // What is opaque remains so, and nothing else becomes so.
    for (int a = 0; a < 255; ++a)
      opacities_[static_cast<std::size_t>(a)] = std::min(middle(a), 254);
    opacities_[255] = 255;
    std::array<int, 256> distances;
    distances.fill(most_change + 1);
    for (std::size_t i = 0; i < colours.size(); ++i) {
      if (origins[i] == Origin::flat) attract(colours[i].a, distances);
    }
  }

  /// The middle of its cell.
  Channels middle_of(const Channels& channels) const {
    const int a = opacities_[static_cast<std::size_t>(channels.a)];
    return {std::min(middle(channels.r), a), std::min(middle(channels.g), a),
            std::min(middle(channels.b), a), a};
  }

 private:
  int middle(int value) const { return divided(value, step_) * step_; }

  void attract(int opacity, std::array<int, 256>& distances) {
    if (opacity == 255) return;
    for (int a = std::max(0, opacity - step_ / 2); a <= std::min(254, opacity + step_ / 2); ++a) {
      const auto i = static_cast<std::size_t>(a);
      if (std::abs(a - opacity) >= distances[i]) continue;
      distances[i] = std::abs(a - opacity);
      opacities_[i] = opacity;
    }
  }

  int step_;
  std::array<int, 256> opacities_{};
};

}  // namespace

/// Numbers of colours by where their channels lie, so that those close to a colour are found
/// without looking at all.
class ColourReducer::Neighbourhood {
 public:
  Neighbourhood() { first_.fill(kNone); }

  /// Numbers are added in ascending order, from 0 on.
  void add(const Channels& channels) {
    std::uint32_t& first = first_[place_of(channels.r, channels.g)];
    next_.push_back(std::exchange(first, static_cast<std::uint32_t>(next_.size())));
  }

  /// Calls visit(number) for all colours none of whose channels is further away than kReach, and
  /// for others.
  template <typename Visit>
  void for_each_near(const Channels& channels, const Visit& visit) const {
    for (int r = channels.r - kReach; r <= channels.r + kReach; r += kReach) {
      for (int g = channels.g - kReach; g <= channels.g + kReach; g += kReach) {
        if (r < 0 || g < 0 || r >= kSide * kReach || g >= kSide * kReach) continue;
        for (std::uint32_t i = first_[place_of(r, g)]; i != kNone; i = next_[i]) visit(i);
      }
    }
  }

 private:
  static constexpr int kReach = 2 * kMostChange + 1;
  static constexpr int kSide = 255 / kReach + 1;

  static std::size_t place_of(int r, int g) {
    const int place = r / kReach * kSide + g / kReach;
    return static_cast<std::size_t>(place);
  }

  std::array<std::uint32_t, std::size_t{kSide} * kSide> first_;
  std::vector<std::uint32_t> next_;  // by number
};

/// Around colours that may become one.
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
  if (made_.size() > kPaletteColours && most_change > 0 && may_be_gathered(given) &&
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

// All but mixed colours remain.
void ColourReducer::begin(const Given& given) {
  made_.clear();
  new_channels_.clear();
  becomes_.assign(given.colours.size(), kNone);
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (given.pixels[i] == 0 || given.origins[i] == Origin::mixed) continue;
    becomes_[i] = make(given.colours[i], given.origins[i]);
  }
}

std::uint32_t ColourReducer::make(Rgba colour, Origin origin) {
  const std::uint32_t number = made_.number_of(colour, origin);
  if (number == new_channels_.size()) new_channels_.push_back(channels_of(colour));
  return number;
}

void ColourReducer::put_into_lattice(const Given& given, int most_change) {
  begin(given);
  const Lattice lattice(given.colours, given.origins, most_change);
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (given.pixels[i] == 0 || becomes_[i] != kNone) continue;
    const Rgba colour =
        most_change == 0 ? given.colours[i] : straight(lattice.middle_of(channels_[i]));
    becomes_[i] = make(colour, Origin::mixed);
  }
}

/// Boxes around colours take about half as many as the cells of the lattice.
bool ColourReducer::may_be_gathered(const Given& given) const {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < given.pixels.size(); ++i) {
    kept += given.pixels[i] > 0 && given.origins[i] != Origin::mixed ? 1 : 0;
  }
  return kept + (made_.size() - std::min(kept, made_.size())) / 2 <= kPaletteColours;
}

// Boxes are begun with the colour that most pixels have among those that are left. False if there
// are too many.
bool ColourReducer::gather(const Given& given, int most_change) {
  begin(given);
  if (made_.size() > kPaletteColours) return false;
  Neighbourhood kept;
  for (const Channels& channels : new_channels_) kept.add(channels);
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < given.pixels.size(); ++i) {
    if (given.pixels[i] == 0 || becomes_[i] != kNone) continue;
    becomes_[i] = nearest(kept, channels_[i], most_change);
    if (becomes_[i] == kNone) left.push_back(i);
  }
  std::ranges::sort(left, {}, [&](std::uint32_t i) {
    return std::tuple(~given.pixels[i], bits_of(given.colours[i]));
  });
  Neighbourhood others;
  for (const std::uint32_t i : left) others.add(channels_[i]);
  std::vector<std::uint32_t> near;
  for (std::uint32_t first = 0; first < left.size(); ++first) {
    if (becomes_[left[first]] != kNone) continue;
    if (made_.size() >= kPaletteColours) return false;
    near.clear();
    others.for_each_near(channels_[left[first]], [&](std::uint32_t k) {
      if (k > first && becomes_[left[k]] == kNone) near.push_back(k);
    });
    std::ranges::sort(near);
    Box box(channels_[left[first]], 2 * most_change);
    std::erase_if(near, [&](std::uint32_t k) { return !box.take(channels_[left[k]]); });
    const std::uint32_t colour = make(straight(box.middle()), Origin::mixed);
    becomes_[left[first]] = colour;
    for (const std::uint32_t k : near) becomes_[left[k]] = colour;
  }
  return true;
}

/// Of the new colours; kNone if all are too far. Of those that are as near, the first.
std::uint32_t ColourReducer::nearest(const Neighbourhood& kept, const Channels& channels,
                                     int most_change) const {
  std::uint32_t nearest = kNone;
  std::tuple least{most_change + 1, 0, kNone};
  kept.for_each_near(channels, [&](std::uint32_t k) {
    const bool are_opaque_alike = (new_channels_[k].a == 255) == (channels.a == 255);
    const Difference apart = difference(new_channels_[k], channels);
    const std::tuple distance{apart.most, apart.sum, k};
    if (!are_opaque_alike || distance >= least) return;
    least = distance;
    nearest = k;
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
