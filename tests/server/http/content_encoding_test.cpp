#include "server/http/content_encoding.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <array>

namespace trapeze {
namespace {

constexpr auto kIdentity = ContentEncoding::identity;
constexpr auto kGzip = ContentEncoding::gzip;
constexpr auto kBrotli = ContentEncoding::brotli;
constexpr std::array kBoth = {kBrotli, kGzip};

std::string unpacked(const std::string& gzip) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  std::string text(1 << 20, '\0');
  std::string packed = gzip;
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  text.resize(stream.total_out);
  inflateEnd(&stream);
  return text;
}

TEST(ContentEncodingTest, TakesTheSmallestThatTheClientTakes) {
  EXPECT_EQ(best_encoding("gzip, deflate, br", kBoth), kBrotli);
  EXPECT_EQ(best_encoding("gzip, deflate", kBoth), kGzip);
  EXPECT_EQ(best_encoding("GZIP", kBoth), kGzip);
  EXPECT_EQ(best_encoding("x-gzip", kBoth), kGzip);
  EXPECT_EQ(best_encoding("*", kBoth), kBrotli);
  EXPECT_EQ(best_encoding("br", std::array{kGzip}), kIdentity);
}

TEST(ContentEncodingTest, WeightsGoFirst) {
  EXPECT_EQ(best_encoding("br;q=0.5, gzip;q=0.8", kBoth), kGzip);
  EXPECT_EQ(best_encoding("br;q=0, *", kBoth), kGzip);
  EXPECT_EQ(best_encoding("br;q=0,gzip;q=0.0", kBoth), kIdentity);
  EXPECT_EQ(best_encoding("gzip ; Q=0.001", kBoth), kGzip);
  EXPECT_EQ(best_encoding("*;q=0", kBoth), kIdentity);
}

TEST(ContentEncodingTest, WhatIsNoListOfEncodingsTakesNone) {
  for (const char* header : {"", " ", ",,;;,", "identity", "gzipped", "deflate", "gzip;q=x",
                             "gzip;q=2", "gzip;q=-1", "gzip;q=nan", ";q=1", "br,gzip\xff;=;q"}) {
    const bool has_brotli = std::string_view(header).starts_with("br,");
    EXPECT_EQ(best_encoding(header, kBoth), has_brotli ? kBrotli : kIdentity) << header;
  }
}

TEST(ContentEncodingTest, GzipIsReadBackAsItWas) {
  const std::string text(100'000, 'x');
  for (const Effort effort : {Effort::quick, Effort::most}) {
    const auto gzip = compress(text, kGzip, effort);
    ASSERT_TRUE(gzip);
    EXPECT_LT(gzip->size(), 1000u);
    EXPECT_EQ(unpacked(*gzip), text);
  }
}

TEST(ContentEncodingTest, EveryEncodingThatIsMadeMakesTextSmaller) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += "{\"number\": " + std::to_string(i) + "},";
  for (const ContentEncoding encoding : made_encodings()) {
    const auto made = compress(text, encoding, Effort::quick);
    ASSERT_TRUE(made) << name_of(encoding);
    EXPECT_LT(made->size(), text.size() / 4) << name_of(encoding);
  }
}

TEST(ContentEncodingTest, WhatDoesNotBecomeSmallerIsLeftAsItIs) {
  EXPECT_FALSE(compress("abc", kGzip, Effort::most));
  EXPECT_FALSE(compress("", kGzip, Effort::most));
  EXPECT_FALSE(compress(std::string(1000, 'x'), kIdentity, Effort::most));
}

TEST(ContentEncodingTest, TextIsWorthItAndPicturesAreNot) {
  for (const char* type :
       {"text/html; charset=utf-8", "text/css", "application/json", "application/geo+json",
        "application/xml", "image/svg+xml", "application/vnd.oai.openapi+json;version=3.0"}) {
    EXPECT_TRUE(is_worth_compressing(type)) << type;
  }
  for (const char* type :
       {"image/png", "image/webp", "font/woff2", "application/octet-stream", ""}) {
    EXPECT_FALSE(is_worth_compressing(type)) << type;
  }
}

TEST(ContentEncodingTest, EachEncodingHasATagOfItsOwn) {
  EXPECT_EQ(encoded_tag("\"ab\"", kIdentity), "\"ab\"");
  EXPECT_EQ(encoded_tag("\"ab\"", kGzip), "\"ab-gzip\"");
  EXPECT_EQ(encoded_tag("\"ab\"", kBrotli), "\"ab-br\"");
}

}  // namespace
}  // namespace trapeze
