// What to serve and how, from a TOML file and the command line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/vertex_weight.h"
#include "core/web_mercator.h"
#include "render/colour.h"
#include "render/make_renderer.h"
#include "server/style_parameters.h"

namespace trapeze {

struct LayerConfig {
  std::string name;      // is_layer_name() holds
  std::string file;      // empty only if `prepared` is set
  std::string prepared;  // a prepared file of it, which is served in its place; may be empty
  std::string title;     // the name if not set
  std::string attribution;
  std::string description;
  StyleQuery style;  // where a request says nothing; for all layers, so without their names
  std::vector<ParameterId> locked;    // what requests cannot set for the layer
  std::optional<WeightRule> weights;  // unset: as a file was prepared, else Douglas-Peucker
  int min_zoom = 0;                   // the layer is drawn at zooms min_zoom to max_zoom
  int max_zoom = kMaxZoom;

  const std::string& file_to_open() const { return prepared.empty() ? file : prepared; }
};

struct ServerConfig {
  std::string address = "0.0.0.0";
  std::uint16_t port = 8080;      // 0: any free port
  unsigned threads = 2;           // for sockets
  unsigned workers = 0;           // for drawing; 0: one a core
  std::size_t queue = 256;        // requests that may wait for a worker
  unsigned deadline_ms = 10'000;  // a request that waits longer is given up
  unsigned batch = 8;             // tiles drawn in one pass, at most
  unsigned cache_mb = 256;        // of memory for tiles that were drawn; 0: none are kept
  std::string cache_control = "public, max-age=3600";  // of tiles
  unsigned posted_styles_mb = 16;                      // of memory for styles that are posted
  RendererOptions renderer;
  std::string public_url;  // of the server as the world sees it, without a '/' at the end
  // Host headers that are answered; empty: all. "*.name" stands for all below a name; what is
  // written without a port holds for every port. Not looked at if there is a public_url.
  std::vector<std::string> allowed_hosts;
  std::string web_root;  // folder of the viewer, empty for none
};

struct Config {
  ServerConfig server;
  std::map<std::string, StyleQuery> styles;  // by name, for which is_style_name() holds
  std::vector<LayerConfig> layers;           // names are unique
};

/// Reads a TOML file; relative paths in it are meant from its own folder. Throws std::runtime_error
/// that says file:line:column, what is wrong and what is allowed.
Config read_config(const std::string& path);

/// Makes a layer of each file, named after it; characters that a layer name cannot hold become '_'.
/// Throws std::runtime_error if two files would get one name.
std::vector<LayerConfig> layers_of_files(const std::vector<std::string>& files);

}  // namespace trapeze
