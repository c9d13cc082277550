#include "server/styles/style_book.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/base/digest.h"
#include "server/base/nearest_name.h"

namespace trapeze {
namespace {

std::map<std::string, std::shared_ptr<const StyleQuery>, std::less<>> shared(
    std::map<std::string, StyleQuery>&& named) {
  std::map<std::string, std::shared_ptr<const StyleQuery>, std::less<>> styles;
  for (auto& [name, style] : named) {
    styles.emplace(name, std::make_shared<const StyleQuery>(std::move(style).configured()));
  }
  return styles;
}

Problem unknown_fonts(const std::string& name, const std::vector<std::string>& known) {
  return {400, fmt::format("There are no fonts of that name{}", suggestion_or_stop(name, known)),
          "label-font", name,
          known.empty() ? "nothing: no fonts are configured"
                        : fmt::format("one of {}", fmt::join(known, ", "))};
}

std::size_t memory_of_text(std::string_view canonical_text) {
  constexpr std::size_t kOverhead = 512;  // approximate, for an entry and its values
  return kOverhead + 4 * canonical_text.size();
}

}  // namespace

Result<StyleQuery> StyledQuery::style_for(std::span<const std::string> layers,
                                          std::span<const std::string_view> others) const {
  auto style = StyleQuery::parse(pairs, layers, others);
  if (!style) return style;
  StyleQuery made = named == nullptr ? *std::move(style) : style->over(*named, layers);
  for (const StyleSetting& setting : made.settings()) {
    if (setting.parameter != ParameterId::label_font) continue;
    const auto& font = std::get<std::string>(setting.value);
    if (fonts == nullptr || std::ranges::find(*fonts, font) == fonts->end()) {
      return unknown_fonts(font, fonts == nullptr ? std::vector<std::string>() : *fonts);
    }
  }
  if (tables == nullptr) return made;
  return std::move(made).with_tables([this](const std::string& id) { return tables->find(id); });
}

Result<StyleLink> StyledQuery::link_for(std::span<const std::string> layers,
                                        std::span<const std::string_view> others) const {
  auto own = StyleQuery::parse(pairs, layers, others);
  if (!own) return std::move(own).problem();
  return StyleLink{name, *std::move(own)};
}

std::string StyleLink::query() const {
  std::string text = own.canonical_text();
  if (name.empty()) return text;
  return fmt::format("style={}{}{}", name, text.empty() ? "" : "&", text);
}

StyleBook::StyleBook(std::map<std::string, StyleQuery> named, std::size_t budget,
                     std::shared_ptr<const ValueBook> tables, std::vector<std::string> fonts)
    : named_(shared(std::move(named))),
      tables_(std::move(tables)),
      fonts_(std::make_shared<const std::vector<std::string>>(std::move(fonts))),
      posted_(budget) {}

Result<StyledQuery> StyleBook::read(std::vector<QueryPair> query, int status_of_unknown) const {
  const auto is_style = [](const QueryPair& pair) { return pair.first == "style"; };
  const auto asked = std::ranges::find_if(query, is_style);
  if (asked == query.end()) return StyledQuery{std::move(query), nullptr, {}, tables_, fonts_};
  const std::string name = asked->second;
  if (std::any_of(asked + 1, query.end(), is_style)) {
    return Problem{400, "The parameter style is given twice.", "style", name, "one name, once"};
  }
  if (name == kDefaultName) return StyledQuery{std::move(query), nullptr, {}, tables_, fonts_};
  auto style = find(name);
  if (style == nullptr) return unknown(name, status_of_unknown);
  return StyledQuery{std::move(query), std::move(style), name, tables_, fonts_};
}

Problem StyleBook::unknown(const std::string& name, int status) const {
  std::string takes = "an id returned by POST /styles";
  if (!named_.empty()) takes = fmt::format("one of {}, or {}", fmt::join(names(), ", "), takes);
  std::vector<std::string> known = names();
  known.emplace_back(kDefaultName);
  return {status,
          fmt::format("There is no style of that name{} Posted styles expire when memory is "
                      "needed: post it again.",
                      suggestion_or_stop(name, known)),
          "style", name, takes};
}

std::string StyleBook::id_of(const StyleQuery& style) {
  return digest_of(style.canonical_text());
}

std::size_t StyleBook::memory_of(const StyleQuery& style) {
  return memory_of_text(style.canonical_text());
}

Result<std::string> StyleBook::post(StyleQuery style) {
  const std::string text = style.canonical_text();
  if (text.size() > kMaxStyleLength) {
    return Problem{400,
                   fmt::format("A style can have at most {} bytes as a query; this one has {}.",
                               kMaxStyleLength, text.size())};
  }
  const std::size_t bytes = memory_of_text(text);
  std::string id = digest_of(text);
  const std::lock_guard lock(mutex_);
  if (bytes > posted_.budget()) {
    return Problem{403, "This server does not keep posted styles, or none of this size."};
  }
  if (posted_.find(id) == nullptr) {
    posted_.insert(id, std::make_shared<const StyleQuery>(std::move(style)), bytes);
  }
  return id;
}

std::shared_ptr<const StyleQuery> StyleBook::find(std::string_view name) const {
  if (const auto named = named_.find(name); named != named_.end()) return named->second;
  const std::lock_guard lock(mutex_);
  const auto* style = posted_.find(std::string(name));
  return style == nullptr ? nullptr : *style;
}

std::shared_ptr<const ValueTable> StyleBook::find_table(const std::string& id) const {
  return tables_ == nullptr ? nullptr : tables_->find(id);
}

std::vector<std::string> StyleBook::names() const {
  std::vector<std::string> names;
  for (const auto& [name, style] : named_) names.push_back(name);
  return names;
}

std::size_t StyleBook::memory() const {
  const std::lock_guard lock(mutex_);
  return posted_.bytes();
}

}  // namespace trapeze
