#include "tools/dashboard/status_link.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/files/input_error.h"
#include "controller/operator/operator_client.h"
#include "tools/status/reply.h"

namespace flexarm {
namespace {

// A daemon that runs answers within a look of its operator task, 10 ms.
constexpr double kAnswerWithin_s = 1.0;
constexpr double kTryEvery_s = 0.5;
const std::string kQuestion = R"({"command":"status"})";

std::string Event(const char* name, const Reply& data) {
  return std::string("event: ") + name +
         "\ndata: " + data.dump(-1, ' ', false, Reply::error_handler_t::replace) + "\n\n";
}

double Now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

StatusLink::StatusLink(std::string socket, double period_s, NewestMessage& messages)
    : socket_(std::move(socket)),
      period_s_(period_s),
      messages_(messages),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

std::string StatusLink::NewestStatus() const {
  const std::scoped_lock lock(mutex_);
  return newest_;
}

void StatusLink::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      Follow(stop);
    } catch (const std::exception& error) {
      // One that was lost may be there again: then the page need not know, or else learns more.
      if (std::exchange(answered_, false)) continue;
      TellGone(error.what());
      Wait(stop, kTryEvery_s);
    }
  }
}

void StatusLink::Follow(const std::stop_token& stop) {
  DaemonConnection daemon(socket_, kAnswerWithin_s);
  double next_s = Now_s();
  while (!stop.stop_requested()) {
    const Reply answer = Reply::parse(daemon.Ask(kQuestion, kAnswerWithin_s), nullptr, false);
    if (!FlagIn(answer, "ok")) {
      throw InputError(TextIn(answer, "error", "the answer of the daemon is not a status"));
    }
    newest_at_s_ = Now_s();
    answered_ = true;
    {
      const std::scoped_lock lock(mutex_);
      newest_ = answer.dump(-1, ' ', false, Reply::error_handler_t::replace);
    }
    messages_.Publish(Event("status", answer));
    next_s = std::max(next_s + period_s_, Now_s());
    Wait(stop, next_s - Now_s());
  }
}

void StatusLink::TellGone(const std::string& why) {
  {
    const std::scoped_lock lock(mutex_);
    newest_.clear();
  }
  Reply gone{{"error", why}, {"age_s", nullptr}};
  if (newest_at_s_ > 0.0) gone["age_s"] = Now_s() - newest_at_s_;
  messages_.Publish(Event("gone", gone));
}

void StatusLink::Wait(const std::stop_token& stop, double seconds) {
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  ended.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
}

}  // namespace flexarm
