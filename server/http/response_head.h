// The head of an HTTP/1 response as text: status line and header fields.
#pragma once

#include <string>

#include "server/http/http_message.h"

namespace trapeze {

/// Appends the head of the response, including the empty line after it, for a client with that
/// version of HTTP (11 or 10). Adds Content-Length if there is a body, even one that is not sent
/// because of HEAD, and the current date. From any thread.
void append_response_head(const HttpResponse& response, unsigned version, bool keep_alive,
                          std::string& text);

}  // namespace trapeze
