// Named styles: those of the configuration, and posted ones.
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

/// A style as it is written in links: its name, if it has one, and further settings. With the name,
/// links stay short and follow changes of the named style.
struct StyleLink {
  std::string name;  // empty: none, or the default style
  StyleQuery own;

  /// Both as a query string, "style=night&fill=ff0000ff"; empty if there is neither.
  std::string query() const;
};

/// A query, and the style that it names.
struct StyledQuery {
  std::vector<QueryPair> pairs;
  std::shared_ptr<const StyleQuery> named;                     // null: none, or the default style
  std::string name = {};                                       // of that style
  std::shared_ptr<const ValueBook> tables = {};                // the posted ones; null: none
  std::shared_ptr<const std::vector<std::string>> fonts = {};  // available for labels; null: none

  /// The settings of the pairs, completed from the named style, with posted tables resolved.
  /// Problems, and the names in `others`, are as in StyleQuery::parse(); unknown fonts are a
  /// problem with status 400.
  Result<StyleQuery> style_for(std::span<const std::string> layers,
                               std::span<const std::string_view> others = {}) const;
  /// The same for links; with the same problems.
  Result<StyleLink> link_for(std::span<const std::string> layers,
                             std::span<const std::string_view> others = {}) const;
};

class StyleBook {
 public:
  /// `named` styles are kept as long as the book; `budget`, in bytes, is for posted ones, of which
  /// the least recently used are removed first.
  /// Tables that styles name are looked up in `tables`, which may be null. `fonts` are the names of
  /// fonts available for labels.
  explicit StyleBook(std::map<std::string, StyleQuery> named = {},
                     std::size_t budget = kDefaultBudget,
                     std::shared_ptr<const ValueBook> tables = nullptr,
                     std::vector<std::string> fonts = {});

  /// The query with the style that its `style` parameter names. The problem is an unknown style,
  /// with the given status, or a parameter `style` given twice, 400.
  Result<StyledQuery> read(std::vector<QueryPair> query, int status_of_unknown = 400) const;

  /// The id of a posted style.
  static std::string id_of(const StyleQuery& style);
  /// The approximate number of bytes it takes from the budget.
  static std::size_t memory_of(const StyleQuery& style);

  /// Stores the style under id_of(style), which is derived from its contents: equal styles have
  /// equal ids on every server. The problem is a style that is too long, or larger than the budget.
  Result<std::string> post(StyleQuery style);

  /// Null if there is no style with that name or id.
  std::shared_ptr<const StyleQuery> find(std::string_view name) const;
  /// A posted table; null if there is none with that id.
  std::shared_ptr<const ValueTable> find_table(const std::string& id) const;
  /// The names from the configuration, in order.
  std::vector<std::string> names() const;
  /// Bytes used by posted styles.
  std::size_t memory() const;

  /// The name of the style that sets nothing: each layer is drawn in its own style.
  static constexpr std::string_view kDefaultName = "default";
  static constexpr std::size_t kDefaultBudget = std::size_t{defaults::kPostedStylesMegabytes} << 20;
  /// In bytes of canonical text. 30 layers, each with 64 classes, 256 ids, 256 highlighted ids and
  /// the longest filter, use about half of it.
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
