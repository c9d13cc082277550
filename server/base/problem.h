// What is wrong with a request, as a value; converted into a status code and a JSON body in one
// place.
#pragma once

#include <string>
#include <utility>

namespace trapeze {

/// Serialised as an application/problem+json body (RFC 7807).
struct Problem {
  Problem(int problem_status, std::string problem_detail)
      : status(problem_status), detail(std::move(problem_detail)) {}
  /// With the parameter at fault.
  Problem(int problem_status, std::string problem_detail, std::string problem_parameter,
          std::string problem_value, std::string problem_takes)
      : status(problem_status),
        detail(std::move(problem_detail)),
        parameter(std::move(problem_parameter)),
        value(std::move(problem_value)),
        takes(std::move(problem_takes)) {}

  int status;
  std::string detail;     // a sentence for the sender of the request
  std::string parameter;  // the query parameter at fault, or empty
  std::string value;      // its value, as received
  std::string takes;      // valid values
  std::string code = {};  // the code of OGC services, or empty
};

/// Bytes of a request for use in messages: cut to 64.
std::string echoed(const std::string& text);

/// The JSON text. Bytes of the request are escaped and cut to 64 bytes, with invalid UTF-8
/// replaced.
std::string problem_json(const Problem& problem);

}  // namespace trapeze
