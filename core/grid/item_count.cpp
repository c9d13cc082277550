#include "core/grid/item_count.h"

#include <stdexcept>

namespace trapeze {

std::string too_many_words(std::size_t count, const char* what, std::size_t most) {
  return std::to_string(count) + " " + what + ", of which there can be " + std::to_string(most) +
         " at most";
}

void throw_too_many(std::size_t count, const char* what, std::size_t most) {
  throw std::length_error(too_many_words(count, what, most));
}

}  // namespace trapeze
