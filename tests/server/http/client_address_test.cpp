#include "server/http/client_address.h"

#include <gmock/gmock.h>

#include <vector>

namespace trapeze {
namespace {

ClientAddress address(const char* text) {
  return parse_address(text).value();
}

std::vector<AddressRange> ranges(const std::vector<const char*>& texts) {
  std::vector<AddressRange> ranges;
  for (const char* text : texts) ranges.push_back(parse_address_range(text).value());
  return ranges;
}

TEST(ClientAddressTest, ReadsAndWritesBothKinds) {
  for (const char* text : {"192.0.2.7", "0.0.0.0", "255.255.255.255", "::1", "2001:db8::1"}) {
    EXPECT_EQ(address_text(address(text)), text);
  }
  EXPECT_EQ(address("::ffff:192.0.2.7"), address("192.0.2.7"));
  for (const char* text : {"", "localhost", "1.2.3", "1.2.3.4.5", "256.0.0.1", "1.2.3.4 ", "[::1]",
                           "1.2.3.4:80", "::1%lo", ":::"}) {
    EXPECT_EQ(parse_address(text), std::nullopt) << text;
  }
  EXPECT_EQ(parse_address(std::string_view("1.2.3.4\0x", 9)), std::nullopt);
}

TEST(ClientAddressTest, ARangeHoldsWhatBeginsWithItsBits) {
  const auto net = parse_address_range("10.1.128.0/17").value();
  EXPECT_TRUE(net.contains(address("10.1.128.0")));
  EXPECT_TRUE(net.contains(address("10.1.255.255")));
  EXPECT_FALSE(net.contains(address("10.1.127.255")));
  EXPECT_FALSE(net.contains(address("10.2.128.0")));
  EXPECT_TRUE(parse_address_range("0.0.0.0/0").value().contains(address("203.0.113.9")));
  EXPECT_FALSE(parse_address_range("0.0.0.0/0").value().contains(address("2001:db8::1")));
  EXPECT_TRUE(parse_address_range("::/0").value().contains(address("203.0.113.9")));
  EXPECT_TRUE(parse_address_range("2001:db8::/32").value().contains(address("2001:db8:1::5")));
  EXPECT_FALSE(parse_address_range("2001:db8::/32").value().contains(address("2001:db9::")));
  EXPECT_TRUE(parse_address_range("::1").value().contains(address("::1")));
  for (const char* text : {"10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1", "10.0.0.0/8x", "::/129", "/8",
                           "a/8", "10.0.0.0/8/8"}) {
    EXPECT_FALSE(parse_address_range(text)) << text;
  }
}

TEST(ClientAddressTest, OnlyTrustedProxiesAreBelieved) {
  const auto trusted = ranges({"127.0.0.1", "10.0.0.0/8"});
  const auto behind = [&trusted](const char* peer, const char* forwarded_for) {
    return address_text(client_behind(address(peer), forwarded_for, trusted));
  };
  EXPECT_EQ(behind("127.0.0.1", "203.0.113.9"), "203.0.113.9");
  EXPECT_EQ(behind("127.0.0.1", ""), "127.0.0.1");
  EXPECT_EQ(behind("198.51.100.1", "203.0.113.9"), "198.51.100.1") << "a client lies";
  EXPECT_EQ(behind("127.0.0.1", "192.0.2.1, 203.0.113.9"), "203.0.113.9")
      << "a client lies to the proxy, which appends the truth";
  EXPECT_EQ(behind("127.0.0.1", "203.0.113.9 , 10.0.0.7,\t10.0.0.8"), "203.0.113.9");
  EXPECT_EQ(behind("127.0.0.1", "10.0.0.7"), "10.0.0.7") << "all of them proxies";
  EXPECT_EQ(behind("127.0.0.1", "203.0.113.9, unknown"), "127.0.0.1");
  EXPECT_EQ(behind("127.0.0.1", ",,,"), "127.0.0.1");
}

TEST(ClientAddressTest, ProxiesMayAppendPorts) {
  const auto trusted = ranges({"127.0.0.1", "10.0.0.0/8", "2001:db8:1::/48"});
  const auto behind = [&trusted](const char* forwarded_for) {
    return address_text(client_behind(address("127.0.0.1"), forwarded_for, trusted));
  };
  EXPECT_EQ(behind("203.0.113.9:4711"), "203.0.113.9");
  EXPECT_EQ(behind("203.0.113.9:4711, 10.0.0.7:80"), "203.0.113.9");
  EXPECT_EQ(behind("[2001:db8:2::5]:4711, [2001:db8:1::1]"), "2001:db8:2::5");
  EXPECT_EQ(behind("2001:db8:2::5"), "2001:db8:2::5");
  EXPECT_EQ(behind("::ffff:203.0.113.9"), "203.0.113.9");
  for (const char* text :
       {"203.0.113.9:", "203.0.113.9:x", "203.0.113.9:65536", "203.0.113.9:-1", "203.0.113.9:80:80",
        "[203.0.113.9", "[2001:db8:2::5]4711", "[]", ":80"}) {
    EXPECT_EQ(behind(text), "127.0.0.1") << text;
  }
}

TEST(ClientAddressTest, LimitsHoldForAWholeIpv6Network) {
  EXPECT_EQ(limited_address(address("2001:db8:1:2:3::4")),
            limited_address(address("2001:db8:1:2:ffff::")));
  EXPECT_NE(limited_address(address("2001:db8:1:2::")), limited_address(address("2001:db8:1:3::")));
  EXPECT_NE(limited_address(address("192.0.2.7")), limited_address(address("192.0.2.8")));
}

}  // namespace
}  // namespace trapeze
