// Messages for exceptions that end an operation.
#pragma once

#include <exception>
#include <string>

namespace trapeze {

/// The message of the exception, which names its object; if memory or threads are not available, a
/// message that says so.
std::string failure_words(const std::exception& error);
/// The same for an operation on a file, which the message names.
std::string failure_words(const std::exception& error, const std::string& file);

}  // namespace trapeze
