// How often each address may do something: a bucket of tokens for each, which fills steadily.
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

  /// `per_second` on the average, and `burst` (at least 1) at once after a rest. 0 a second: there
  /// is no limit.
  RateLimit(double per_second, double burst) : per_second_(per_second), burst_(burst) {}

  /// Takes tokens of the address and returns nothing; or, if it has not one left, the time after
  /// which it will have one. Who has one may take more than there are: they are missing afterwards.
  std::optional<std::chrono::duration<double>> take(const ClientAddress& address,
                                                    Clock::time_point now, double tokens = 1);

  /// Addresses that are remembered: never more than kMostAddresses. Those that come when there are
  /// so many share one bucket.
  static constexpr std::size_t kMostAddresses = 65'536;
  std::size_t addresses() const;

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled;  // when the tokens were counted
  };

  double tokens_at(const Bucket& bucket, Clock::time_point now) const;
  Bucket& bucket_of(const ClientAddress& address, Clock::time_point now);
  /// Forgets those whose bucket is full: they are as if they had never come.
  void forget_rested(Clock::time_point now);

  const double per_second_;
  const double burst_;
  mutable std::mutex mutex_;  // guards all below
  std::unordered_map<ClientAddress, Bucket, ClientAddressHash> buckets_;
  std::optional<Bucket> shared_bucket_;
  Clock::time_point next_clearing_;
};

}  // namespace trapeze
