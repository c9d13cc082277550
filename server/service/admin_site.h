// What is answered at the address for those who run the server.
#pragma once

#include <functional>
#include <string>

#include "server/base/url.h"
#include "server/changes/change_log.h"
#include "server/http/http_message.h"
#include "server/service/metrics.h"

namespace trapeze {

/// The state of the server in detail, as JSON: what /ready answers there. `problem` is what went
/// wrong when the layers were last read, empty if nothing did.
std::string state_json(const ServerFigures& figures, const std::string& problem);

/// Answers /metrics, /ready (503 with the same details while the server is not ready), /health and
/// /changes?since=GENERATION (503 while they are being found, 404 for a generation that is not
/// among the last few); everything else with 404. Thread-safe as far as `figures`, `problem` and
/// `metrics` are.
class AdminSite {
 public:
  struct Sources {
    std::function<ServerFigures()> figures;
    std::function<std::string()> problem;
    std::function<std::string()> metrics;
    const ChangeLog* changes = nullptr;  // outlives the site; null: none are found
  };
  explicit AdminSite(Sources sources) : sources_(std::move(sources)) {}

  HttpResponse answer(const HttpRequest& request) const;

 private:
  HttpResponse answer_ready() const;
  HttpResponse answer_changes(const Target& target) const;

  const Sources sources_;
};

}  // namespace trapeze
