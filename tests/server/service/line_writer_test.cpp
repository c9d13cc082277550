#include "server/service/line_writer.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <mutex>
#include <string>
#include <vector>

#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::shared_ptr<const LineFile> open_lines(const std::string& path) {
  return std::make_shared<LineFile>(path);
}

/// The events that a writer reports.
struct Told {
  std::uint64_t lost = 0;
  int times = 0;
  std::vector<std::string> failures;
  std::mutex mutex;

  LineWriter::Events events() {
    return {[this](std::uint64_t lines) {
              const std::lock_guard lock(mutex);
              lost += lines;
              ++times;
            },
            [this](const std::string& words) {
              const std::lock_guard lock(mutex);
              failures.push_back(words);
            }};
  }
};

TEST(LineWriterTest, WritesLinesInOrderAndAllOfThemInTheEnd) {
  const TemporaryFolder folder;
  std::string expected;
  {
    LineWriter writer(open_lines(folder.file("log")));
    for (int i = 0; i < 1000; ++i) {
      writer.write(std::to_string(i));
      expected += std::to_string(i) + "\n";
    }
  }
  EXPECT_EQ(read_file(folder.file("log")), expected);
}

TEST(LineWriterTest, LinesGoToTheFileThatThereWasWhenTheyCame) {
  const TemporaryFolder folder;
  {
    LineWriter writer(open_lines(folder.file("old")));
    writer.write("one");
    writer.redirect(open_lines(folder.file("new")));
    writer.write("two");
  }
  EXPECT_EQ(read_file(folder.file("old")), "one\n");
  EXPECT_EQ(read_file(folder.file("new")), "two\n");
}

TEST(LineWriterTest, NobodyWaitsForAPipeThatIsNotReadAndWhatIsLostIsCountedAndToldOnce) {
  constexpr std::size_t kLines = 20'000;
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  Told told;
  std::string read;
  {
    LineWriter writer(open_lines(pipe), told.events());
    for (std::size_t i = 0; i < kLines; ++i) writer.write(std::string(1000, 'x'));
    // Reading begins only now.
    std::string piece(1 << 16, '\0');
    for (int idle = 0; idle < 100;) {
      const ssize_t bytes = ::read(reader, piece.data(), piece.size());
      if (bytes > 0) read.append(piece.data(), static_cast<std::size_t>(bytes));
      const std::lock_guard lock(told.mutex);
      idle = bytes > 0 ? 0 : idle + (told.times > 0 ? 100 : 0);
    }
  }
  // Lines written when the writer was destroyed.
  std::string rest(1 << 20, '\0');
  const ssize_t bytes = ::read(reader, rest.data(), rest.size());
  if (bytes > 0) read.append(rest.data(), static_cast<std::size_t>(bytes));
  close(reader);
  EXPECT_EQ(told.times, 1);
  EXPECT_GT(told.lost, 0u);
  EXPECT_EQ(told.lost + std::ranges::count(read, '\n'), kLines);
  EXPECT_THAT(told.failures, IsEmpty());
}

TEST(LineWriterTest, AFullDiskIsToldOnceAndWhatWasLostWhenThereIsRoomAgain) {
  const TemporaryFolder folder;
  Told told;
  LineWriter writer(open_lines("/dev/full"), told.events());
  for (int i = 0; i < 10; ++i) writer.write("lost");
  writer.redirect(open_lines(folder.file("log")));
  writer.write("kept");
  writer.flush(20s);
  EXPECT_EQ(read_file(folder.file("log")), "kept\n");
  const std::lock_guard lock(told.mutex);
  EXPECT_THAT(told.failures, ElementsAre("No space left on device"));
  EXPECT_EQ(told.lost, 10u);
  EXPECT_EQ(told.times, 1);
}

TEST(LineWriterTest, ALineThatIsCutOffIsEndedInItsOwnFileOnly) {
  const TemporaryFolder folder;
  const std::string old = folder.file("old");
  LineWriter writer(open_lines(old));
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto earlier = std::signal(SIGXFSZ, SIG_IGN);
  const auto cut_off = [&] {
    const rlimit low{4, limit.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
    writer.write("incomplete");
    writer.flush(20s);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  };
  cut_off();
  writer.redirect(open_lines(old));  // the log was not moved
  writer.write("same");
  writer.flush(20s);
  EXPECT_EQ(read_file(old), "inco\nsame\n");
  writer.redirect(open_lines(folder.file("older")));
  cut_off();
  writer.redirect(open_lines(folder.file("new")));
  writer.write("kept");
  writer.flush(20s);
  std::signal(SIGXFSZ, earlier);
  EXPECT_EQ(read_file(folder.file("new")), "kept\n");
}

TEST(LineWriterTest, EndsAlthoughAPipeIsNotRead) {
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  {
    LineWriter writer(open_lines(pipe));
    for (int i = 0; i < 1000; ++i) writer.write(std::string(1000, 'x'));
  }
  close(reader);
}

}  // namespace
}  // namespace trapeze
