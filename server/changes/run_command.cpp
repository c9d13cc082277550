#include "server/changes/run_command.h"

#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <memory>
#include <system_error>
#include <thread>

namespace trapeze {
namespace {

constexpr std::chrono::milliseconds kTick{20};
constexpr std::chrono::seconds kGrace{1};

[[noreturn]] void throw_error(int error, const char* what) {
  throw std::system_error(error, std::generic_category(), what);
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// An in-memory file with the text: a command that does not read its input is still waited for, and
/// no writable folder is needed.
File file_of(const std::string& text) {
  const int descriptor = memfd_create("changes", MFD_CLOEXEC);
  if (descriptor < 0) throw_error(errno, "a temporary file");
  File file(fdopen(descriptor, "w+"), std::fclose);
  if (file == nullptr) {
    const int error = errno;
    close(descriptor);
    throw_error(error, "a temporary file");
  }
  const bool is_written = std::fwrite(text.data(), 1, text.size(), file.get()) == text.size() &&
                          std::fflush(file.get()) == 0;
  if (!is_written) throw_error(errno, "writing a temporary file");
  std::rewind(file.get());
  return file;
}

class Spawning {
 public:
  Spawning() {
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_init(&attributes_);
  }
  ~Spawning() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  Spawning(const Spawning&) = delete;
  Spawning& operator=(const Spawning&) = delete;

  /// Starts it in its own process group, with no signals blocked, its output redirected to standard
  /// error, and no other open files: with the sockets of the server, a command would keep open the
  /// connections that the server closes, and the port after the server has ended.
  pid_t start(const std::string& command, int input, char* const* environment) {
    posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, STDERR_FILENO, STDOUT_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
    posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&attributes_, 0);
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes_, &signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) {
      sigaddset(&signals, signal);
    }
    posix_spawnattr_setsigdefault(&attributes_, &signals);
    std::string text = command;
    std::array<char, 3> shell{"sh"};
    std::array<char, 3> option{"-c"};
    std::array<char*, 4> arguments = {shell.data(), option.data(), text.data(), nullptr};
    pid_t process = 0;
    const int error =
        posix_spawn(&process, "/bin/sh", &actions_, &attributes_, arguments.data(), environment);
    if (error != 0) throw_error(error, "/bin/sh");
    return process;
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

/// The environment of this process with additional variables.
std::vector<std::string> environment_with(
    const std::vector<std::pair<std::string, std::string>>& variables) {
  std::vector<std::string> all;
  for (char** each = environ; *each != nullptr; ++each) all.emplace_back(*each);
  for (const auto& [name, value] : variables) all.push_back(fmt::format("{}={}", name, value));
  return all;
}

}  // namespace

int run_command(const std::string& command,
                const std::vector<std::pair<std::string, std::string>>& variables,
                const std::string& input, const std::function<bool()>& is_stopping) {
  const File file = file_of(input);
  std::vector<std::string> variables_of_it = environment_with(variables);
  std::vector<char*> environment;
  environment.reserve(variables_of_it.size() + 1);
  for (std::string& variable : variables_of_it) environment.push_back(variable.data());
  environment.push_back(nullptr);
  const pid_t process = Spawning().start(command, fileno(file.get()), environment.data());
  std::chrono::steady_clock::duration stopping{};
  int status = 0;
  bool has_ended = false;
  while (true) {
    if (!has_ended) {
      const pid_t ended = waitpid(process, &status, WNOHANG);
      if (ended < 0 && errno != EINTR) throw_error(errno, "waiting for the command");
      has_ended = ended == process;
    }
    // The shell ends at once when it is stopped; what it has started may take longer.
    const bool is_any_left = stopping.count() > 0 && kill(-process, 0) == 0;
    if (has_ended && !is_any_left) break;
    if (is_stopping()) {
      const bool is_last = stopping > kGrace;
      kill(-process, is_last ? SIGKILL : SIGTERM);
      if (has_ended && is_last) break;
      stopping += kTick;
    }
    std::this_thread::sleep_for(kTick);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace trapeze
