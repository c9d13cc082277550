#include "bench/measure/child_process.h"

#include <gtest/gtest.h>
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace trapeze {
namespace {

std::string temporary_file(const std::string& name) {
  return (std::filesystem::path(::testing::TempDir()) / name).string();
}

TEST(ChildProcessTest, TellsHowAProgramEnded) {
  const std::string log = temporary_file("child.log");
  ChildProcess child({"sh", "-c", "exit 7"}, log);
  EXPECT_EQ(child.wait(), 7);
  EXPECT_FALSE(child.is_running());
  EXPECT_THROW(run_to_end({"false"}, log), std::runtime_error);
  EXPECT_THROW(run_to_end({"no-such-program-anywhere"}, log), std::runtime_error);
}

TEST(ChildProcessTest, CountsTheProcessorTimeOfChildrenToo) {
  ChildProcess child({"sh", "-c", "(while :; do :; done) & wait"}, temporary_file("busy.log"));
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (child.cpu_seconds() < 0.05 && std::chrono::steady_clock::now() < patience) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_GE(child.cpu_seconds(), 0.05);
}

/// A process that has not been waited for is still listed, as a zombie.
bool has_ended(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string number;
  std::string name;
  std::string state;
  stat >> number >> name >> state;
  return state.empty() || state == "Z" || state == "X";
}

TEST(ChildProcessTest, EndsWhatTheProgramLeftBehind) {
  const std::string file = temporary_file("left_behind");
  {
    ChildProcess child({"sh", "-c", "sleep 600 & echo $! > " + file}, temporary_file("left.log"));
    ASSERT_EQ(child.wait(), 0);
  }
  pid_t left_behind = 0;
  std::ifstream(file) >> left_behind;
  ASSERT_GT(left_behind, 1);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!has_ended(left_behind) && std::chrono::steady_clock::now() < patience) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(has_ended(left_behind));
}

TEST(ChildProcessTest, AFreePortIsOne) {
  EXPECT_GT(free_port(), 0);
}

}  // namespace
}  // namespace trapeze
