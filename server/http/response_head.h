// The head of an HTTP/1 response as text: status line and fields.
#pragma once

#include <string>

#include "server/http/http_message.h"

namespace trapeze {

/// Appends the head of the response, the empty line after it included, for a client that speaks
/// that version of HTTP (11 or 10). With Content-Length if there is a body, also where HEAD leaves
/// that out; with the date of now. From any thread.
void append_response_head(const HttpResponse& response, unsigned version, bool keep_alive,
                          std::string& text);

}  // namespace trapeze
