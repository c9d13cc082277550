#include "bench/measure/child_process.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace trapeze {
namespace {

[[noreturn]] void become(const std::vector<std::string>& arguments, const std::string& log,
                         const std::vector<std::string>& environment) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  for (const std::string& setting : environment) putenv(const_cast<char*>(setting.c_str()));
  execvp(argv[0], argv.data());
  _exit(127);
}

struct ProcessStat {
  pid_t group = 0;
  double cpu_seconds = 0;
};

/// All zeros for a process that has ended.
ProcessStat read_stat(const std::filesystem::path& folder) {
  std::ifstream file(folder / "stat");
  std::string text;
  std::getline(file, text);
  const std::size_t name_end = text.rfind(')');  // the name may contain anything
  if (name_end == std::string::npos) return {};
  std::istringstream fields(text.substr(name_end + 1));
  ProcessStat stat;
  std::string skipped;
  long user = 0;
  long system = 0;
  fields >> skipped >> skipped >> stat.group;
  for (int i = 0; i < 8; ++i) fields >> skipped;
  fields >> user >> system;
  stat.cpu_seconds = static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  return stat;
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const std::string& log,
                           const std::vector<std::string>& environment) {
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("cannot start " + arguments.front());
  if (pid_ == 0) become(arguments, log, environment);
  setpgid(pid_, pid_);  // here and in the child: whichever comes first
}

ChildProcess::~ChildProcess() {
  if (is_running()) kill(-pid_, SIGTERM);
  for (int tries = 0; tries < 500 && is_running(); ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(-pid_, SIGKILL);  // including orphaned children
  wait();
}

bool ChildProcess::is_running() {
  if (!has_ended_) has_ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return !has_ended_;
}

double ChildProcess::cpu_seconds() const {
  double sum = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    if (!is_number(entry.path().filename().string())) continue;
    const ProcessStat stat = read_stat(entry.path());
    if (stat.group == pid_) sum += stat.cpu_seconds;
  }
  return sum;
}

int ChildProcess::wait() {
  if (!has_ended_) waitpid(pid_, &status_, 0);
  has_ended_ = true;
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
}

void run_to_end(const std::vector<std::string>& arguments, const std::string& log) {
  ChildProcess child(arguments, log);
  if (child.wait() != 0) {
    throw std::runtime_error("this failed: " + joined(arguments) + "\nwhat it said is in " + log);
  }
}

std::uint16_t free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool bound =
      bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  close(socket);
  if (!bound) throw std::runtime_error("there is no free port");
  return ntohs(address.sin_port);
}

}  // namespace trapeze
