#include "server/http/response_head.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace trapeze {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

HttpResponse response_of(int status, const char* body) {
  HttpResponse response;
  response.status = status;
  if (body != nullptr) response.body = std::make_shared<const std::string>(body);
  return response;
}

std::string head_of(const HttpResponse& response, unsigned version = 11, bool keep_alive = true) {
  std::string text;
  append_response_head(response, version, keep_alive, text);
  return text;
}

TEST(ResponseHeadTest, HasStatusDateServerFieldsAndLength) {
  HttpResponse response = response_of(200, "12345");
  response.headers = {{"ETag", "\"a\""}, {"Content-Type", "text/plain"}};
  EXPECT_THAT(head_of(response),
              MatchesRegex("HTTP/1.1 200 OK\r\n"
                           "Date: [A-Z][a-z][a-z], [0-9][0-9] [A-Z][a-z][a-z] [0-9]+ "
                           "[0-9][0-9]:[0-9][0-9]:[0-9][0-9] GMT\r\n"
                           "Server: trapeze/[^\r]+\r\n"
                           "ETag: \"a\"\r\nContent-Type: text/plain\r\n"
                           "Content-Length: 5\r\n\r\n"));
}

TEST(ResponseHeadTest, WithoutABodyThereIsNoLength) {
  EXPECT_THAT(head_of(response_of(304, nullptr)), StartsWith("HTTP/1.1 304 Not Modified\r\n"));
  EXPECT_THAT(head_of(response_of(304, nullptr)), Not(HasSubstr("Content-Length")));
  EXPECT_THAT(head_of(response_of(200, "")), EndsWith("Content-Length: 0\r\n\r\n"));
}

TEST(ResponseHeadTest, WhetherTheConnectionStaysIsSaidWhereItIsNotUsual) {
  const HttpResponse response = response_of(200, "1");
  EXPECT_THAT(head_of(response, 11, true), Not(HasSubstr("Connection")));
  EXPECT_THAT(head_of(response, 11, false), HasSubstr("\r\nConnection: close\r\n"));
  EXPECT_THAT(head_of(response, 10, true), HasSubstr("\r\nConnection: keep-alive\r\n"));
  EXPECT_THAT(head_of(response, 10, false), Not(HasSubstr("Connection")));
  EXPECT_THAT(head_of(response, 10, false), StartsWith("HTTP/1.0 200 OK\r\n"));
}

TEST(ResponseHeadTest, IsAppended) {
  std::string text = "before";
  append_response_head(response_of(503, "x"), 11, true, text);
  EXPECT_THAT(text, StartsWith("beforeHTTP/1.1 503 Service Unavailable\r\n"));
}

}  // namespace
}  // namespace trapeze
