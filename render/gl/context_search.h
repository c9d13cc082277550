// Finds a context that works on this machine.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "render/gl/context_request.h"
#include "render/gl/gl_context.h"

namespace trapeze {

/// The contexts to try, best first: hardware devices, software devices, surfaceless, OSMesa.
std::vector<ContextCandidate> list_context_candidates();

/// Opens a candidate; its context is not current on any thread afterwards. Throws
/// std::runtime_error with the reason.
std::unique_ptr<GlContext> open_context(const ContextCandidate& candidate);

struct ContextSearch {
  bool found = false;
  std::vector<ContextFailure> failures;
};

/// Opens candidates one after the other and passes each that opens to `use`, until a call of `use`
/// returns without an exception. Failures of a candidate or of its use are not thrown, but listed.
ContextSearch use_first_context(const ContextRequest& request,
                                const std::function<void(std::unique_ptr<GlContext>)>& use);

}  // namespace trapeze
