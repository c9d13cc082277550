// Requests and responses as used in the server, independent of the HTTP library.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/problem.h"
#include "server/http/client_address.h"
#include "server/http/disconnection.h"

namespace trapeze {

struct HttpRequest {
  std::string method;
  std::string target;
  std::string host;           // of the target or the header, unchecked; empty if none was sent
  std::string if_none_match;  // as sent; empty if none was
  std::string body = {};      // untrusted
  ClientAddress client = {};  // the peer, or the client that a trusted proxy reports
  std::shared_ptr<Disconnection> disconnection = {};  // null: not watched
  std::string accept_encoding = {};                   // as sent; empty if none was
  std::string content_type = {};                      // of the body, as sent; empty if none was
  std::string content_encoding = {};                  // of the body, as sent; empty if none was
  // Whether `client` is a trusted proxy itself, as it reports none: limits for one address do not
  // apply.
  bool is_of_proxy = false;
};

struct HttpResponse {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  /// Null for responses without a body (204, 304). For HEAD it is the body that GET would return:
  /// the connection does not send it but states its length.
  std::shared_ptr<const std::string> body;
  /// The problem that the body describes, so that it can be rendered in another format; null if
  /// there is none.
  std::shared_ptr<const Problem> problem = {};

  std::string_view header(std::string_view name) const {
    for (const auto& [key, value] : headers) {
      if (key == name) return value;
    }
    return {};
  }
};

using Respond = std::function<void(HttpResponse)>;

/// The response for a problem, as application/problem+json, not to be stored by caches. With status
/// 503 it asks the client to retry after a second.
HttpResponse problem_response(const Problem& problem);
/// The same with the given retry time, rounded up to seconds, at least one.
HttpResponse problem_response(const Problem& problem, std::chrono::duration<double> retry_after);

/// Lets scripts of pages from any origin read the response and the headers that are of use to them.
void allow_every_origin(HttpResponse& response);

/// Whether an If-None-Match header names `entity_tag` (weak comparison, as RFC 7232 requires).
bool matches_entity_tag(std::string_view if_none_match, std::string_view entity_tag);

}  // namespace trapeze
