// What is wrong with a request to WMS, in the form that it asks for.
#pragma once

#include <span>

#include "render/text/fonts.h"
#include "server/base/problem.h"
#include "server/base/url.h"
#include "server/documents/document.h"

namespace trapeze {

/// A ServiceExceptionReport of the version that the query names; or, with EXCEPTIONS=INIMAGE, a
/// picture of the size that it names with the words in it; with BLANK, one without. Where the query
/// does not say how large that is, or says more than `most_pixels`, the report. Bytes of the
/// request are escaped and cut as problem_json() does.
Document wms_exception(const Problem& problem, std::span<const QueryPair> query, const Fonts& fonts,
                       std::uint64_t most_pixels);

}  // namespace trapeze
