// The name of a source for messages and documents.
#pragma once

#include <string>

namespace trapeze {

/// The path of a source without the password that a connection string or a URL may contain, and
/// without tokens, keys and signatures in the query of a URL.
/// Thread-safety: may be called from any thread.
std::string name_of_source(const std::string& path);

}  // namespace trapeze
