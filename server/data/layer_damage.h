// What has become of the files of a layer that is served from prepared ones.
#pragma once

#include <string>

#include "server/data/dataset.h"

namespace trapeze {

/// Which of its files has been damaged, and how, in words for operators; empty if none has, as far
/// as is known: of a layer in parts, those that were opened. Looks at the state of each file that
/// is mapped, and reads none. Thread-safety: any thread.
std::string damage_of(const ServedLayer& layer);

}  // namespace trapeze
