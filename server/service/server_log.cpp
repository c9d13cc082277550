#include "server/service/server_log.h"

#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <mutex>
#include <string>
#include <utility>

#include "server/service/line_writer.h"

namespace trapeze {
namespace {

/// Passes lines on to the writer.
class QueueingSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit QueueingSink(std::shared_ptr<LineWriter> writer) : writer_(std::move(writer)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    std::string line(text.data(), text.size());
    if (line.ends_with('\n')) line.pop_back();
    writer_->write(std::move(line));
  }
  void flush_() override {}

  const std::shared_ptr<LineWriter> writer_;
};

void log_to(const spdlog::sink_ptr& sink) {
  sink->set_pattern(kServerLogPattern);
  spdlog::default_logger()->sinks() = {sink};
}

void warn_of_lost_server_lines(std::uint64_t lines) {
  spdlog::warn(fmt::format("{} lines of this log were lost, as it was not read", lines));
}

}  // namespace

ServerLog::ServerLog()
    : writer_(std::make_shared<LineWriter>(std::make_shared<LineFile>("stderr"),
                                           LineWriter::Events{warn_of_lost_server_lines, {}})) {
  log_to(std::make_shared<QueueingSink>(writer_));
}

ServerLog::~ServerLog() {
  log_to(std::make_shared<spdlog::sinks::stderr_sink_mt>());
}

void ServerLog::flush() {
  writer_->flush(std::chrono::seconds(1));
}

}  // namespace trapeze
