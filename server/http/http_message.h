// Requests and responses as the server thinks of them, whatever library speaks HTTP.
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
  std::string host;           // as sent, unchecked; empty if none was
  std::string if_none_match;  // as sent; empty if none was
  std::string body = {};      // untrusted
  ClientAddress client = {};  // who asks: the peer, or whom a trusted proxy speaks for
  std::shared_ptr<Disconnection> disconnection = {};  // null: it is not watched for
  std::string accept_encoding = {};                   // as sent; empty if none was
  std::string content_type = {};                      // of the body, as sent; empty if none was
  std::string content_encoding = {};                  // of the body, as sent; empty if none was
};

struct HttpResponse {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  /// Null for responses that have none (204, 304). For HEAD it is what GET would send: the
  /// connection leaves it out and keeps its length.
  std::shared_ptr<const std::string> body;
  /// What the body tells of, so that it can be told in other words; null if all went well.
  std::shared_ptr<const Problem> problem = {};

  std::string_view header(std::string_view name) const {
    for (const auto& [key, value] : headers) {
      if (key == name) return value;
    }
    return {};
  }
};

using Respond = std::function<void(HttpResponse)>;

/// The response that tells of a problem, as application/problem+json, not to be stored by caches.
/// With 503 it asks the client to try again after a second.
HttpResponse problem_response(const Problem& problem);
/// The same, to be tried again after so long; rounded up to seconds, one at least.
HttpResponse problem_response(const Problem& problem, std::chrono::duration<double> retry_after);

/// Whether an If-None-Match header names `entity_tag` (weakly compared, as RFC 7232 wants it).
bool matches_entity_tag(std::string_view if_none_match, std::string_view entity_tag);

}  // namespace trapeze
