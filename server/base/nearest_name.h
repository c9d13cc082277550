// Suggestions for mistyped names.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trapeze {

/// The name at the smallest edit distance, where a missing, additional or changed letter or two
/// swapped neighbours count as one edit; the first one in case of a tie. None if all are more than
/// one edit per three letters away. Ignores case. Compares bytes, which is sufficient for our
/// names.
std::optional<std::string> nearest_name(std::string_view mistyped,
                                        const std::vector<std::string>& names);

/// "; did you mean NAME?", or empty if no name is near: the end of a sentence that refuses a name.
std::string did_you_mean(std::string_view mistyped, const std::vector<std::string>& names);

/// "; did you mean \"NAME\"?", or "." if no name is near: the same for the body of a problem.
std::string suggestion_or_stop(std::string_view mistyped, const std::vector<std::string>& names);

/// Converts A to Z to lower case, and nothing else.
std::string in_lower_case(std::string_view text);

}  // namespace trapeze
