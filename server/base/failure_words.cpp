#include "server/base/failure_words.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <new>
#include <system_error>

namespace trapeze {

std::string failure_words(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "there is not enough memory";
  const auto* of_system = dynamic_cast<const std::system_error*>(&error);
  if (of_system != nullptr && of_system->code() == std::errc::resource_unavailable_try_again) {
    return "no more threads can be started, or there is not enough memory for them";
  }
  return error.what();
}

std::string failure_words(const std::exception& error, const std::string& file) {
  std::string words = failure_words(error);
  return words == error.what() ? words : file + ": " + words;
}

void log_failure(std::string_view what, const std::exception& error) noexcept {
  try {
    spdlog::error(fmt::format("{}: {}", what, failure_words(error)));
  } catch (const std::exception&) {
    // The message is lost; the thread is not.
  }
}

}  // namespace trapeze
