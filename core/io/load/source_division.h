// The parts into which a source is divided that is too large to be built as one: by place, with
// about as many vertices in each.
//
// Features of which polygons come near each other, so that boxes around their rings meet, are in
// one part, as are those that come near these, and so on. So no two features of different parts lie
// over each other or share a border, at any tolerance: each part looks as it does in the whole
// layer, groups of a coverage are whole, and it does not matter which part is painted first. A
// source whose features all hang together cannot be divided.
//
// The source is read once for that. What is kept of a feature is 28 bytes and 20 for each of its
// rings that does not lie within another one: about 2.5 GB for 50 million buildings.
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

/// The most parts.
constexpr std::uint32_t kMostParts = 4000;

/// Immutable; any number of threads may read.
class SourceDivision {
 public:
  struct Part {
    std::size_t features = 0;  // that have polygons
    std::uint64_t vertices = 0;
  };

  /// Equal on every machine for the same features, selection, options and number of parts, which is
  /// from 1 to kMostParts. `progress` is as in LoadOptions, and may be empty. Throws as
  /// load_layer() does.
  static std::shared_ptr<const SourceDivision> of(const std::string& path,
                                                  const SourceSelection& selection,
                                                  const LayerOptions& options, std::uint32_t count,
                                                  const std::function<void(double)>& progress);

  std::uint32_t count() const { return static_cast<std::uint32_t>(parts_.size()); }
  /// Of the features of the source as they are read, from 0: which part it is in, from 1. What is
  /// no polygon, or cannot be read, is in the first.
  std::uint32_t part_of(std::size_t order) const { return part_of_[order] + 1u; }
  bool knows(std::size_t order) const { return order < part_of_.size(); }
  /// By number, less 1.
  const std::vector<Part>& parts() const { return parts_; }
  /// Of the features that hang together: the most vertices.
  std::uint64_t largest_group() const { return largest_group_; }
  /// Of all that was divided, and how.
  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  SourceDivision() = default;

  std::vector<std::uint16_t> part_of_;
  std::vector<Part> parts_;
  std::uint64_t largest_group_ = 0;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace trapeze
