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

std::string ids_of(std::span<const FeatureNote* const> notes) {
  std::string text;
  for (std::size_t i = 0; i < std::min(notes.size(), kMostIds); ++i) {
    const bool is_last = i + 1 == notes.size();
    text += fmt::format("{}{}", i == 0 ? "" : is_last ? " and " : ", ", notes[i]->id);
  }
  if (notes.size() > kMostIds) text += fmt::format(" and {} more", notes.size() - kMostIds);
  return text;
}

std::string line_of(std::span<const FeatureNote* const> notes) {
  const FeatureNote& first = *notes.front();
  if (notes.size() == 1) return fmt::format("feature {}: {}", first.id, first.reason);
  const bool are_equal = std::ranges::all_of(
      notes, [&first](const FeatureNote* note) { return note->reason == first.reason; });
  if (are_equal) return fmt::format("features {}: {}", ids_of(notes), first.reason);
  return fmt::format("features {}: {}; of feature {}{}", ids_of(notes), sort_of(first), first.id,
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
  for (const auto& sort : sorts) lines.push_back(line_of(sort));
  return lines;
}

}  // namespace trapeze
