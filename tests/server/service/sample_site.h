// A site over the fixtures, without a socket, drawn with the software renderer.
#pragma once

#include <memory>
#include <string>

#include "server/data/dataset.h"
#include "server/http/http_server.h"
#include "server/labels/label_book.h"
#include "server/service/site.h"
#include "server/tiles/tile_service.h"

namespace trapeze::testing {

std::string fixture(const std::string& name);

/// A style for all layers, parsed from a query.
StyleQuery style_of(const std::string& query);

/// The target with one part replaced; throws if it lacks that part.
std::string changed(std::string target, const std::string& from, const std::string& to);

/// Two layers. In a tile of zoom 0, "rings" covers pixels 64 to 192 in both directions except the
/// hole from 96 to 160, which contains an island from 112 to 144; "west" covers columns 0 to 128.
std::shared_ptr<const Dataset> sample_dataset();

/// Labels in the installed fonts; always the same instance.
std::shared_ptr<LabelBook> label_book();

class SampleSite {
 public:
  explicit SampleSite(bool is_loaded = true, StaticFiles files = {}, SiteOptions options = {});

  Site& site() { return site_; }
  /// The site as the handler of a server.
  Handler handler();
  CurrentDataset& data() { return data_; }

  /// Sends a GET request and waits for the response.
  HttpResponse get(const std::string& target, const std::string& if_none_match = {});
  HttpResponse handle(const HttpRequest& request);

 private:
  CurrentDataset data_;
  TileCache cache_{std::size_t{1} << 20};
  TileService tiles_;
  Site site_;
};

}  // namespace trapeze::testing
