#include "controller/host/journal.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/sinks/systemd_sink.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

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

}  // namespace

Journal::Journal() {
  std::shared_ptr<spdlog::logger> logger;
  if (StderrIsTheJournal()) {
    auto sink = std::make_shared<spdlog::sinks::systemd_sink_mt>();
    logger = std::make_shared<spdlog::logger>("flexarmd", std::move(sink));
  } else {
    logger = std::make_shared<spdlog::logger>("flexarmd",
                                              std::make_shared<spdlog::sinks::stderr_sink_mt>());
    logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e flexarmd %l: %v");
  }
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

void Journal::Info(const std::string& text) { spdlog::info("{}", text); }

void Journal::Error(const std::string& text) { spdlog::error("{}", text); }

}  // namespace flexarm
