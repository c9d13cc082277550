// Styles that have names: those of the configuration, and those that were posted.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/defaults.h"
#include "server/base/lru_map.h"
#include "server/base/result.h"
#include "server/base/url.h"
#include "server/styles/style_parameters.h"
#include "server/values/value_book.h"

namespace trapeze {

/// A style as links have it: its name where it has one, so that they stay short and follow what the
/// name stands for, and what is set besides.
struct StyleLink {
  std::string name;  // empty: none, or the one that sets nothing
  StyleQuery own;

  /// Both as a query, "style=night&fill=ff0000ff"; empty if there is neither.
  std::string query() const;
};

/// A query, and the style that it names.
struct StyledQuery {
  std::vector<QueryPair> pairs;
  std::shared_ptr<const StyleQuery> named;       // null: none, or the one that sets nothing
  std::string name = {};                         // of that style
  std::shared_ptr<const ValueBook> tables = {};  // that were posted; null: none were
  std::shared_ptr<const std::vector<std::string>> fonts = {};  // that labels may choose; null: none

  /// What the pairs set and, where they are silent, the named style, with the tables that were
  /// posted. Problems, and the names of `others`, are those of StyleQuery::parse(), and fonts that
  /// there are not, 400.
  Result<StyleQuery> style_for(std::span<const std::string> layers,
                               std::span<const std::string_view> others = {}) const;
  /// The same for links; with the same problems.
  Result<StyleLink> link_for(std::span<const std::string> layers,
                             std::span<const std::string_view> others = {}) const;
};

class StyleBook {
 public:
  /// `named` are kept as long as the book; `budget`, in bytes, is for those that are posted. Of
  /// these, the ones not asked for longest go first.
  /// Styles find the tables that they name in `tables`, which may be null. `fonts` are the names of
  /// those that labels may choose.
  explicit StyleBook(std::map<std::string, StyleQuery> named = {},
                     std::size_t budget = kDefaultBudget,
                     std::shared_ptr<const ValueBook> tables = nullptr,
                     std::vector<std::string> fonts = {});

  /// The query with the style that its `style` names. The problem is a style that there is not, of
  /// that status, or one that is named twice, 400.
  Result<StyledQuery> read(std::vector<QueryPair> query, int status_of_unknown = 400) const;

  /// The id of a style that is posted.
  static std::string id_of(const StyleQuery& style);
  /// About how many bytes of the budget it takes.
  static std::size_t memory_of(const StyleQuery& style);

  /// Keeps the style under id_of() it, from what it says: equal styles have equal ids, on
  /// every server. The problem is a style that is too long, or larger than the budget.
  Result<std::string> post(StyleQuery style);

  /// Null if there is none of that name or id.
  std::shared_ptr<const StyleQuery> find(std::string_view name) const;
  /// A table that was posted; null if there is none of that id.
  std::shared_ptr<const ValueTable> find_table(const std::string& id) const;
  /// Of the configuration, in order.
  std::vector<std::string> names() const;
  /// Bytes held by posted styles.
  std::size_t memory() const;

  /// The name of the style that sets nothing: each layer has its own.
  static constexpr std::string_view kDefaultName = "default";
  static constexpr std::size_t kDefaultBudget = std::size_t{defaults::kPostedStylesMegabytes} << 20;
  /// In bytes of canonical text. 30 layers of which each has 64 classes, 256 ids, 256 highlighted
  /// and the longest filter take about half of it.
  static constexpr std::size_t kMaxStyleLength = std::size_t{1} << 20;

 private:
  Problem unknown(const std::string& name, int status) const;

  const std::map<std::string, std::shared_ptr<const StyleQuery>, std::less<>> named_;
  const std::shared_ptr<const ValueBook> tables_;  // null: none
  const std::shared_ptr<const std::vector<std::string>> fonts_;
  mutable std::mutex mutex_;                                               // guards posted_
  mutable LruMap<std::string, std::shared_ptr<const StyleQuery>> posted_;  // by id
};

}  // namespace trapeze
