#include "server/data/named_tables.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <stdexcept>
#include <utility>

#include "server/values/read_values.h"

namespace trapeze {
namespace {

// Who runs the server knows what it can hold: only what can hardly be meant is refused.
constexpr std::size_t kMostRows = 10'000'000;
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto size = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (size < 0) throw std::runtime_error(fmt::format("cannot read {}", path));
  if (static_cast<std::size_t>(size) > kMostBytes) {
    throw std::runtime_error(fmt::format("{} is larger than a table may be, 1 GB", path));
  }
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw std::runtime_error(fmt::format("cannot read {}", path));
  return bytes;
}

ValueTable read_table(const ValueTableConfig& config) {
  const std::string bytes = bytes_of_file(config.file);
  const auto format = table_format({}, bytes);
  auto table = read_values(bytes, *format, {{config.key, config.value}, kMostRows});
  if (!table) throw std::runtime_error(fmt::format("{}: {}", config.file, table.problem().detail));
  return *std::move(table);
}

}  // namespace

std::shared_ptr<const NamedTables> read_named_tables(
    const std::map<std::string, ValueTableConfig>& tables) {
  NamedTables read;
  for (const auto& [name, config] : tables) {
    try {
      auto table = std::make_shared<const ValueTable>(read_table(config));
      spdlog::info("{}: {} rows of {}, by {}", config.file, table->size(), table->names().value,
                   table->names().key);
      read.emplace(name, NamedTable{std::move(table), config.title, config.attribution});
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("values \"{}\": {}", name, error.what()));
    }
  }
  return std::make_shared<const NamedTables>(std::move(read));
}

std::string find_table_problem(const ValueTableConfig& table) {
  try {
    read_table(table);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace trapeze
