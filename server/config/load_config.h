// Reads the configuration from a TOML file, the environment and the command line.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/config/config.h"

namespace trapeze {

/// What is wrong with a configuration, where, and what is allowed.
struct ConfigProblem {
  std::string where;  // "trapeze.toml:4:8", "TRAPEZE_SERVER_PORT", "--port"
  std::string what;
};

/// A value from outside the file, which it overrides.
struct ConfigOverride {
  std::string setting;  // "server.port"; empty: no such setting, which is a problem
  std::string value;
  std::string origin;  // name in messages: "TRAPEZE_SERVER_PORT", "--port"
};

struct LoadedConfig {
  Config config;                        // with defaults in place of invalid values
  std::vector<ConfigProblem> problems;  // in the order of the file, then of the overrides
  /// The origin of each setting that is not a default: "server.port" is from "trapeze.toml:4:8".
  /// For lists in the file, also the origin of each item, "text.fonts[1]".
  std::map<std::string, std::string> origins;

  /// The origin of a setting, or of the item with that index if it is a list in the file.
  std::string origin_of(const std::string& setting, std::optional<std::size_t> item = {}) const;
};

/// Reads a TOML file, unless `path` is empty, and then applies the overrides; later ones take
/// precedence. Finds all problems (in a file that is not valid TOML, only the first one). Relative
/// paths in the file are relative to its folder, those in overrides to the working directory. In
/// all strings of the file, ${NAME} is replaced by that environment variable, ${NAME:-words} by the
/// words if the variable is not set or empty, and $$ by $.
LoadedConfig load_config(const std::string& path, const std::vector<ConfigOverride>& overrides);

/// The same for a text, as if it were in a file at that path, and without overrides. Reports
/// problems instead of throwing.
LoadedConfig load_config_text(std::string_view text, const std::string& path);

/// The overrides in an environment, an array of "NAME=value" strings that ends with null: the
/// variable TRAPEZE_TABLE_KEY for each setting TABLE.KEY. Variables that begin with TRAPEZE_TABLE_
/// but match no setting are included without a setting. Those that Kubernetes sets for services
/// with such names are not included, whether they match or not.
std::vector<ConfigOverride> environment_overrides(const char* const* environment);

/// Reads a TOML file alone. Throws std::runtime_error with all problems, one per line.
Config read_config(const std::string& path);

/// All problems, one per line: "trapeze.toml:4:8: server.port takes ...".
std::string problems_text(const std::vector<ConfigProblem>& problems);

/// Whether the source of a layer is a file, and not inside an archive or in a database, for which
/// GDAL has names of its own ("/vsizip/...", "PG:...").
bool is_file_path(const std::string& source);

/// Creates a layer for each file, named after it; characters that are not allowed in layer names
/// are replaced by '_'. Throws std::runtime_error if two files would get the same name.
std::vector<LayerConfig> layers_of_files(const std::vector<std::string>& files);

}  // namespace trapeze
