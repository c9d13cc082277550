#include "server/data/named_tables.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <fstream>
#include <stdexcept>
#include <utility>

#include "server/values/read_values.h"

namespace trapeze {
namespace {

// Operators know how much memory they have: only sizes that are most likely mistakes are refused.
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

std::shared_ptr<const ValueTable> table_in(const std::string& bytes, const ValueTableConfig& config,
                                           const ValueNames& columns) {
  const auto format = table_format({}, bytes);
  auto table = read_values(bytes, *format, {columns, kMostRows});
  if (!table) throw std::runtime_error(fmt::format("{}: {}", config.file, table.problem().detail));
  return std::make_shared<const ValueTable>(*std::move(table));
}

NamedTable read_table(const ValueTableConfig& config) {
  const std::string bytes = bytes_of_file(config.file);
  NamedTable named{table_in(bytes, config, {config.key, config.value}), config.title,
                   config.attribution};
  const ValueNames& names = named.table->names();
  for (const std::string& language : config.languages) {
    const std::string column = fmt::format("{}:{}", names.value, language);
    named.languages[language] = table_in(bytes, config, {names.key, column});
  }
  return named;
}

}  // namespace

std::shared_ptr<const NamedTables> read_named_tables(
    const std::map<std::string, ValueTableConfig>& tables) {
  NamedTables read;
  for (const auto& [name, config] : tables) {
    try {
      NamedTable named = read_table(config);
      const ValueTable& table = *named.table;
      spdlog::info(fmt::format(
          "{}: {} rows of {}, by {}{}", config.file, table.size(), table.names().value,
          table.names().key,
          named.languages.empty() ? ""
                                  : fmt::format(", in {} more languages", named.languages.size())));
      read.emplace(name, std::move(named));
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
