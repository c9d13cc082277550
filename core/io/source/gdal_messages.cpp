#include "core/io/source/gdal_messages.h"

namespace trapeze {

GdalMessages::GdalMessages() {
  CPLPushErrorHandlerEx(&GdalMessages::keep, this);
  // Debug output is asked for through CPL_DEBUG and stays GDAL's own affair.
  CPLSetCurrentErrorHandlerCatchDebug(FALSE);
}

GdalMessages::~GdalMessages() {
  CPLPopErrorHandler();
}

void CPL_STDCALL GdalMessages::keep(CPLErr severity, CPLErrorNum, const char* message) {
  State& state = static_cast<GdalMessages*>(CPLGetErrorHandlerUserData())->state_;
  if (severity == CE_Failure || severity == CE_Fatal) {
    if (!state.failed) state.first_failure = message;
    state.failed = true;
  } else if (severity == CE_Warning && state.first_warning.empty()) {
    state.first_warning = message;
  }
}

}  // namespace trapeze
