#include "tests/server/tiles/edited_land.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/config/load_config.h"

namespace trapeze::testing {
namespace {

constexpr int kColumns = 7;
constexpr double kSide = 1.5;  // degrees, the side of a field

}  // namespace

EditedLand::EditedLand(unsigned seed) : random_(seed) {
  // Corners of the fields, and vertices half-way between them, which two fields share.
  std::vector<std::vector<Corner>> grid(2 * kColumns + 1);
  for (int row = 0; row <= 2 * kColumns; ++row) {
    for (int column = 0; column <= 2 * kColumns; ++column) {
      grid[static_cast<std::size_t>(row)].push_back(
          {(column + between(-0.4, 0.4)) * kSide / 2, (row + between(-0.4, 0.4)) * kSide / 2});
    }
  }
  for (std::size_t row = 0; row < 2 * kColumns; row += 2) {
    for (std::size_t column = 0; column < 2 * kColumns; column += 2) {
      Feature field{next_id_++, "field", static_cast<int>(below(5)), {}};
      for (const auto& [x, y] :
           {std::pair(0, 0), {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}) {
        field.ring.push_back(
            grid[row + static_cast<std::size_t>(y)][column + static_cast<std::size_t>(x)]);
      }
      features_.push_back(field);
    }
  }
  for (int i = 0; i < 40; ++i) features_.push_back(star(i % 2 == 0 ? "wood" : "pond"));
}

double EditedLand::between(double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random_);
}

std::size_t EditedLand::below(std::size_t end) {
  return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
}

EditedLand::Feature EditedLand::star(const std::string& kind) {
  Feature feature{next_id_++, kind, static_cast<int>(below(5)), {}};
  const double x = between(-5, 25);
  const double y = between(-5, 15);
  const double radius = std::exp(between(-5, 1));
  const std::size_t corners = 3 + below(30);
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners);
    const double distance = radius * between(0.4, 1);
    feature.ring.push_back({x + distance * std::cos(angle), y + distance * std::sin(angle)});
  }
  return feature;
}

void EditedLand::move_corner() {
  Feature& feature = features_[below(features_.size())];
  Corner& corner = feature.ring[below(feature.ring.size())];
  corner.x += between(-0.2, 0.2);
  corner.y += between(-0.2, 0.2);
}

// Shuffles the fields, which come first and do not overlap.
void EditedLand::change_order() {
  const auto end = std::ranges::find_if(
      features_, [](const Feature& feature) { return feature.kind != "field"; });
  std::shuffle(features_.begin(), end, random_);
}

std::string EditedLand::edit() {
  switch (below(6)) {
    case 0:
      move_corner();
      return "move";
    case 1:
      features_.erase(features_.begin() + static_cast<std::ptrdiff_t>(below(features_.size())));
      return "delete";
    case 2:
      features_.push_back(star("wood"));
      return "add";
    case 3:
      features_[below(features_.size())].value = static_cast<int>(below(5));
      return "attribute";
    case 4:
      change_order();
      return "order";
    default:
      return "rename";
  }
}

std::string EditedLand::text() const {
  std::string text = R"({"type":"FeatureCollection","features":[)";
  for (const Feature& feature : features_) {
    std::string ring;
    for (std::size_t i = 0; i <= feature.ring.size(); ++i) {
      const Corner& corner = feature.ring[i % feature.ring.size()];
      ring += fmt::format("{}[{},{}]", i == 0 ? "" : ",", corner.x, corner.y);
    }
    text += fmt::format(R"({}{{"type":"Feature","id":{},"properties":{{"kind":"{}","value":{}}},)"
                        R"("geometry":{{"type":"Polygon","coordinates":[[{}]]}}}})",
                        &feature == features_.data() ? "" : ",\n", feature.id, feature.kind,
                        feature.value, ring);
  }
  return text + "]}";
}

std::string EditedLand::write() {
  return folder_.write(fmt::format("land{}.geojson", files_++), text());
}

std::shared_ptr<const Dataset> EditedLand::load() {
  auto layers = layers_of_files({write()});
  layers[0].name = "land";
  return Dataset::load(layers);
}

}  // namespace trapeze::testing
