#include "render/picture/reduce_colours.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "render/picture/number_table.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

/// Cells of channels, the first of which has its middle at 0. Opacities of flat colours attract
/// those close to them, so that what is as opaque everywhere remains so.
class Lattice {
 public:
  Lattice(const RunPicture& picture, int most_change) : step_(2 * most_change + 1) {
    // What is opaque remains so, and nothing else becomes so.
    for (int a = 0; a < 255; ++a)
      opacities_[static_cast<std::size_t>(a)] = std::min(middle(a), 254);
    opacities_[255] = 255;
    std::array<int, 256> distances;
    distances.fill(most_change + 1);
    for (std::size_t i = 0; i < picture.colours.size(); ++i) {
      if (picture.origins[i] == Origin::flat) attract(picture.colours[i].a, distances);
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

/// The new colours while they are found, each once.
class ColourReducer::NewColours {
 public:
  explicit NewColours(ColourReducer& reducer) : reducer_(reducer) {
    reducer_.colours_.clear();
    reducer_.new_channels_.clear();
  }

  std::uint32_t number_of(Rgba colour) {
    std::uint32_t& number = numbers_[ColourKey(colour)];
    if (number == NumberTable<ColourKey>::kNone) {
      number = static_cast<std::uint32_t>(reducer_.colours_.size());
      reducer_.colours_.push_back(colour);
      reducer_.new_channels_.push_back(channels_of(colour));
    }
    return number;
  }

 private:
  ColourReducer& reducer_;
  NumberTable<ColourKey> numbers_;
};

std::uint64_t ColourReducer::reduce(RunPicture& picture, int most_change) {
  count_pixels(picture);
  put_into_lattice(picture, most_change);
  if (colours_.size() > kPaletteColours && most_change > 0 && may_be_gathered(picture) &&
      !gather(picture, most_change)) {
    put_into_lattice(picture, most_change);
  }
  apply(picture);
  return change();
}

void ColourReducer::count_pixels(const RunPicture& picture) {
  channels_.clear();
  for (const Rgba colour : picture.colours) channels_.push_back(channels_of(colour));
  pixels_.assign(picture.colours.size(), 0);
  std::uint32_t begin = 0;
  for (const Run& run : picture.runs) {
    pixels_[run.colour] += run.end - begin;
    begin = run.end == static_cast<std::uint32_t>(picture.width) ? 0 : run.end;
  }
}

void ColourReducer::keep_all_but_mixed(const RunPicture& picture, NewColours& made) {
  becomes_.assign(picture.colours.size(), kNone);
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (pixels_[i] == 0 || picture.origins[i] == Origin::mixed) continue;
    becomes_[i] = made.number_of(picture.colours[i]);
  }
}

void ColourReducer::put_into_lattice(const RunPicture& picture, int most_change) {
  NewColours made(*this);
  keep_all_but_mixed(picture, made);
  const Lattice lattice(picture, most_change);
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (pixels_[i] == 0 || becomes_[i] != kNone) continue;
    becomes_[i] = made.number_of(most_change == 0 ? picture.colours[i]
                                                  : straight(lattice.middle_of(channels_[i])));
  }
}

/// Boxes around colours take about half as many as the cells of the lattice.
bool ColourReducer::may_be_gathered(const RunPicture& picture) const {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    kept += pixels_[i] > 0 && picture.origins[i] != Origin::mixed ? 1 : 0;
  }
  return kept + (colours_.size() - std::min(kept, colours_.size())) / 2 <= kPaletteColours;
}

// Boxes are begun with the colour that most pixels have among those that are left. False if there
// are too many.
bool ColourReducer::gather(const RunPicture& picture, int most_change) {
  NewColours made(*this);
  keep_all_but_mixed(picture, made);
  if (colours_.size() > kPaletteColours) return false;
  Neighbourhood kept;
  for (const Channels& channels : new_channels_) kept.add(channels);
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < pixels_.size(); ++i) {
    if (pixels_[i] == 0 || becomes_[i] != kNone) continue;
    becomes_[i] = nearest(kept, channels_[i], most_change);
    if (becomes_[i] == kNone) left.push_back(i);
  }
  std::ranges::sort(left, {}, [&](std::uint32_t i) {
    return std::tuple(~pixels_[i], ColourKey(picture.colours[i]).bits);
  });
  Neighbourhood others;
  for (const std::uint32_t i : left) others.add(channels_[i]);
  std::vector<std::uint32_t> near;
  for (std::uint32_t first = 0; first < left.size(); ++first) {
    if (becomes_[left[first]] != kNone) continue;
    if (colours_.size() >= kPaletteColours) return false;
    near.clear();
    others.for_each_near(channels_[left[first]], [&](std::uint32_t k) {
      if (k > first && becomes_[left[k]] == kNone) near.push_back(k);
    });
    std::ranges::sort(near);
    Box box(channels_[left[first]], 2 * most_change);
    std::erase_if(near, [&](std::uint32_t k) { return !box.take(channels_[left[k]]); });
    const std::uint32_t colour = made.number_of(straight(box.middle()));
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

std::uint64_t ColourReducer::change() const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < becomes_.size(); ++i) {
    if (pixels_[i] == 0) continue;
    const Difference change = difference(new_channels_[becomes_[i]], channels_[i]);
    sum += std::uint64_t{pixels_[i]} * static_cast<std::uint64_t>(change.sum);
  }
  return sum;
}

void ColourReducer::apply(RunPicture& picture) const {
  std::size_t kept = 0;
  std::size_t i = 0;
  for (std::uint32_t& row_end : picture.row_end) {
    const std::size_t first = kept;
    for (; i < row_end; ++i) {
      const Run run{picture.runs[i].end, becomes_[picture.runs[i].colour]};
      if (kept > first && picture.runs[kept - 1].colour == run.colour) {
        picture.runs[kept - 1].end = run.end;
      } else {
        picture.runs[kept++] = run;
      }
    }
    row_end = static_cast<std::uint32_t>(kept);
  }
  picture.runs.resize(kept);
  picture.colours = colours_;
  std::vector<Origin> origins(colours_.size(), Origin::mixed);
  for (std::size_t k = 0; k < becomes_.size(); ++k) {
    if (pixels_[k] == 0) continue;
    origins[becomes_[k]] = std::min(origins[becomes_[k]], picture.origins[k]);
  }
  picture.origins = std::move(origins);
}

}  // namespace trapeze
