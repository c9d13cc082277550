// A rate limit for each address: a token bucket that fills steadily.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "server/http/client_address.h"

namespace trapeze {

class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  /// Allows `per_second` tokens on average, and `burst` (at least 1) at the same time after a
  /// pause. If `per_second` is 0, there is no limit.
  RateLimit(double per_second, double burst) : per_second_(per_second), burst_(burst) {}

  /// Takes tokens of the address and returns nothing; if less than one is left, returns the time
  /// until there is one. An address with at least one token may take more than it has; the debt has
  /// to be refilled first.
  std::optional<std::chrono::duration<double>> take(const ClientAddress& address,
                                                    Clock::time_point now, double tokens = 1);

  /// How many addresses are remembered: never more than kMostAddresses. Further addresses share one
  /// bucket.
  static constexpr std::size_t kMostAddresses = 65'536;
  std::size_t addresses() const;

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled;  // time for which `tokens` holds
  };

  double tokens_at(const Bucket& bucket, Clock::time_point now) const;
  Bucket& bucket_of(const ClientAddress& address, Clock::time_point now);
  /// Forgets addresses whose bucket is full: they are like new ones.
  void forget_rested(Clock::time_point now);

  const double per_second_;
  const double burst_;
  mutable std::mutex mutex_;  // guards everything below
  std::unordered_map<ClientAddress, Bucket, ClientAddressHash> buckets_;
  std::optional<Bucket> shared_bucket_;
  Clock::time_point next_clearing_;
};

}  // namespace trapeze
