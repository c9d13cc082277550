// What is told of an exception that ends what was to be done.
#pragma once

#include <exception>
#include <string>

namespace trapeze {

/// The words of the exception, which name what they are about; of memory or threads that cannot be
/// had, that it is they.
std::string failure_words(const std::exception& error);
/// The same of what was to be done with a file, which is named.
std::string failure_words(const std::exception& error, const std::string& file);

}  // namespace trapeze
