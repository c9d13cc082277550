#include "server/styles/feature_classes.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace trapeze {
namespace {

bool contains(const std::vector<std::int64_t>& ascending, std::int64_t id) {
  return std::ranges::binary_search(ascending, id);
}

/// The types differ only if an attribute of real numbers is compared with an integer.
bool is_equal(const Value& value, const FilterLiteral& literal) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    const auto* other = std::get_if<std::int64_t>(&literal);
    return other != nullptr && *integer == *other;
  }
  const auto* real = std::get_if<double>(&value);
  const auto* other = std::get_if<double>(&literal);
  return real != nullptr && other != nullptr && *real == *other;
}

// A text is preceded by its length, so that its end and the start of the next one are unambiguous.
std::string key_of(const std::optional<FilterLiteral>& value) {
  if (!value) return "null;";
  if (const auto* integer = std::get_if<std::int64_t>(&*value)) return fmt::format("{};", *integer);
  if (const auto* real = std::get_if<double>(&*value)) return fmt::format("r{};", *real);
  const auto& text = std::get<std::string>(*value);
  return fmt::format("{}'{};", text.size(), text);
}

}  // namespace

std::size_t Classing::class_of_others() const {
  if (field < 0) return 0;
  return breaks.empty() ? values.size() : breaks.size() + 1;
}

Classing Classing::over(const FeatureTable& features) const {
  Classing other = *this;
  if (joined != nullptr) return other;  // only for a layer in one piece
  if (filter != nullptr) other.filter = std::make_shared<const BoundFilter>(filter->over(features));
  return other;
}

bool Classing::is_plain() const {
  return field < 0 && filter == nullptr && ids.empty() && highlighted_ids.empty();
}

std::string Classing::key() const {
  std::string text = fmt::format("field {}", field);
  for (const auto& value : values) text += " " + key_of(value);
  if (joined != nullptr) text += " joined " + joined->key();
  if (!alike.empty()) text += fmt::format(" alike {}", fmt::join(alike, ","));
  for (const double number : breaks) text += fmt::format(" <{}", number);
  if (!ids.empty()) text += fmt::format(" ids {}", fmt::join(ids, ","));
  if (!highlighted_ids.empty()) {
    text += fmt::format(" highlight {}", fmt::join(highlighted_ids, ","));
  }
  if (filter != nullptr) text += " filter " + filter->text();
  return text;
}

FeatureClassifier::FeatureClassifier(const Classing& classing, const FeatureTable& features)
    : classing_(classing), features_(features), attributes_(features, classing.joined) {
  for (std::size_t i = 0; i < classing.values.size(); ++i) {
    if (!classing.values[i]) continue;
    const auto* text = std::get_if<std::string>(&*classing.values[i]);
    if (text != nullptr) texts_.emplace(*text, class_of_index(i));
  }
}

std::uint8_t FeatureClassifier::class_of(std::uint32_t row) const {
  const std::int64_t id = features_.id(row);
  if (!classing_.ids.empty() && !contains(classing_.ids, id)) return kNotDrawn;
  if (classing_.filter != nullptr && !classing_.filter->passes(row)) return kNotDrawn;
  if (contains(classing_.highlighted_ids, id)) {
    return static_cast<std::uint8_t>(classing_.class_of_highlighted());
  }
  if (classing_.field < 0) return 0;
  return class_of_value(attributes_.value(row, classing_.field));
}

std::uint8_t FeatureClassifier::class_of_value(const Value& value) const {
  const auto others = static_cast<std::uint8_t>(classing_.class_of_others());
  if (const auto* text = std::get_if<std::string_view>(&value)) {
    const auto found = texts_.find(*text);
    return found == texts_.end() ? others : found->second;
  }
  const bool is_null = std::holds_alternative<std::monostate>(value);
  if (classing_.breaks.empty()) {
    const auto found = std::ranges::find_if(classing_.values, [&](const auto& wanted) {
      return is_null ? !wanted.has_value() : wanted.has_value() && is_equal(value, *wanted);
    });
    // The end is the class of others.
    return class_of_index(static_cast<std::size_t>(found - classing_.values.begin()));
  }
  if (is_null) return others;
  const auto* integer = std::get_if<std::int64_t>(&value);
  const double number =
      integer != nullptr ? static_cast<double>(*integer) : std::get<double>(value);
  if (number != number) return others;  // NaN
  return static_cast<std::uint8_t>(std::ranges::upper_bound(classing_.breaks, number) -
                                   classing_.breaks.begin());
}

std::uint8_t FeatureClassifier::class_of_index(std::size_t i) const {
  return i < classing_.alike.size() ? classing_.alike[i] : static_cast<std::uint8_t>(i);
}

FeatureClasses classify(const Classing& classing, const FeatureTable& features) {
  const FeatureClassifier classifier(classing, features);
  FeatureClasses classes(features.size());
  for (std::uint32_t row = 0; row < classes.size(); ++row) classes[row] = classifier.class_of(row);
  return classes;
}

namespace {

std::string key_of(std::uint64_t revision, const Classing& classing) {
  return fmt::format("{:016x} {}", revision, classing.key());
}

}  // namespace

std::shared_ptr<const FeatureClasses> FeatureClassCache::find(std::uint64_t revision,
                                                              const Classing& classing,
                                                              const FeatureTable& features) {
  constexpr std::size_t kOverhead = 256;  // approximate, per entry
  const std::string key = key_of(revision, classing);
  const std::size_t bytes = features.size() + 2 * key.size() + kOverhead;
  const auto entry = find_or_insert(key, bytes);
  std::call_once(entry->once, [&] {
    entry->classes = std::make_shared<const FeatureClasses>(classify(classing, features));
    entry->is_made = true;
  });
  return entry->classes;
}

bool FeatureClassCache::has(std::uint64_t revision, const Classing& classing) {
  const std::string key = key_of(revision, classing);
  const std::lock_guard lock(mutex_);
  const auto* entry = entries_.find(key);
  return entry != nullptr && (*entry)->is_made;
}

std::shared_ptr<FeatureClassCache::Entry> FeatureClassCache::find_or_insert(const std::string& key,
                                                                            std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (const auto* entry = entries_.find(key)) return *entry;
  auto entry = std::make_shared<Entry>();
  if (bytes > entries_.budget()) return entry;
  return entries_.insert(key, std::move(entry), bytes);
}

std::size_t FeatureClassCache::memory() const {
  const std::lock_guard lock(mutex_);
  return entries_.bytes();
}

}  // namespace trapeze
