// Messages for exceptions that end an operation.
#pragma once

#include <exception>
#include <string>
#include <string_view>

namespace trapeze {

/// The message of the exception, which names its object; if memory or threads are not available, a
/// message that says so.
std::string failure_words(const std::exception& error);
/// The same for an operation on a file, which the message names.
std::string failure_words(const std::exception& error, const std::string& file);

/// Logs the message, after what was being done. For threads that must go on: if there is no memory
/// for that either, nothing is logged.
void log_failure(std::string_view what, const std::exception& error) noexcept;

}  // namespace trapeze
