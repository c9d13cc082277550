// Pictures of some layers, compared with the truth.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracle/compare.h"
#include "tests/oracle/program.h"
#include "tests/oracle/style_cases.h"

namespace trapeze::oracle {

/// The compared objects: layers of the program and of the oracle, the lowest one first.
struct Subject {
  std::vector<std::string> names;
  std::vector<const TrueLayer*> layers;
  std::map<std::string, Program*> programs;  // by a label: "coverage auto"
};

/// Limits on the distance of all tiles of one program, one style and one zoom, taken together.
struct Limits {
  double mean = 1;
  double share = 0.0005;
  std::size_t inner_different = 0;
};

class HeldToTruth {
 public:
  explicit HeldToTruth(Subject subject) : subject_(std::move(subject)) {}

  /// Compares a tile in all styles and for all programs. With a single layer, a few of the features
  /// there are highlighted; with two layers, the styles are those of the pair.
  void look_at(TileName name, const TrueClasses& classes);

  struct Case {
    std::string program;
    std::string style;
    int zoom = 0;
    friend auto operator<=>(const Case&, const Case&) = default;
  };
  const std::map<Case, Distance>& distances() const { return distances_; }

 private:
  Subject subject_;
  Workspace workspace_;
  std::map<Case, Distance> distances_;
};

/// "coverage auto, classes, zoom 12"
std::string text_of(const HeldToTruth::Case& one);

/// Exceptions from the usual limits: for cases of some layers with a text that contains `cases`.
struct Exception {
  std::string layers;
  std::string cases;
  Limits limits;
};

/// Expects every case to be within its limits, which are those of the first exception that applies,
/// and prints the worst of each style.
void expect_true(const HeldToTruth& held, const std::string& layers,
                 std::span<const Exception> exceptions);

}  // namespace trapeze::oracle
