#include "controller/host/journal.h"

#include <poll.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/systemd_sink.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <memory>
#include <string>

#include "controller/files/external_text.h"

namespace flexarm {
namespace {

// systemd.exec(5): JOURNAL_STREAM names the device and inode of the stream to the journal. A
// process started by a service inherits the variable, though its stderr may be something else.
bool StderrIsTheJournal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat standard_error{};
  if (stream == nullptr || fstat(STDERR_FILENO, &standard_error) != 0) return false;
  return stream ==
         std::to_string(standard_error.st_dev) + ":" + std::to_string(standard_error.st_ino);
}

/// Writes to descriptor 2 without the C library's stream: a thread that hangs in a write to the
/// stream holds its lock, and the end of the process waits for that lock.
class StderrSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t count = write(STDERR_FILENO, text.data() + done, text.size() - done);
      if (count > 0) {
        done += static_cast<std::size_t>(count);
      } else if (count < 0 && errno == EAGAIN) {  // another process made the terminal non-blocking
        pollfd ready{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
        poll(&ready, 1, -1);
      } else if (count == 0 || errno != EINTR) {
        return;  // closed: this line has nowhere to go
      }
    }
  }
  void flush_() override {}
};

JournalQueue::Write MakeWrite() {
  std::shared_ptr<spdlog::logger> logger;
  if (StderrIsTheJournal()) {
    auto sink = std::make_shared<spdlog::sinks::systemd_sink_st>();
    logger = std::make_shared<spdlog::logger>("flexarmd", std::move(sink));
  } else {
    logger = std::make_shared<spdlog::logger>("flexarmd", std::make_shared<StderrSink>());
    logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e flexarmd %l: %v");
  }
  // By default spdlog reports its own errors to the C library's stderr (see StderrSink).
  logger->set_error_handler([](const std::string&) {});
  return [logger](const JournalLine& line) {
    logger->log(line.at, spdlog::source_loc{},
                line.is_error ? spdlog::level::err : spdlog::level::info, line.text);
  };
}

}  // namespace

Journal::Journal() : queue_(MakeWrite()) {}

// A line may quote what a client, a file or a device said.
void Journal::Report(bool is_error, const std::string& text) {
  queue_.Push({.is_error = is_error,
               .text = Shown(text, kMessageBytes),
               .at = std::chrono::system_clock::now()});
}

}  // namespace flexarm
