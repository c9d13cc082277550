// The parts into which a source too large to be built as one is divided: by place, with about as
// many vertices in each.
//
// Features with polygons near each other, so that the boxes of their rings intersect, are in one
// part, and so are the features near these, and so on. So no two features of different parts
// overlap or share a border, at any tolerance: each part looks as it does in the whole layer,
// groups of a coverage are complete, and the painting order of parts does not matter. A source
// whose features are all connected in this way cannot be divided.
//
// The source is read once for the division. For each feature, 28 bytes are kept, plus 20 for each
// of its rings that does not lie within another one: about 2.5 GB for 50 million buildings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/io/source/source_selection.h"
#include "core/layer/layer_options.h"

namespace trapeze {

/// The maximum number of parts.
constexpr std::uint32_t kMostParts = 4000;

/// Immutable; any number of threads may read.
class SourceDivision {
 public:
  struct Part {
    std::size_t features = 0;  // with polygons
    std::uint64_t vertices = 0;
  };

  /// Computes the division. It is equal on every machine for the same features, selection, options
  /// and number of parts, which is from 1 to kMostParts. `progress` is as in LoadOptions and may be
  /// empty. Throws like load_layer().
  static std::shared_ptr<const SourceDivision> of(const std::string& path,
                                                  const SourceSelection& selection,
                                                  const LayerOptions& options, std::uint32_t count,
                                                  const std::function<void(double)>& progress);

  std::uint32_t count() const { return static_cast<std::uint32_t>(parts_.size()); }
  /// The part, from 1, of a feature of the source, numbered from 0 in reading order. Features that
  /// are no polygon, or cannot be read, are in the first part.
  std::uint32_t part_of(std::size_t order) const { return part_of_[order] + 1u; }
  bool knows(std::size_t order) const { return order < part_of_.size(); }
  /// By number - 1.
  const std::vector<Part>& parts() const { return parts_; }
  /// The vertices of the largest group of connected features.
  std::uint64_t largest_group() const { return largest_group_; }
  /// Of the divided content and the method of division.
  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  SourceDivision() = default;

  std::vector<std::uint16_t> part_of_;
  std::vector<Part> parts_;
  std::uint64_t largest_group_ = 0;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace trapeze
