#include "server/http/rate_limit.h"

#include <algorithm>

namespace trapeze {
namespace {

constexpr auto kClearingPause = std::chrono::seconds(1);

}  // namespace

std::optional<std::chrono::duration<double>> RateLimit::take(const ClientAddress& address,
                                                             Clock::time_point now, double tokens) {
  if (per_second_ <= 0) return std::nullopt;
  const std::lock_guard lock(mutex_);
  Bucket& bucket = bucket_of(address, now);
  bucket = {tokens_at(bucket, now), now};
  if (bucket.tokens < 1) {
    return std::chrono::duration<double>((1 - bucket.tokens) / per_second_);
  }
  bucket.tokens -= tokens;
  return std::nullopt;
}

std::size_t RateLimit::addresses() const {
  const std::lock_guard lock(mutex_);
  return buckets_.size();
}

double RateLimit::tokens_at(const Bucket& bucket, Clock::time_point now) const {
  const double seconds = std::chrono::duration<double>(now - bucket.filled).count();
  return std::min(burst_, bucket.tokens + std::max(seconds, 0.0) * per_second_);
}

RateLimit::Bucket& RateLimit::bucket_of(const ClientAddress& address, Clock::time_point now) {
  const auto found = buckets_.find(address);
  if (found != buckets_.end()) return found->second;
  if (buckets_.size() >= kMostAddresses && now >= next_clearing_) forget_rested(now);
  if (buckets_.size() < kMostAddresses) {
    return buckets_.emplace(address, Bucket{burst_, now}).first->second;
  }
  if (!shared_bucket_) shared_bucket_ = Bucket{burst_, now};
  return *shared_bucket_;
}

void RateLimit::forget_rested(Clock::time_point now) {
  std::erase_if(buckets_,
                [this, now](const auto& entry) { return tokens_at(entry.second, now) >= burst_; });
  next_clearing_ = now + kClearingPause;
}

}  // namespace trapeze
