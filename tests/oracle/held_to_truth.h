// Pictures of some layers, held to the truth.
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

/// What is compared: layers of the program and the oracle's, the lowest one first.
struct Subject {
  std::vector<std::string> names;
  std::vector<const TrueLayer*> layers;
  std::map<std::string, Program*> programs;  // by what tells them apart: "coverage auto"
};

/// How far off all tiles of one program, one style and one zoom may be, taken together.
struct Limits {
  double mean = 1;
  double share = 0.0005;
  std::size_t inner_different = 0;
};

class HeldToTruth {
 public:
  explicit HeldToTruth(Subject subject) : subject_(std::move(subject)) {}

  /// Compares a tile in all styles, by all programs. Of a single layer, one in a few of the
  /// features there is highlighted; of two, styles are those of the pair.
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

/// Where the usual limits cannot be kept: in the cases of some layers whose texts contain that.
struct Exception {
  std::string layers;
  std::string cases;
  Limits limits;
};

/// Expects every case to be within the limits, which are those of the first exception that applies;
/// and prints the worst of each style.
void expect_true(const HeldToTruth& held, const std::string& layers,
                 std::span<const Exception> exceptions);

}  // namespace trapeze::oracle
