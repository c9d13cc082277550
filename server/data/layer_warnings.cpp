#include "server/data/layer_warnings.h"

#include "server/data/title_attribute.h"

namespace trapeze {

std::string without_title_words(const std::string& title_attribute) {
  return "has no attribute \"" + title_attribute + "\": its features have no title";
}

std::string find_title_problem(const FeatureTable& features, const std::string& title_attribute) {
  if (title_attribute.empty() || title_field(features, title_attribute)) return {};
  return without_title_words(title_attribute);
}

std::string find_overview_problem(const PreparedParts& parts) {
  if (parts.overview() != nullptr || parts.parts().size() == 1) return {};
  return "there is no overview, so a tile of a low zoom reads every part; `trapeze prepare "
         "--join` makes one";
}

}  // namespace trapeze
