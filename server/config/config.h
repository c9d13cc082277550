// What to serve and how: the settings with their defaults.
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
  std::string name;           // is_url_name() holds
  std::string file;           // empty only if `prepared` is set
  SourceSelection selection;  // of the file
  std::string live_query;     // see ChangeFeed; empty: changes are not asked for
  std::string prepared;       // a prepared file of it, which is served in its place; may be empty
  std::string title;          // the name if not set
  std::string attribution;
  std::string description;
  StyleQuery style;  // where a request says nothing; for all layers, so without their names
  std::vector<ParameterId> locked;       // what requests cannot set for the layer
  std::optional<WeightRule> weights;     // unset: as a file was prepared, else Douglas-Peucker
  std::optional<CoverageMode> coverage;  // unset: as a file was prepared, else kUsualCoverage
  std::optional<double> close_gaps;      // metres; unset: as a file was prepared, else 0
  std::optional<double> merge;           // pixels; unset: as a file was prepared, else 0
  std::string merge_by;                  // attribute; empty: as a file was prepared, else none
  bool fast_topology = false;            // requests may ask for topology=fast
  SkipLimit max_skipped;                 // more skipped features are an error
  bool may_shrink = false;               // read again, it may have fewer than half of its features
  int min_zoom = 0;                      // the layer is drawn at zooms min_zoom to max_zoom
  int max_zoom = kMaxZoom;
  std::optional<int> detail_zoom;  // up to which its data is true; unset: unknown
  std::string group;               // of layers that belong together; empty: none
  std::string title_attribute;     // what its features are called by; empty: found by its name
  std::vector<std::string> crs;  // systems that it is built for, kBuiltCrs among them; empty: that
  std::string grid;  // of these the one whose grid it is on, see with_grids(); empty: kBuiltCrs

  const std::string& file_to_open() const { return prepared.empty() ? file : prepared; }
  /// Whether it is built without the topological consistency test as well: also if its own style
  /// says topology=fast.
  bool has_fast_topology() const;
};

/// Values that styles may join to layers by a key.
struct ValueTableConfig {
  std::string file;         // CSV or JSON
  std::string key;          // the column of keys; empty: the first
  std::string value;        // the column of values; empty: the second
  std::string title;        // of the values, for people; empty: the name of the column
  std::string attribution;  // what maps must say about where they are from
  std::vector<std::string> languages = {};  // tags; each has a column, VALUE:LANGUAGE
};

/// Fonts by a name.
struct FontsConfig {
  std::vector<std::string> files;  // as Fonts::add() takes them, in order
};

struct ServerConfig {
  std::string address{defaults::kAddress};
  std::uint16_t port = defaults::kPort;                // 0: any free port
  unsigned threads = defaults::kThreads;               // for sockets
  unsigned workers = 0;                                // for drawing; 0: one a core
  std::size_t queue = defaults::kQueue;                // tiles that may wait for a worker
  unsigned deadline_ms = defaults::kDeadline.count();  // a tile that takes longer is given up
  unsigned batch = defaults::kBatch;                   // tiles drawn in one pass, at most
  unsigned cache_mb = 256;  // of memory for tiles that were drawn; 0: none are kept
  std::string cache_control{defaults::kCacheControl};  // of tiles
  unsigned posted_styles_mb =
      defaults::kPostedStylesMegabytes;  // of memory for styles that are posted
  RendererOptions renderer;
  std::string public_url;  // of the server as the world sees it, without a '/' at the end
  // Host headers that are answered; empty: all. "*.name" stands for all below a name; what is
  // written without a port holds for every port. Not looked at if there is a public_url.
  std::vector<std::string> allowed_hosts;
  std::vector<std::string> tile_matrix_sets;  // files of more of them, see read_tile_matrix_set()
  std::string web_root;  // folder in the place of the viewer of the program; empty: none
  bool metrics = true;   // whether /metrics is there; it always is at the admin address
  std::vector<AddressRange> trusted_proxies;  // whose X-Forwarded-For is believed
  unsigned watch_ms = 2000;                   // between looks at the files, for changes; 0: none
  unsigned live_ms = 250;                     // between questions to databases, for changes
  unsigned drain_delay_ms = 0;                // told to stop, it goes on so long, being not ready
  unsigned drain_timeout_ms =
      defaults::kDrainTimeout.count();  // and then waits so long for what is under way
};

struct LimitsConfig {
  std::size_t connections = defaults::kConnections;
  std::size_t connections_per_address = defaults::kConnectionsPerAddress;
  std::uint32_t header_bytes = defaults::kHeaderBytes;  // request line and header together
  std::size_t target_bytes = kMaxTargetLength;          // path and query together
  std::uint32_t body_bytes = defaults::kBodyBytes;      // of a request that has one
  std::size_t layers = kMaxLayersPerTile;               // of one tile
  int scale = kMaxScale;
  int zoom = kMaxZoom;
  std::uint64_t map_pixels = defaults::kMapPixels;              // of a picture of a window
  unsigned idle_timeout_ms = defaults::kIdleTimeout.count();    // until a request begins
  unsigned read_timeout_ms = defaults::kReadTimeout.count();    // from its first byte to its last
  unsigned write_timeout_ms = defaults::kWriteTimeout.count();  // for a whole response
  double drawn_per_second = 0;  // tiles not in the cache, for one address; 0: as many as it likes
  double drawn_burst = 2000;    // so many of them at once
  std::uint64_t tile_cost = defaults::kTileCost;      // as drawing_cost() counts; 0: no limit
  double cost_per_second = defaults::kCostPerSecond;  // of dear tiles, for one address; 0: no limit
  double cost_burst = defaults::kCostBurst;
  std::uint32_t values_bytes = defaults::kValuesBytes;    // of a table that is posted
  std::size_t values_rows = defaults::kValuesRows;        // of it
  unsigned values_mb = defaults::kPostedValuesMegabytes;  // of memory for all that are posted
};

struct TextConfig {
  std::vector<std::string> fonts;  // as Fonts::add() takes them, in order; empty: usual_fonts()
};

enum class LogFormat { text, json };

struct LogConfig {
  std::string level = "info";  // the least that is logged, in the words of spdlog
  std::string access;          // "stdout", "stderr", a file, or empty: no log of requests
  LogFormat access_format = LogFormat::text;
};

/// A second address, for those who run the server.
struct AdminConfig {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: there is none
};

/// What is found out when the data has changed.
struct ChangesConfig {
  std::string zooms;    // a range of them, of the tiles that are listed; empty: none are
  std::string command;  // for a shell, see ChangeLog; empty: none
};

struct ViewerConfig {
  std::string title = "Trapeze";
  std::string start;  // what stands after # in its address, where the address has nothing
};

struct Config {
  ServerConfig server;
  ViewerConfig viewer;
  LimitsConfig limits;
  TextConfig text;
  LogConfig log;
  AdminConfig admin;
  ChangesConfig changes;
  std::map<std::string, StyleQuery> styles;        // by name, for which is_url_name() holds
  std::map<std::string, ValueTableConfig> values;  // tables by name, which is as those of styles
  std::map<std::string, FontsConfig> fonts;        // for labels; names are as those of styles
  std::vector<LayerConfig> layers;                 // names are unique
};

}  // namespace trapeze
