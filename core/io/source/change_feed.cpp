#include "core/io/source/change_feed.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <ogrsf_frmts.h>

#include "core/io/source/gdal_messages.h"
#include "core/io/source/open_source.h"
#include "core/io/source/source_name.h"

namespace trapeze {
namespace {

std::string with_number(std::string query, std::int64_t number) {
  const std::string_view mark = ChangeFeed::kSince;
  for (std::size_t at = 0; (at = query.find(mark, at)) != std::string::npos;) {
    query.replace(at, mark.size(), std::to_string(number));
  }
  return query;
}

/// The same query with known names of its columns.
std::string with_names(std::string query) {
  while (!query.empty() && std::string_view("; \t\r\n").find(query.back()) != std::string::npos) {
    query.pop_back();
  }
  // The line feed ends a comment.
  return "SELECT number, id FROM (WITH changes(number, id) AS (" + query +
         "\n) SELECT number, id FROM changes) AS changes";
}

}  // namespace

struct ChangeFeed::Connection {
  GDALDatasetUniquePtr source;
  std::optional<bool> has_number_apart;  // see ask(); once known, since another query finds it out
};

ChangeFeed::ChangeFeed(std::string path, std::string query)
    : path_(std::move(path)), query_(std::move(query)) {
  require(query_.find(kSince) != std::string::npos, std::string("live_query has no ") + kSince);
  take();
}

ChangeFeed::~ChangeFeed() = default;
ChangeFeed::ChangeFeed(ChangeFeed&&) noexcept = default;

std::vector<std::int64_t> ChangeFeed::take() {
  try {
    if (connection_ == nullptr) {
      connection_ = std::make_unique<Connection>(Connection{open_source(path_), {}});
    }
    return ask();
  } catch (...) {
    connection_ = nullptr;
    throw;
  }
}

std::vector<std::int64_t> ChangeFeed::ask() {
  GdalMessages messages;
  GDALDataset& source = *connection_->source;
  const auto release = [&source](OGRLayer* layer) { source.ReleaseResultSet(layer); };
  const auto answer = [&](const std::string& query) {
    std::unique_ptr<OGRLayer, decltype(release)> rows(
        source.ExecuteSQL(query.c_str(), nullptr, nullptr), release);
    require(rows != nullptr, "cannot be asked what has changed: " + messages.text());
    return rows;
  };
  const std::string query = with_number(query_, since_);
  const auto rows = answer(query);
  // GDAL may report a column that it recognizes as the key of a table separately: the id, or the
  // number if that is the key of the table of changes.
  OGRFeatureDefn& columns = *rows->GetLayerDefn();
  const bool has_key_apart = columns.GetFieldCount() == 1 && *rows->GetFIDColumn() != '\0';
  if (has_key_apart && !connection_->has_number_apart) {
    const auto named = answer(with_names(query));
    connection_->has_number_apart = std::string_view(named->GetFIDColumn()) == "number";
  }
  const bool has_number_apart = has_key_apart && *connection_->has_number_apart;
  const auto is_integer = [&columns](int field) {
    const OGRFieldType type = columns.GetFieldDefn(field)->GetType();
    return type == OFTInteger || type == OFTInteger64;
  };
  const bool fits = has_key_apart ? is_integer(0)
                                  : columns.GetFieldCount() == 2 && is_integer(0) && is_integer(1);
  require(fits, "live_query must return two integer columns: a number, and the id of a feature");
  std::vector<std::int64_t> ids;
  std::int64_t last = since_;
  while (const OGRFeatureUniquePtr row{rows->GetNextFeature()}) {
    const std::int64_t number = has_number_apart ? row->GetFID() : row->GetFieldAsInteger64(0);
    last = std::max(last, number);
    ids.push_back(has_key_apart && !has_number_apart
                      ? row->GetFID()
                      : row->GetFieldAsInteger64(has_number_apart ? 0 : 1));
  }
  require(!messages.has_failure(), "cannot be asked what has changed: " + messages.text());
  since_ = last;
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

void ChangeFeed::require(bool condition, const std::string& words) const {
  if (!condition) throw std::runtime_error(name_of_source(path_) + ": " + words);
}

}  // namespace trapeze
