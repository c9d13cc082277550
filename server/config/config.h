// What to serve and how: all settings with their defaults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/vertex_weight.h"
#include "core/borders/coverage_options.h"
#include "core/grid/web_mercator.h"
#include "core/io/source/source_selection.h"
#include "render/make_renderer.h"
#include "render/picture/colour.h"
#include "server/base/defaults.h"
#include "server/base/limits.h"
#include "server/config/skip_limit.h"
#include "server/http/client_address.h"
#include "server/styles/style_parameters.h"

namespace trapeze {

/// The reference system that every layer is built for.
inline constexpr const char* kBuiltCrs = "EPSG:3857";

struct LayerConfig {
  std::string name;           // must satisfy is_url_name()
  std::string file;           // empty only if `prepared` is set
  SourceSelection selection;  // what to read from the file
  std::string live_query;     // see ChangeFeed; empty: changes are not queried
  std::string prepared;       // a prepared file of it, served instead; may be empty
  std::string title;          // empty: the name
  std::string attribution;
  std::string description;
  StyleQuery style;  // default for requests; applies to all layers, so without layer names
  std::vector<ParameterId> locked;       // that requests cannot set for the layer
  std::optional<WeightRule> weights;     // unset: as the file was prepared, else Douglas-Peucker
  std::optional<CoverageMode> coverage;  // unset: as the file was prepared, else kUsualCoverage
  std::optional<double> close_gaps;      // metres; unset: as the file was prepared, else 0
  std::optional<double> merge;           // pixels; unset: as the file was prepared, else 0
  std::string merge_by;                  // attribute; empty: as the file was prepared, else none
  bool fast_topology = false;            // requests may set topology=fast
  SkipLimit max_skipped;                 // more skipped features are an error
  bool may_shrink = false;               // a reload may give fewer than half of its features
  int min_zoom = 0;                      // drawn at zooms min_zoom to max_zoom
  int max_zoom = kMaxZoom;
  std::optional<int> detail_zoom;  // up to which its data is accurate; unset: unknown
  std::string group;               // of layers that belong together; empty: none
  std::string title_attribute;     // attribute with feature titles; empty: found by its name
  std::vector<std::string> crs;    // systems it is built for, including kBuiltCrs; empty: only that
  std::string grid;  // the one whose grid this is on, see with_grids(); empty: kBuiltCrs

