// What is told of an exception that ends what was to be done.
#pragma once

#include <exception>
#include <string>

namespace trapeze {

/// The words of the exception; of memory or threads that cannot be had, that it is they.
std::string failure_words(const std::exception& error);

}  // namespace trapeze
