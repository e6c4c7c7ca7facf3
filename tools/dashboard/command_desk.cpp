#include "tools/dashboard/command_desk.h"

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/types/rejected_error.h"
#include "tools/status/reply.h"

namespace flexarm {
namespace {

constexpr double kConnectWithin_s = 2.0;
constexpr int kTries = 50;

CommandOutcome NoAnswer(const std::string& why) {
  const Reply json{{"ok", false}, {"error", why}};
  return {.answered = false,
          .ok = false,
          .json = json.dump(-1, ' ', false, Reply::error_handler_t::replace)};
}

}  // namespace

CommandDesk::CommandDesk(std::string socket)
    : socket_(std::move(socket)), thread_([this] { Run(); }) {}

CommandDesk::~CommandDesk() { Close(); }

bool CommandDesk::Take(DaemonCommand command, Done done) {
  const std::scoped_lock lock(mutex_);
  if (closed_ || waiting_.size() >= kMostWaiting) return false;
  waiting_.push_back({.command = std::move(command), .done = std::move(done)});
  news_.notify_one();
  return true;
}

void CommandDesk::Close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    if (current_ != nullptr) current_->Interrupt();
    news_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

void CommandDesk::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    news_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Job job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    job.done(Give(job.command));
    lock.lock();
  }
}

CommandOutcome CommandDesk::Give(const DaemonCommand& command) {
  try {
    const Reply answer = Reply::parse(Ask(command), nullptr, false);
    if (!answer.is_object()) return NoAnswer("the answer of the daemon is not JSON");
    return {.answered = true,
            .ok = FlagIn(answer, "ok"),
            .json = answer.dump(-1, ' ', false, Reply::error_handler_t::replace)};
  } catch (const std::exception& error) {
    return NoAnswer(error.what());
  }
}

void CommandDesk::SetCurrent(DaemonConnection* connection) {
  const std::scoped_lock lock(mutex_);
  if (closed_ && connection != nullptr) throw RejectedError("the dashboard ends");
  current_ = connection;
}

// A crowd of clients can close the connection before the command is heard. To stop twice does no
// harm.
std::string CommandDesk::Ask(const DaemonCommand& command) {
  int tries = command.name == "stop" ? kTries : 1;
  for (;;) {
    DaemonConnection daemon(socket_, kConnectWithin_s);
    SetCurrent(&daemon);
    std::string answer;
    try {
      answer = daemon.Ask(command.line, command.within_s);
    } catch (const std::exception&) {
      SetCurrent(nullptr);
      throw;
    }
    SetCurrent(nullptr);
    const Reply reply = Reply::parse(answer, nullptr, false);
    if (--tries == 0 || TextIn(reply, "refusal") != "too-many-clients") return answer;
  }
}

}  // namespace flexarm
