#include "server/values/derived_values.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

namespace trapeze {
namespace {

constexpr std::size_t kOverhead = 512;      // per entry, approximate
constexpr std::size_t kBytesOfSpread = 12;  // of a number that occurs once
constexpr std::size_t kBytesOfJoinedFeature = 4;

std::string name_of_join(std::uint64_t revision, int field, const ValueTable& table) {
  return fmt::format("{:016x} join {}", revision, JoinedValues::key_of(table, field));
}

/// For the attribute with that index, or for joined values by their key.
std::string name_of_spread(std::uint64_t revision, const std::string& numbers) {
  return fmt::format("{:016x} of {}", revision, numbers);
}

std::string name_of_breaks(const std::string& spread, const BreakRule& rule) {
  return spread + " " + break_rule_text(rule);
}

}  // namespace

Result<std::shared_ptr<const JoinedValues>> DerivedValues::join(
    std::uint64_t revision, const Layer& layer, int field,
    const std::shared_ptr<const ValueTable>& table) {
  const std::size_t bytes =
      kBytesOfJoinedFeature * layer.features().size() + table->size() / 8 + table->memory();
  const auto entry = keep(name_of_join(revision, field, *table), bytes, [&](Entry& made) {
    made.joined = std::make_shared<const Result<std::shared_ptr<const JoinedValues>>>(
        JoinedValues::join(table, layer, field));
  });
  return *entry->joined;
}

bool DerivedValues::has_join(std::uint64_t revision, int field, const ValueTable& table) const {
  return has(name_of_join(revision, field, table));
}

bool DerivedValues::has_breaks(std::uint64_t revision, int field, const BreakRule& rule) const {
  return has(name_of_breaks(name_of_spread(revision, fmt::format("{}", field)), rule));
}

bool DerivedValues::has_breaks(std::uint64_t revision, const ValueTable& table, int joined_by,
                               const BreakRule& rule) const {
  const std::string joined = JoinedValues::key_of(table, joined_by);
  return has(name_of_breaks(name_of_spread(revision, joined), rule));
}

bool DerivedValues::has(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  return kept_.find(key) != nullptr;
}

std::shared_ptr<const ValueSpread> DerivedValues::spread(std::uint64_t revision, const Layer& layer,
                                                         int field) {
  return keep(name_of_spread(revision, fmt::format("{}", field)),
              kBytesOfSpread * layer.features().size(),
              [&](Entry& made) {
                made.spread = std::make_shared<const ValueSpread>(spread_of(layer, field));
              })
      ->spread;
}

std::shared_ptr<const ValueSpread> DerivedValues::spread(std::uint64_t revision,
                                                         const JoinedValues& joined) {
  return keep(name_of_spread(revision, joined.key()), kBytesOfSpread * joined.table().size(),
              [&](Entry& made) {
                made.spread = std::make_shared<const ValueSpread>(joined.spread());
              })
      ->spread;
}

std::vector<double> DerivedValues::breaks(std::uint64_t revision, const Layer& layer, int field,
                                          const BreakRule& rule) {
  return keep_breaks(name_of_spread(revision, fmt::format("{}", field)), rule,
                     [&] { return spread(revision, layer, field); });
}

std::vector<double> DerivedValues::breaks(std::uint64_t revision, const JoinedValues& joined,
                                          const BreakRule& rule) {
  return keep_breaks(name_of_spread(revision, joined.key()), rule,
                     [&] { return spread(revision, joined); });
}

std::vector<double> DerivedValues::keep_breaks(
    const std::string& key, const BreakRule& rule,
    const std::function<std::shared_ptr<const ValueSpread>()>& spread) {
  return keep(name_of_breaks(key, rule), kMostRuledClasses * sizeof(double),
              [&](Entry& made) { made.breaks = class_breaks(rule, *spread()); })
      ->breaks;
}

std::size_t DerivedValues::memory() const {
  const std::lock_guard lock(mutex_);
  return kept_.bytes();
}

std::shared_ptr<DerivedValues::Entry> DerivedValues::keep(const std::string& key, std::size_t bytes,
                                                          const std::function<void(Entry&)>& find) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    if (auto* kept = kept_.find(key)) {
      entry = *kept;
    } else {
      entry = std::make_shared<Entry>();
      kept_.insert(key, entry, bytes + 2 * key.size() + kOverhead);
    }
  }
  std::call_once(entry->once, [&] { find(*entry); });
  return entry;
}

}  // namespace trapeze
