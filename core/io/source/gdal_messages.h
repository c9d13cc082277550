// Collects the GDAL messages of the current thread instead of printing them.
#pragma once

#include <string>

#include <cpl_error.h>

namespace trapeze {

/// While an object exists, errors and warnings of GDAL on its thread are collected in it and go
/// nowhere else. Must be destroyed on the same thread. With several objects, the latest one
/// collects.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  /// Discards all messages so far.
  void clear() { state_ = {}; }
  bool has_failure() const { return state_.failed; }
  /// The first error or, if there is none, the first warning; empty if there is neither. In one
  /// line.
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
