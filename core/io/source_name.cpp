#include "core/io/source_name.h"

#include <regex>

namespace trapeze {

std::string name_of_source(const std::string& path) {
  static const std::regex assignment(R"((password\s*=\s*)('(\\.|[^'])*'|[^\s&]+))",
                                     std::regex::icase);
  static const std::regex user(R"((://[^/:@]*:)[^/@]*@)");
  return std::regex_replace(std::regex_replace(path, assignment, "$1***"), user, "$1***@");
}

}  // namespace trapeze
