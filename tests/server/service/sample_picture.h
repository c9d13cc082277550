// Decodes pictures that a SampleSite answers with.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "render/picture/picture.h"
#include "render/picture/png.h"
#include "tests/server/service/sample_site.h"

namespace trapeze::testing {

/// The picture at that target; a missing one fails the test and gives an empty picture.
inline Picture picture_of(SampleSite& site, const std::string& target) {
  const HttpResponse response = site.get(target);
  EXPECT_EQ(response.status, 200) << target << " " << (response.body ? *response.body : "");
  return response.status == 200 ? decode_png(*response.body) : Picture();
}

}  // namespace trapeze::testing
