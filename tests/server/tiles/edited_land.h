// Land that is edited by chance: fields that share borders, and woods and ponds that lie anywhere.
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

  /// Moves a corner, deletes or adds a feature, changes an attribute, brings features that lie
  /// apart into another order, or does nothing but write the file anew under another name. What it
  /// was, in a word.
  std::string edit();

  /// As it is now, loaded from a file: one layer, "land", with the attributes kind (field, wood or
  /// pond) and value.
  std::shared_ptr<const Dataset> load();
  /// The same, written only: the path of the file.
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
