// Suggestions for mistyped names.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trapeze {

/// The name at the smallest edit distance: a letter missing, added or changed, or two neighbours
/// swapped. The first of equals; none if all are farther than one edit in three letters. Case does
/// not count. Bytes are compared, which is enough for names of ours.
std::optional<std::string> nearest_name(std::string_view mistyped,
                                        const std::vector<std::string>& names);

/// "; did you mean NAME?", or nothing if no name is near: the end of a sentence that refuses one.
std::string did_you_mean(std::string_view mistyped, const std::vector<std::string>& names);

/// "; did you mean \"NAME\"?", or "." if no name is near: the same for the body of a problem.
std::string suggestion_or_stop(std::string_view mistyped, const std::vector<std::string>& names);

/// A to Z as a to z, all else as it is.
std::string in_lower_case(std::string_view text);

}  // namespace trapeze
