// Answers requests on the admin address, which is meant for operators.
#pragma once

#include <functional>
#include <string>

#include "server/base/url.h"
#include "server/changes/change_log.h"
#include "server/http/http_message.h"
#include "server/service/metrics.h"

namespace trapeze {

/// The detailed state of the server as JSON, as /ready returns it on the admin address. `problem`
/// is what went wrong when the layers were last read; empty if nothing did.
std::string state_json(const ServerFigures& figures, const std::string& problem);

/// Answers /metrics, /ready (503 with the same details while the server is not ready), /health and
/// /changes?since=GENERATION (503 while the changes are being computed, 404 for a generation that
/// is not among the last few). Answers all other paths with 404. As thread-safe as `figures`,
/// `problem` and `metrics`.
class AdminSite {
 public:
  struct Sources {
    std::function<ServerFigures()> figures;
    std::function<std::string()> problem;
    std::function<std::string()> metrics;
    const ChangeLog* changes = nullptr;  // must outlive the site; null: no changes are computed
  };
  explicit AdminSite(Sources sources) : sources_(std::move(sources)) {}

  HttpResponse answer(const HttpRequest& request) const;

 private:
  HttpResponse answer_ready() const;
  HttpResponse answer_changes(const Target& target) const;

  const Sources sources_;
};

}  // namespace trapeze
