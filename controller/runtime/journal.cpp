#include "controller/runtime/journal.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/sinks/systemd_sink.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <memory>

namespace flexarm {

Journal::Journal() {
  std::shared_ptr<spdlog::logger> logger;
  if (std::getenv("JOURNAL_STREAM") != nullptr) {  // systemd.exec(5): our stderr is the journal
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
