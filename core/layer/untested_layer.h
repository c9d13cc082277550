// A layer generalized without the topological consistency test (paper, section 4.2), beside the one
// that was generalized with it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "core/layer/layer.h"

namespace trapeze {

/// Thread-safety: any number of threads may use it at once.
class UntestedLayer {
 public:
  /// `layer` must outlive this.
  explicit UntestedLayer(const Layer& layer) : layer_(layer) {}

  /// The same polygons without the test; the layer itself if it was built so. Built on the
  /// first call, which takes about as long and as much memory as loading the layer did; concurrent
  /// callers wait.
  const Layer& get() const;

  /// The mesh of get(), if that was built and is not the layer itself.
  std::optional<std::uint64_t> mesh_id() const;
  /// Bytes held beside the layer.
  std::size_t memory() const;

 private:
  const Layer& layer_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const Layer> built_;
  mutable std::atomic<bool> is_built_ = false;  // set afterwards, for those who do not wait
};

}  // namespace trapeze
