// Finds a context that works on this machine.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "render/gl/context_request.h"
#include "render/gl/gl_context.h"

namespace trapeze {

/// What there is to try, best first: hardware devices, software devices, surfaceless, OSMesa.
std::vector<ContextCandidate> list_context_candidates();

/// Opens that one; it is current nowhere afterwards. Throws std::runtime_error with the reason.
std::unique_ptr<GlContext> open_context(const ContextCandidate& candidate);

struct ContextSearch {
  bool found = false;
  std::vector<ContextFailure> failures;
};

/// Opens one candidate after another and hands each that opens to `use`, until one is taken without
/// an exception. Never throws because of a candidate or its use: the reason is kept.
ContextSearch use_first_context(const ContextRequest& request,
                                const std::function<void(std::unique_ptr<GlContext>)>& use);

}  // namespace trapeze
