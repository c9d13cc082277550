#include "server/service/line_writer.h"

#include <fcntl.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace trapeze {
namespace {

constexpr std::size_t kMostWaitingBytes = std::size_t{4} << 20;
constexpr int kLookMs = 100;  // between checks whether to give up
constexpr auto kLastWait = std::chrono::seconds(1);

std::string words_of(int error) {
  return std::generic_category().message(error);
}

std::string problem_words(const std::string& path, int error) {
  return fmt::format("{} cannot be written: {}", path,
                     error == ENXIO ? "it is a pipe that nobody reads" : words_of(error));
}

/// For a pipe, does not wait for a reader.
int open_at_end(const std::string& path) {
  const int descriptor =
      open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
  if (descriptor >= 0) return descriptor;
  throw std::runtime_error(problem_words(path, errno));
}

/// Whether both write to the same file, which may have been opened twice.
bool are_same(const LineFile& a, const LineFile& b) {
  struct stat status_a {};
  struct stat status_b {};
  return fstat(a.descriptor(), &status_a) == 0 && fstat(b.descriptor(), &status_b) == 0 &&
         status_a.st_dev == status_b.st_dev && status_a.st_ino == status_b.st_ino;
}

}  // namespace

LineFile::LineFile(const std::string& target) {
  if (target == "stdout" || target == "stderr") {
    descriptor_ = target == "stdout" ? STDOUT_FILENO : STDERR_FILENO;
    open_pipe_anew();
  } else {
    descriptor_ = open_at_end(target);
    is_own_ = true;
  }
  struct stat status {};
  may_be_full_ = fstat(descriptor_, &status) == 0 && !S_ISREG(status.st_mode);
}

std::string find_target_problem(const std::string& target) {
  std::error_code error;
  const bool is_there =
      target == "stdout" || target == "stderr" || std::filesystem::exists(target, error);
  if (!is_there) {
    const auto folder = std::filesystem::absolute(target).parent_path();
    return access(folder.c_str(), W_OK | X_OK) == 0 ? std::string() : problem_words(target, errno);
  }
  try {
    const LineFile file(target);
    return {};
  } catch (const std::runtime_error& failure) {
    return failure.what();
  }
}

/// Opens the pipe again so that writing to it when full does not block, without changing that for
/// other processes that share it. Where this is not possible, put() takes care not to fill the
/// pipe.
void LineFile::open_pipe_anew() {
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISFIFO(status.st_mode)) return;
  const std::string path = fmt::format("/proc/self/fd/{}", descriptor_);
  const int opened = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
  if (opened < 0) return;
  descriptor_ = opened;
  is_own_ = true;
}

LineFile::~LineFile() {
  if (is_own_) close(descriptor_);
}

LineWriter::LineWriter(std::shared_ptr<const LineFile> file, Events events)
    : events_(std::move(events)), file_(std::move(file)), thread_([this] { work(); }) {}

LineWriter::~LineWriter() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    give_up_at_ = Clock::now() + kLastWait;
  }
  wake_.notify_all();
  thread_.join();
}

void LineWriter::write(std::string line) {
  line += '\n';
  const std::lock_guard lock(mutex_);
  const std::size_t bytes = line.size();
  queue_.push_back({std::move(line), file_});
  waiting_bytes_ += bytes;
  while (waiting_bytes_ > kMostWaitingBytes) {
    waiting_bytes_ -= queue_.front().text.size();
    queue_.pop_front();
    ++lost_;
  }
  wake_.notify_one();
}

void LineWriter::redirect(std::shared_ptr<const LineFile> file) {
  const std::lock_guard lock(mutex_);
  file_.swap(file);
}

void LineWriter::flush(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  is_idle_.wait_for(lock, patience, [this] { return queue_.empty() && !is_writing_; });
}

void LineWriter::work() {
  while (true) {
    Line line;
    {
      std::unique_lock lock(mutex_);
      is_writing_ = false;
      if (queue_.empty()) is_idle_.notify_all();
      wake_.wait(lock, [this] { return is_stopping_ || !queue_.empty(); });
      if (queue_.empty() || Clock::now() >= give_up_at_) return;
      line = std::move(queue_.front());
      queue_.pop_front();
      waiting_bytes_ -= line.text.size();
      is_writing_ = true;
    }
    bool is_written = false;
    try {
      is_written = put(line);
      if (is_written) tell_what_is_lost();
    } catch (const std::exception&) {
      // Memory has run out: at worst a line is lost, and is counted.
    }
    if (!is_written) {
      const std::lock_guard lock(mutex_);
      ++lost_;
    }
  }
}

/// Writes in pieces that a pipe accepts as a whole once it has room, so that the write does not
/// block.
bool LineWriter::put(const Line& line) {
  const bool is_line_broken = broken_ != nullptr && are_same(*broken_, *line.file);
  const std::string text = (is_line_broken ? "\n" : "") + line.text;
  std::size_t done = 0;
  while (done < text.size()) {
    if (line.file->may_be_full() && !wait_for_room(*line.file)) return false;
    const std::size_t piece = std::min<std::size_t>(text.size() - done, PIPE_BUF);
    const ssize_t written = ::write(line.file->descriptor(), text.data() + done, piece);
    if (written >= 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR && errno != EAGAIN) {
      note_failure(errno);
      if (done > 0) broken_ = line.file;
      return false;
    }
  }
  broken_ = nullptr;
  has_failed_ = false;
  return true;
}

/// False if it is time to end.
bool LineWriter::wait_for_room(const LineFile& file) const {
  pollfd wanted{file.descriptor(), POLLOUT, 0};
  while (poll(&wanted, 1, kLookMs) == 0) {
    const std::lock_guard lock(mutex_);
    if (Clock::now() >= give_up_at_) return false;
  }
  return true;
}

void LineWriter::note_failure(int error) {
  if (!std::exchange(has_failed_, true) && events_.failed) events_.failed(words_of(error));
}

/// Called when the queue is empty, so that lost lines are reported once.
void LineWriter::tell_what_is_lost() {
  std::uint64_t lost = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!queue_.empty() && !is_stopping_) return;
    lost = std::exchange(lost_, 0);
  }
  if (lost > 0 && events_.lost) events_.lost(lost);
}

}  // namespace trapeze
