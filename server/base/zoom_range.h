// Zooms of tiles, from one to another.
#pragma once

#include <optional>
#include <string_view>

namespace trapeze {

/// Both ends are part of it.
struct ZoomRange {
  int first = 0;
  int last = 0;

  friend bool operator==(const ZoomRange&, const ZoomRange&) = default;
};

/// "3-12", or one zoom; nothing if it is neither, or not between 0 and kMaxZoom. Any thread.
std::optional<ZoomRange> parse_zooms(std::string_view text);

}  // namespace trapeze
