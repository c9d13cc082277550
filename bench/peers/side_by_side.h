// The same tiles drawn by different programs, for visual comparison and for counting differences.
#pragma once

#include <string>
#include <vector>

#include "render/picture/picture.h"

namespace trapeze {

class SideBySide {
 public:
  /// One PNG for each tile, the same tiles in the same order for all programs. Throws
  /// std::runtime_error if one is not a PNG.
  void add(const std::string& name, const std::vector<std::string>& pngs);

  /// Prints the difference of each from the first one, on white, to standard output.
  void print_differences() const;

  /// Writes a PNG with a row for each tile and a column for each program, on white. Throws
  /// std::runtime_error if it cannot be written.
  void write(const std::string& path) const;

 private:
  struct Column {
    std::string name;
    std::vector<Picture> pictures;
  };
  std::vector<Column> columns_;
};

}  // namespace trapeze
