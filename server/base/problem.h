// What is wrong with a request, as a value; turned into a status code and a JSON body in one place.
#pragma once

#include <string>
#include <utility>

namespace trapeze {

/// Becomes an application/problem+json body (RFC 7807).
struct Problem {
  Problem(int problem_status, std::string problem_detail)
      : status(problem_status), detail(std::move(problem_detail)) {}
  /// With what is wrong about which parameter.
  Problem(int problem_status, std::string problem_detail, std::string problem_parameter,
          std::string problem_value, std::string problem_takes)
      : status(problem_status),
        detail(std::move(problem_detail)),
        parameter(std::move(problem_parameter)),
        value(std::move(problem_value)),
        takes(std::move(problem_takes)) {}

  int status;
  std::string detail;     // a sentence for the one who sent the request
  std::string parameter;  // the query parameter at fault, or empty
  std::string value;      // what it was set to, as received
  std::string takes;      // what it takes
  std::string code = {};  // what services of the OGC call it, or empty
};

/// Bytes of a request as they are echoed: cut to 64.
std::string echoed(const std::string& text);

/// The JSON text. Bytes of the request are echoed escaped, cut to 64 bytes, and with invalid UTF-8
/// replaced.
std::string problem_json(const Problem& problem);

}  // namespace trapeze
