#include "core/io/source/gdal_messages.h"

#include <cctype>
#include <string_view>

namespace trapeze {
namespace {

/// GDAL's parser prints the condition below its message, and a '^' below the part that it did not
/// understand.
std::string in_one_line(std::string_view message) {
  std::string line;
  for (const char c : message) {
    const bool is_space = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (is_space && (line.empty() || line.back() == ' ')) continue;
    line += is_space ? ' ' : c;
  }
  for (const char* end : {" ", "^", " "}) {
    if (line.ends_with(end)) line.pop_back();
  }
  return line;
}

}  // namespace

GdalMessages::GdalMessages() {
  CPLPushErrorHandlerEx(&GdalMessages::keep, this);
  // Debug output is enabled through CPL_DEBUG and is left to GDAL.
  CPLSetCurrentErrorHandlerCatchDebug(FALSE);
}

GdalMessages::~GdalMessages() {
  CPLPopErrorHandler();
}

void CPL_STDCALL GdalMessages::keep(CPLErr severity, CPLErrorNum, const char* message) {
  State& state = static_cast<GdalMessages*>(CPLGetErrorHandlerUserData())->state_;
  if (severity == CE_Failure || severity == CE_Fatal) {
    if (!state.failed) state.first_failure = in_one_line(message);
    state.failed = true;
  } else if (severity == CE_Warning && state.first_warning.empty()) {
    state.first_warning = in_one_line(message);
  }
}

}  // namespace trapeze
