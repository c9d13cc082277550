#include "server/data/note_summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string_view>

namespace trapeze {
namespace {

constexpr std::size_t kMostIds = 3;

std::string_view sort_of(const FeatureNote& note) {
  const std::string_view reason = note.reason;
  return reason.substr(0, reason.find(':'));
}

/// Without duplicates, in the order of the notes.
std::vector<std::int64_t> ids_of(std::span<const FeatureNote* const> notes) {
  std::vector<std::int64_t> ids;
  for (const FeatureNote* note : notes) {
    if (ids.empty() || ids.back() != note->id) ids.push_back(note->id);
  }
  return ids;
}

/// "feature 3", or "features 3, 5, 9 and 2 more".
std::string features_text(std::span<const std::int64_t> ids) {
  if (ids.size() == 1) return fmt::format("feature {}", ids.front());
  std::string text = "features ";
  for (std::size_t i = 0; i < std::min(ids.size(), kMostIds); ++i) {
    const bool is_last = i + 1 == ids.size();
    text += fmt::format("{}{}", i == 0 ? "" : is_last ? " and " : ", ", ids[i]);
  }
  if (ids.size() > kMostIds) text += fmt::format(" and {} more", ids.size() - kMostIds);
  return text;
}

std::string line_of(std::span<const FeatureNote* const> notes) {
  const FeatureNote& first = *notes.front();
  const std::string features = features_text(ids_of(notes));
  const bool are_equal = std::ranges::all_of(
      notes, [&first](const FeatureNote* note) { return note->reason == first.reason; });
  if (are_equal) return fmt::format("{}: {}", features, first.reason);
  return fmt::format("{}: {}; of feature {}{}", features, sort_of(first), first.id,
                     first.reason.substr(sort_of(first).size()));
}

}  // namespace

std::vector<std::string> summarize_notes(std::span<const FeatureNote> notes) {
  std::vector<std::vector<const FeatureNote*>> sorts;
  for (const FeatureNote& note : notes) {
    const auto found = std::ranges::find_if(
        sorts, [&note](const auto& sort) { return sort_of(*sort.front()) == sort_of(note); });
    (found == sorts.end() ? sorts.emplace_back() : *found).push_back(&note);
  }
  std::vector<std::string> lines;
  lines.reserve(sorts.size());
  for (const auto& sort : sorts) lines.push_back(line_of(sort));
  return lines;
}

}  // namespace trapeze
