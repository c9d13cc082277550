// Problems with WMS requests, in the requested format.
#pragma once

#include <span>

#include "render/text/fonts.h"
#include "server/base/problem.h"
#include "server/base/url.h"
#include "server/documents/document.h"

namespace trapeze {

/// A ServiceExceptionReport of the version in the query; with EXCEPTIONS=INIMAGE, a picture of the
/// requested size that contains the message; with BLANK, an empty one. If the query does not state
/// the size, or more than `most_pixels`, the report. Bytes of the request are escaped and cut as in
/// problem_json().
Document wms_exception(const Problem& problem, std::span<const QueryPair> query, const Fonts& fonts,
                       std::uint64_t most_pixels);

}  // namespace trapeze
