#include "server/documents/wms.h"

#include <utility>
#include <variant>

#include "server/documents/identify.h"
#include "server/documents/legend.h"
#include "server/documents/wms_capabilities.h"
#include "server/documents/wms_request.h"

namespace trapeze {
namespace {

Result<Document> legend_in(const WmsLegendRequest& asked, const DocumentRequest& request) {
  DocumentRequest legend = request;
  legend.path = {"legend", asked.file};
  legend.query = asked.query;
  legend.named = asked.named;
  return legend_document(legend);
}

}  // namespace

Result<Document> wms_document(const DocumentRequest& request) {
  const auto parsed = parse_wms_request(request);
  if (!parsed) return parsed.problem();
  const WmsRequest& asked = *parsed;
  if (const auto* capabilities = std::get_if<WmsCapabilitiesRequest>(&asked)) {
    return wms_capabilities(*capabilities, request);
  }
  if (const auto* legend = std::get_if<WmsLegendRequest>(&asked)) {
    return legend_in(*legend, request);
  }
  const auto* info = std::get_if<WmsFeatureInfoRequest>(&asked);
  if (info == nullptr) return Problem{400, "This is a map."};
  auto text = identified_features(info->query, request.dataset, info->format);
  if (!text) return std::move(text).problem();
  return Document{info->content_type, *std::move(text)};
}

std::optional<Result<PictureRequest>> parse_wms_map(const DocumentRequest& request) {
  auto parsed = parse_wms_request(request);
  if (!parsed) return Result<PictureRequest>(std::move(parsed).problem());
  WmsRequest asked = *std::move(parsed);
  auto* window = std::get_if<WindowRequest>(&asked);
  if (window == nullptr) return std::nullopt;
  return Result<PictureRequest>(std::move(*window));
}

}  // namespace trapeze
