// Problems with requests in the format of OGC Web Services Common 1.1.
#pragma once

#include <string>
#include <string_view>

#include "server/base/problem.h"

namespace trapeze {

/// The codes used in answers, including those of single services.
namespace ows {
constexpr const char* kMissingParameterValue = "MissingParameterValue";
constexpr const char* kInvalidParameterValue = "InvalidParameterValue";
constexpr const char* kOperationNotSupported = "OperationNotSupported";
constexpr const char* kVersionNegotiationFailed = "VersionNegotiationFailed";
constexpr const char* kTileOutOfRange = "TileOutOfRange";
constexpr const char* kPointIJOutOfRange = "PointIJOutOfRange";
constexpr const char* kInvalidFormat = "InvalidFormat";
constexpr const char* kInvalidCrs = "InvalidCRS";
constexpr const char* kInvalidSrs = "InvalidSRS";
constexpr const char* kInvalidPoint = "InvalidPoint";
constexpr const char* kLayerNotDefined = "LayerNotDefined";
constexpr const char* kStyleNotDefined = "StyleNotDefined";
constexpr const char* kNoApplicableCode = "NoApplicableCode";
}  // namespace ows

/// The code of the problem; if it has none, InvalidParameterValue if it names a parameter, else
/// NoApplicableCode.
std::string_view code_of(const Problem& problem);

/// An ows:ExceptionReport with one exception. Its locator is the parameter. Bytes of the request
/// are escaped and cut as in problem_json().
std::string exception_report(const Problem& problem);

}  // namespace trapeze
