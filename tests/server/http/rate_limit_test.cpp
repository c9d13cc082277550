#include "server/http/rate_limit.h"

#include <gmock/gmock.h>

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using Clock = RateLimit::Clock;

const Clock::time_point kStart = Clock::time_point(1h);

ClientAddress client(std::uint32_t number) {
  ClientAddress address;
  for (int i = 0; i < 4; ++i) address.bytes[i] = static_cast<std::uint8_t>(number >> (8 * i));
  return address;
}

int taken_at_once(RateLimit& limit, const ClientAddress& address, Clock::time_point now) {
  int taken = 0;
  while (taken < 1000 && !limit.take(address, now)) ++taken;
  return taken;
}

TEST(RateLimitTest, GivesABurstAndThenSoManyASecond) {
  RateLimit limit(10, 25);
  EXPECT_EQ(taken_at_once(limit, client(1), kStart), 25);
  EXPECT_EQ(taken_at_once(limit, client(1), kStart + 2s), 20);
  EXPECT_EQ(taken_at_once(limit, client(1), kStart + 1h), 25) << "rest is not saved without end";
}

TEST(RateLimitTest, WhoTakesMoreThanThereIsWaitsForIt) {
  RateLimit limit(10, 20);
  EXPECT_EQ(limit.take(client(1), kStart, 50), std::nullopt);
  const auto pause = limit.take(client(1), kStart);
  ASSERT_TRUE(pause);
  EXPECT_DOUBLE_EQ(pause->count(), 3.1);
  EXPECT_EQ(limit.take(client(1), kStart + 3200ms), std::nullopt);
}

TEST(RateLimitTest, SaysWhenToComeAgain) {
  RateLimit limit(2, 1);
  EXPECT_EQ(limit.take(client(1), kStart), std::nullopt);
  const auto pause = limit.take(client(1), kStart);
  ASSERT_TRUE(pause);
  EXPECT_DOUBLE_EQ(pause->count(), 0.5);
  EXPECT_TRUE(limit.take(client(1), kStart + 499ms));
  EXPECT_FALSE(limit.take(client(1), kStart + 501ms));
}

TEST(RateLimitTest, EveryAddressHasItsOwn) {
  RateLimit limit(1, 3);
  EXPECT_EQ(taken_at_once(limit, client(1), kStart), 3);
  EXPECT_EQ(taken_at_once(limit, client(2), kStart), 3);
}

TEST(RateLimitTest, NoRateIsNoLimit) {
  RateLimit limit(0, 1);
  EXPECT_EQ(taken_at_once(limit, client(1), kStart), 1000);
  EXPECT_EQ(limit.addresses(), 0u);
}

TEST(RateLimitTest, AClockThatStandsOrJumpsBackTakesNothingAway) {
  RateLimit limit(1, 2);
  EXPECT_FALSE(limit.take(client(1), kStart));
  EXPECT_FALSE(limit.take(client(1), kStart - 10s));
  EXPECT_TRUE(limit.take(client(1), kStart - 10s));
}

TEST(RateLimitTest, MemoryIsBoundedHoweverManyAddressesCome) {
  RateLimit limit(1, 2);
  for (std::uint32_t i = 0; i < RateLimit::kMostAddresses + 1000; ++i) {
    limit.take(client(i), kStart);
  }
  EXPECT_EQ(limit.addresses(), RateLimit::kMostAddresses);
  EXPECT_EQ(taken_at_once(limit, client(0xffffffff), kStart), 0) << "newcomers share what is left";
  EXPECT_EQ(taken_at_once(limit, client(0xffffffff), kStart + 5s), 2) << "the rested are forgotten";
  EXPECT_EQ(limit.addresses(), 1u);
}

}  // namespace
}  // namespace trapeze
