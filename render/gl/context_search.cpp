#include "render/gl/context_search.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <utility>

#include "render/gl/egl_context.h"
#include "render/gl/osmesa_context.h"

namespace trapeze {
namespace {

std::string to_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

bool contains_in_any_case(std::string_view text, std::string_view part) {
  return to_lower(text).find(to_lower(part)) != std::string::npos;
}

std::optional<int> as_index(std::string_view text) {
  int index = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size() || index < 0) return std::nullopt;
  return index;
}

// Tries candidates one after the other and records the reason of each failure.
class Search {
 public:
  explicit Search(const std::function<void(std::unique_ptr<GlContext>)>& use) : use_(use) {}

  // Uses the candidate if it opens, `refusal` returns no reason against it, and `use` accepts it.
  template <typename Refusal>
  void attempt(const ContextCandidate& candidate, Refusal refusal) {
    try {
      std::unique_ptr<GlContext> context = open_context(candidate);
      const std::string reason = refusal(context->info());
      if (!reason.empty()) throw std::runtime_error(reason);
      use_(std::move(context));
      result_.found = true;
    } catch (const std::exception& error) {
      fail(candidate.text(), error.what());
    }
  }

  void fail(std::string candidate, std::string reason) {
    result_.failures.push_back({std::move(candidate), std::move(reason)});
  }

  bool found() const { return result_.found; }
  const ContextSearch& result() const { return result_; }

 private:
  const std::function<void(std::unique_ptr<GlContext>)>& use_;
  ContextSearch result_;
};

void try_preferred(const std::vector<ContextCandidate>& candidates, const std::string& device,
                   Search& search) {
  const std::optional<int> index = as_index(device);
  bool is_listed = false;
  for (const ContextCandidate& candidate : candidates) {
    if (search.found()) return;
    if (index && candidate.device_index != *index) continue;
    is_listed = true;
    search.attempt(candidate, [&](const ContextInfo& info) -> std::string {
      if (index || contains_in_any_case(candidate.device_name, device) ||
          contains_in_any_case(info.renderer, device)) {
        return {};
      }
      return "\"" + info.renderer + "\" is not the device \"" + device + "\"";
    });
  }
  if (!is_listed) search.fail("device \"" + device + "\"", "there is no such device");
}

}  // namespace

std::vector<ContextCandidate> list_context_candidates() {
  std::vector<ContextCandidate> candidates = list_egl_candidates();
  if (has_osmesa()) candidates.push_back({ContextPath::osmesa, -1, {}});
  return candidates;
}

std::unique_ptr<GlContext> open_context(const ContextCandidate& candidate) {
  return candidate.path == ContextPath::osmesa ? open_osmesa_context(candidate)
                                               : open_egl_context(candidate);
}

ContextSearch use_first_context(const ContextRequest& request,
                                const std::function<void(std::unique_ptr<GlContext>)>& use) {
  std::vector<ContextCandidate> candidates = list_context_candidates();
  std::erase_if(candidates, [&](const ContextCandidate& candidate) {
    return candidate.path == ContextPath::osmesa ? !request.osmesa : !request.egl;
  });
  Search search(use);
  if (candidates.empty()) {
    if (request.egl) search.fail("EGL", "this program was built without EGL");
    if (request.osmesa) search.fail("OSMesa", "this program was built without OSMesa");
  }
  if (!request.device.empty()) try_preferred(candidates, request.device, search);
  for (const ContextCandidate& candidate : candidates) {
    if (search.found()) break;
    search.attempt(candidate, [](const ContextInfo&) { return std::string(); });
  }
  return search.result();
}

}  // namespace trapeze
