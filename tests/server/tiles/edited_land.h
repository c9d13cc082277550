// Land with random edits: fields with shared borders, and woods and ponds anywhere.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/data/dataset.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze::testing {

class EditedLand {
 public:
  explicit EditedLand(unsigned seed);

  /// Moves a corner, deletes or adds a feature, changes an attribute, reorders features that do not
  /// overlap, or only writes the file again under another name. Returns the kind of edit in a word.
  std::string edit();

  /// Loads the current state from a file: one layer, "land", with the attributes kind (field, wood
  /// or pond) and value.
  std::shared_ptr<const Dataset> load();
  /// Only writes the file; returns its path.
  std::string write();

 private:
  struct Corner {
    double x;
    double y;
  };
  struct Feature {
    std::int64_t id;
    std::string kind;
    int value;
    std::vector<Corner> ring;
  };

  double between(double from, double to);
  std::size_t below(std::size_t end);
  Feature star(const std::string& kind);
  void move_corner();
  void change_order();
  std::string text() const;

  std::mt19937 random_;
  std::vector<Feature> features_;
  std::int64_t next_id_ = 1;
  int files_ = 0;
  TemporaryFolder folder_;
};

}  // namespace trapeze::testing
