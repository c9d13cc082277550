#include "server/service/access_log.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

struct Sample {
  HttpRequest request{"GET", "/tiles/a/0/0/0.png?fill=red",     "maps.example", "",
                      "",    parse_address("192.0.2.7").value()};
  HttpResponse response{200, {{"X-Cache", "HIT"}}, std::make_shared<const std::string>("12345")};
  std::string referer = "http://maps.example/";
  std::string agent = "curl/8";

  Answered answered() const {
    return {request, response, std::chrono::duration<double>(0.0015), 11, referer, agent};
  }
};

TEST(AccessLineTest, TextIsTheCombinedFormatAndMore) {
  EXPECT_THAT(access_line(Sample().answered(), LogFormat::text),
              MatchesRegex("192\\.0\\.2\\.7 - - \\[[0-9]+/[A-Z][a-z]+/[0-9]+:[0-9:]+ \\+0000\\] "
                           "\"GET /tiles/a/0/0/0\\.png\\?fill=red HTTP/1\\.1\" 200 5 "
                           "\"http://maps\\.example/\" \"curl/8\" 0\\.001500 HIT"));
}

TEST(AccessLineTest, JsonHasTheSameByName) {
  const auto json = nlohmann::json::parse(access_line(Sample().answered(), LogFormat::json));
  EXPECT_EQ(json["client"], "192.0.2.7");
  EXPECT_EQ(json["method"], "GET");
  EXPECT_EQ(json["target"], "/tiles/a/0/0/0.png?fill=red");
  EXPECT_EQ(json["status"], 200);
  EXPECT_EQ(json["bytes"], 5);
  EXPECT_DOUBLE_EQ(json["seconds"], 0.0015);
  EXPECT_EQ(json["cache"], "HIT");
  EXPECT_EQ(json["user_agent"], "curl/8");
}

TEST(AccessLineTest, HeadSendsNoBytes) {
  Sample sample;
  sample.request.method = "HEAD";
  EXPECT_THAT(access_line(sample.answered(), LogFormat::text), HasSubstr(" 200 0 "));
  const auto json = nlohmann::json::parse(access_line(sample.answered(), LogFormat::json));
  EXPECT_EQ(json["bytes"], 0);
}

TEST(AccessLineTest, NothingThatAClientSendsForgesALine) {
  Sample sample;
  sample.agent = "a\" 200\n192.0.2.1 \\ \x1b[31m \xff";
  sample.request.target = "/\xc3\xa4\r\n\"";
  for (const LogFormat format : {LogFormat::text, LogFormat::json}) {
    const std::string line = access_line(sample.answered(), format);
    EXPECT_TRUE(std::ranges::all_of(line, [](char c) { return c >= ' ' && c <= '~'; })) << line;
  }
  EXPECT_THAT(access_line(sample.answered(), LogFormat::text),
              HasSubstr(R"("a\" 200\x0a192.0.2.1 \\ \x1b[31m \xff")"));
  EXPECT_TRUE(nlohmann::json::accept(access_line(sample.answered(), LogFormat::json)));
}

TEST(AccessLogTest, AppendsLinesAndOpensItsFileAgain) {
  const std::string path = ::testing::TempDir() + "/access_log_test.log";
  std::filesystem::remove(path);
  std::filesystem::remove(path + ".1");
  {
    AccessLog log(path, LogFormat::text);
    log.write(Sample().answered());
    log.write(Sample().answered());
  }
  EXPECT_EQ(std::ranges::count(read_file(path), '\n'), 2) << "all is written in the end";
  {
    AccessLog log(path, LogFormat::text);
    log.write(Sample().answered());
    std::filesystem::rename(path, path + ".1");
    log.reopen();
    log.write(Sample().answered());
  }
  EXPECT_EQ(std::ranges::count(read_file(path + ".1"), '\n'), 3);
  EXPECT_EQ(std::ranges::count(read_file(path), '\n'), 1);
  std::filesystem::remove(path);
  std::filesystem::remove(path + ".1");
}

TEST(AccessLogTest, AFileThatCannotBeOpenedIsAnErrorThatNamesIt) {
  try {
    AccessLog log("/dev/null/access.log", LogFormat::text);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/dev/null/access.log"));
  }
}

TEST(AccessLogTest, APipeThatNobodyReadsIsAnErrorThatNamesIt) {
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  try {
    AccessLog log(pipe, LogFormat::text);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(pipe), HasSubstr("a pipe that nobody reads")));
  }
}

TEST(AccessLogTest, GoesOnWhereNothingCanBeWritten) {
  AccessLog log("/dev/full", LogFormat::text);
  for (int i = 0; i < 100; ++i) log.write(Sample().answered());
}

}  // namespace
}  // namespace trapeze
