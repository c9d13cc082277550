#include "server/base/url.h"

#include <gmock/gmock.h>

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::Optional;
using ::testing::Pair;

TEST(UrlTest, DecodesPercentSequencesOfEitherCase) {
  EXPECT_THAT(percent_decode("a%2Cb%2cc", Plus::literal), Optional(std::string("a,b,c")));
}

TEST(UrlTest, ReadsPlusAsSpaceInQueriesOnly) {
  EXPECT_THAT(percent_decode("a+b", Plus::space), Optional(std::string("a b")));
  EXPECT_THAT(percent_decode("a+b", Plus::literal), Optional(std::string("a+b")));
}

TEST(UrlTest, RefusesMalformedPercentSequences) {
  for (const char* text : {"%", "%4", "a%", "%zz", "%4g", "%-1", "% 1"}) {
    EXPECT_EQ(percent_decode(text, Plus::literal), std::nullopt) << text;
  }
}

TEST(UrlTest, RefusesControlCharactersHoweverWritten) {
  for (const std::string& text : {std::string("%00"), std::string("a%0Ab"), std::string("%7f"),
                                  std::string("a\0b", 3), std::string("\x1b[0m")}) {
    EXPECT_EQ(percent_decode(text, Plus::literal), std::nullopt) << text;
  }
}

TEST(UrlTest, EncodingIsUndoneByDecoding) {
  std::string every_printable_byte;
  for (int c = 0x20; c < 0x100; ++c) {
    if (c != 0x7f) every_printable_byte.push_back(static_cast<char>(c));
  }
  EXPECT_THAT(percent_decode(percent_encode(every_printable_byte), Plus::space),
              Optional(every_printable_byte));
}

TEST(UrlTest, SplitsTargetsInBothForms) {
  const auto origin = split_target("/tiles/a.json?fill=red?x");
  ASSERT_TRUE(origin);
  EXPECT_EQ(origin->path, "/tiles/a.json");
  EXPECT_EQ(origin->query, "fill=red?x");
  const auto absolute = split_target("http://host:80/catalog");
  ASSERT_TRUE(absolute);
  EXPECT_EQ(absolute->path, "/catalog");
  EXPECT_EQ(absolute->query, "");
  EXPECT_EQ(absolute->host, "host:80");
  EXPECT_EQ(origin->host, "");
  const auto without_path = split_target("HTTP://host?a=/");
  ASSERT_TRUE(without_path);
  EXPECT_EQ(without_path->path, "/");
  EXPECT_EQ(without_path->query, "a=/");
  EXPECT_EQ(without_path->host, "host");
  EXPECT_EQ(split_target("http://host").value().path, "/");
}

TEST(UrlTest, RefusesTargetsWithoutAPath) {
  for (const char* target : {"", "*", "tiles/a.json", "http://", "http://?a", "ftp://host/x"}) {
    EXPECT_FALSE(split_target(target)) << target;
  }
}

TEST(UrlTest, SplitsPathsBeforeDecodingThem) {
  EXPECT_THAT(decode_path("/a%2Fb/c"), Optional(ElementsAre("a/b", "c")));
  EXPECT_THAT(decode_path("/"), Optional(ElementsAre("")));
  EXPECT_EQ(decode_path("/a/%"), std::nullopt);
}

TEST(UrlTest, SplitsQueriesBeforeDecodingThem) {
  EXPECT_THAT(decode_query("a=1%262&b&&c==+"),
              Optional(ElementsAre(Pair("a", "1&2"), Pair("b", ""), Pair("c", "= "))));
  EXPECT_THAT(decode_query(""), Optional(ElementsAre()));
  EXPECT_EQ(decode_query("a=%"), std::nullopt);
}

TEST(UrlTest, KnowsWhatCanBeAHost) {
  for (const char* host : {"localhost", "localhost:8080", "maps.example", "10.0.0.1:1", "[::1]",
                           "[2001:db8::1]:65535", "my_service"}) {
    EXPECT_TRUE(is_valid_host(host)) << host;
  }
}

TEST(UrlTest, RefusesHostsThatWouldBreakOutOfAUrl) {
  for (const char* host : {"", "a/b", "a b", "user@host", "a:", "a:b", "a:123456", ":80", "[::1",
                           "[]", "[x]", "[::1]x", "a\"b", "a?b", "a#b", "<script>"}) {
    EXPECT_FALSE(is_valid_host(host)) << host;
  }
  EXPECT_FALSE(is_valid_host(std::string(300, 'a')));
}

TEST(UrlTest, AllowsTheHostsThatAreNamed) {
  const std::vector<std::string> allowed = {"maps.example.org", "*.tiles.example.org",
                                            "localhost:8080", "[::1]"};
  for (const char* host :
       {"maps.example.org", "MAPS.example.ORG", "maps.example.org:8443", "a.tiles.example.org",
        "a.b.tiles.example.org:80", "localhost:8080", "[::1]", "[::1]:8080"}) {
    EXPECT_TRUE(is_allowed_host(host, allowed)) << host;
  }
  for (const char* host :
       {"example.org", "xmaps.example.org", "maps.example.org.evil.net", "tiles.example.org",
        ".tiles.example.org", "atiles.example.org", "localhost", "localhost:80", "[::2]"}) {
    EXPECT_FALSE(is_allowed_host(host, allowed)) << host;
  }
}

}  // namespace
}  // namespace trapeze