  const std::string& file_to_open() const { return prepared.empty() ? file : prepared; }
  /// Whether it is also built without the topological consistency test, which is the case as well
  /// if its own style sets topology=fast.
  bool has_fast_topology() const;
};

/// Values that styles may join to layers by a key.
struct ValueTableConfig {
  std::string file;                         // CSV or JSON
  std::string key;                          // the column of keys; empty: the first
  std::string value;                        // the column of values; empty: the second
  std::string title;                        // of the values, for people; empty: the column name
  std::string attribution;                  // attribution required on maps that use the values
  std::vector<std::string> languages = {};  // tags; column VALUE:LANGUAGE for each
};

/// Named fonts.
struct FontsConfig {
  std::vector<std::string> files;  // in order, see Fonts::add()
};

struct ServerConfig {
  std::string address{defaults::kAddress};
  std::uint16_t port = defaults::kPort;                // 0: any free port
  unsigned threads = defaults::kThreads;               // for sockets
  unsigned workers = 0;                                // for drawing; 0: one per core
  std::size_t queue = defaults::kQueue;                // tiles that may wait for a worker
  unsigned deadline_ms = defaults::kDeadline.count();  // tiles that take longer are abandoned
  unsigned batch = defaults::kBatch;                   // maximum number of tiles drawn in one pass
  unsigned cache_mb = 256;                             // memory for drawn tiles; 0: no cache
  std::string cache_control{defaults::kCacheControl};  // of tiles
  unsigned posted_styles_mb =
      defaults::kPostedStylesMegabytes;  // memory in megabytes for posted styles
  RendererOptions renderer;
  std::string public_url;  // URL of the server for clients, without a final '/'
  // Accepted Host headers; empty: all. "*.name" matches all subdomains of a name; an entry without
  // a port matches all ports. Ignored if there is a public_url.
  std::vector<std::string> allowed_hosts;
  std::vector<std::string> tile_matrix_sets;  // additional ones, see read_tile_matrix_set()
  std::string web_root;  // folder that replaces the built-in viewer; empty: none
  bool metrics = true;   // whether /metrics exists; at the admin address it always does
  std::vector<AddressRange> trusted_proxies;  // whose X-Forwarded-For is believed
  unsigned watch_ms = 2000;                   // between checks of the files for changes; 0: none
  unsigned live_ms = 250;                     // between queries of databases for changes
  unsigned drain_delay_ms = 0;                // continues so long after a stop request, not ready
  unsigned drain_timeout_ms =
      defaults::kDrainTimeout.count();  // after that, time for pending requests to finish
};

struct LimitsConfig {
  std::size_t connections = defaults::kConnections;
  std::size_t connections_per_address = defaults::kConnectionsPerAddress;
  std::uint32_t header_bytes = defaults::kHeaderBytes;  // request line and header together
  std::size_t target_bytes = kMaxTargetLength;          // path and query together
  std::uint32_t body_bytes = defaults::kBodyBytes;      // of a request with a body
  std::size_t layers = kMaxLayersPerTile;               // of one tile
  int scale = kMaxScale;
  int zoom = kMaxZoom;
  std::uint64_t map_pixels = defaults::kMapPixels;              // of the picture of a window
  unsigned idle_timeout_ms = defaults::kIdleTimeout.count();    // until a request begins
  unsigned read_timeout_ms = defaults::kReadTimeout.count();    // from its first byte to its last
  unsigned write_timeout_ms = defaults::kWriteTimeout.count();  // for a whole response
  double drawn_per_second = 0;  // tiles not in the cache, per address; 0: no limit
  double drawn_burst = 2000;    // as many at the same time
  std::uint64_t tile_cost = defaults::kTileCost;      // in units of drawing_cost(); 0: no limit
  double cost_per_second = defaults::kCostPerSecond;  // of costly tiles, per address; 0: no limit
  double cost_burst = defaults::kCostBurst;
  std::uint32_t values_bytes = defaults::kValuesBytes;    // of a posted table
  std::size_t values_rows = defaults::kValuesRows;        // of a posted table
  unsigned values_mb = defaults::kPostedValuesMegabytes;  // memory for all posted tables
};

struct TextConfig {
  std::vector<std::string> fonts;  // in order, see Fonts::add(); empty: usual_fonts()
};

enum class LogFormat { text, json };

struct LogConfig {
  std::string level = "info";  // lowest level logged, as named by spdlog
  std::string access;          // "stdout", "stderr", a file, or empty: no access log
  LogFormat access_format = LogFormat::text;
};

/// A second address, for operators.
struct AdminConfig {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: no admin address
};

/// What is computed when the data has changed.
struct ChangesConfig {
  std::string zooms;    // range of zooms of listed tiles; empty: none are listed
  std::string command;  // for a shell, see ChangeLog; empty: none
};

struct ViewerConfig {
  std::string title = "Trapeze";
  std::string start;  // fragment (after #) used if the address has none
};

struct Config {
  ServerConfig server;
  ViewerConfig viewer;
  LimitsConfig limits;
  TextConfig text;
  LogConfig log;
  AdminConfig admin;
  ChangesConfig changes;
  std::map<std::string, StyleQuery> styles;        // by name, which satisfies is_url_name()
  std::map<std::string, ValueTableConfig> values;  // tables by name; names are as for styles
  std::map<std::string, FontsConfig> fonts;        // for labels; names are as for styles
  std::vector<LayerConfig> layers;                 // names are unique
};

}  // namespace trapeze
