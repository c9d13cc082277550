// The configuration as it is read: from a TOML file, the environment and the command line.
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

/// A value from outside of the file, which it overrides.
struct ConfigOverride {
  std::string setting;  // "server.port"; empty: there is none of that name, which is a problem
  std::string value;
  std::string origin;  // how messages call it: "TRAPEZE_SERVER_PORT", "--port"
};

struct LoadedConfig {
  Config config;                        // with defaults for what is wrong
  std::vector<ConfigProblem> problems;  // in the order of the file, then of the overrides
  /// Where each setting that is not a default comes from: "server.port" from "trapeze.toml:4:8";
  /// in the file, also of each item of a list, "text.fonts[1]".
  std::map<std::string, std::string> origins;

  /// The origin of a setting, or of the item of that number if it is a list in the file.
  std::string origin_of(const std::string& setting, std::optional<std::size_t> item = {}) const;
};

/// Reads a TOML file, unless `path` is empty, and then applies the overrides, of which a
/// later one overrides an earlier one. Finds all that is wrong (of what is not TOML, the first).
/// Relative paths in the file are meant from its own folder, those of overrides from the working
/// directory. In all strings of the file, ${NAME} is replaced by that variable of the environment,
/// ${NAME:-words} by the words if it is not set, and $$ by $.
LoadedConfig load_config(const std::string& path, const std::vector<ConfigOverride>& overrides);

/// The same of a text, as if it stood in a file of that path, and without overrides. Never throws
/// for what is wrong with it.
LoadedConfig load_config_text(std::string_view text, const std::string& path);

/// The overrides of an environment of "NAME=value" strings that ends with a null: for each setting
/// TABLE.KEY, the variable TRAPEZE_TABLE_KEY. What begins with TRAPEZE_TABLE_ and is no setting is
/// among them, without a setting; but not what Kubernetes sets for services of such a name.
std::vector<ConfigOverride> environment_overrides(const char* const* environment);

/// Reads a TOML file alone. Throws std::runtime_error with all problems, one a line.
Config read_config(const std::string& path);

/// All problems, one a line: "trapeze.toml:4:8: server.port takes ...".
std::string problems_text(const std::vector<ConfigProblem>& problems);

/// Whether the source of a layer is a file, and not within an archive or in a database, which GDAL
/// opens by names of its own ("/vsizip/...", "PG:...").
bool is_file_path(const std::string& source);

/// Makes a layer of each file, named after it; characters that a layer name cannot hold become '_'.
/// Throws std::runtime_error if two files would get one name.
std::vector<LayerConfig> layers_of_files(const std::vector<std::string>& files);

}  // namespace trapeze
