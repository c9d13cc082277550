#include "server/documents/ows_exception.h"

#include <spdlog/fmt/fmt.h>

#include <string_view>

#include "server/base/xml_text.h"

namespace trapeze {
namespace {

constexpr std::string_view kReport =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<ows:ExceptionReport xmlns:ows="http://www.opengis.net/ows/1.1"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:schemaLocation="http://www.opengis.net/ows/1.1 http://schemas.opengis.net/ows/1.1.0/owsExceptionReport.xsd"
 version="1.0.0" xml:lang="en">
  <ows:Exception exceptionCode="{}"{}>
    <ows:ExceptionText>{}</ows:ExceptionText>
  </ows:Exception>
</ows:ExceptionReport>
)";

}  // namespace

std::string_view code_of(const Problem& problem) {
  if (!problem.code.empty()) return problem.code;
  const bool is_about_a_parameter = problem.status < 500 && !problem.parameter.empty();
  return is_about_a_parameter ? ows::kInvalidParameterValue : ows::kNoApplicableCode;
}

std::string exception_report(const Problem& problem) {
  const std::string_view code = code_of(problem);
  std::string locator;
  if (code != ows::kNoApplicableCode && !problem.parameter.empty()) {
    locator = fmt::format(" locator=\"{}\"", xml_escape(echoed(problem.parameter)));
  }
  return fmt::format(kReport, code, locator, xml_escape(problem.detail));
}

}  // namespace trapeze
