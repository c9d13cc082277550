#include "server/values/value_book.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

namespace trapeze {

Result<std::shared_ptr<const ValueTable>> ValueBook::post(ValueTable table) {
  const std::size_t bytes = table.memory();
  if (posted_.budget() == 0) return Problem{403, "This server does not keep posted tables."};
  if (bytes > posted_.budget()) {
    return Problem{
        413,
        fmt::format(
            "This table needs {} bytes of memory, but this server has {} for all posted tables.",
            bytes, posted_.budget())};
  }
  const std::lock_guard lock(mutex_);
  if (const auto* kept = posted_.find(table.id())) return *kept;
  auto made = std::make_shared<const ValueTable>(std::move(table));
  posted_.insert(made->id(), made, bytes);
  return std::shared_ptr<const ValueTable>(std::move(made));
}

std::shared_ptr<const ValueTable> ValueBook::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto* kept = posted_.find(id);
  return kept == nullptr ? nullptr : *kept;
}

std::size_t ValueBook::memory() const {
  const std::lock_guard lock(mutex_);
  return posted_.bytes();
}

}  // namespace trapeze
