#include "server/cli/interruption.h"

#include <unistd.h>

#include <csignal>
#include <string_view>
#include <thread>

#include "core/io/file/unfinished.h"

namespace trapeze {
namespace {

constexpr int kStatusOfSignals = 128;  // as in shells: 128 plus the number of the signal

bool is_ignored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// Runs in a thread, where everything is allowed that a signal handler must not do.
[[noreturn]] void wait_and_end(const sigset_t& signals) {
  int signal = 0;
  while (sigwait(&signals, &signal) != 0) {
  }
  remove_unfinished();
  constexpr std::string_view kWords = "\ntrapeze: interrupted\n";
  // The line feed ends a progress bar.
  const std::string_view shown = isatty(STDERR_FILENO) != 0 ? kWords : kWords.substr(1);
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, shown.data(), shown.size());
  _exit(kStatusOfSignals + signal);  // the other threads are still running
}

}  // namespace

void end_cleanly_when_interrupted() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM}) {
    if (!is_ignored(signal)) sigaddset(&signals, signal);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // also for threads created later
  std::thread([signals] { wait_and_end(signals); }).detach();
}

}  // namespace trapeze
