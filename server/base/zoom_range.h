// A range of zooms of tiles.
#pragma once

#include <optional>
#include <string_view>

namespace trapeze {

/// Both ends are included.
struct ZoomRange {
  int first = 0;
  int last = 0;

  friend bool operator==(const ZoomRange&, const ZoomRange&) = default;
};

/// Parses "3-12", or a single zoom; nothing for other text, or if a zoom is not between 0 and
/// kMaxZoom. Any thread.
std::optional<ZoomRange> parse_zooms(std::string_view text);

}  // namespace trapeze
