// GDAL's messages of this thread, caught instead of printed.
#pragma once

#include <string>

#include <cpl_error.h>

namespace trapeze {

/// While it lives, GDAL's errors and warnings of the thread that made it are collected here and go
/// nowhere else. Must be destroyed on the same thread; the latest one made catches.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  /// Forgets all messages so far.
  void clear() { state_ = {}; }
  bool has_failure() const { return state_.failed; }
  /// The first error; if there is none, the first warning; empty if there was neither. In one line.
  const std::string& text() const {
    return state_.failed ? state_.first_failure : state_.first_warning;
  }

 private:
  struct State {
    bool failed = false;
    std::string first_failure;
    std::string first_warning;
  };

  static void CPL_STDCALL keep(CPLErr severity, CPLErrorNum number, const char* message);

  State state_;
};

}  // namespace trapeze
