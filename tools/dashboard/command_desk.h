#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "controller/operator/operator_client.h"
#include "tools/dashboard/command_request.h"

namespace flexarm {

/// What became of a command.
struct CommandOutcome {
  bool answered;     ///< by the daemon
  bool ok;           ///< and it was carried out, or accepted
  std::string json;  ///< the daemon's answer, or {"ok": false, "error": ..}; one line
};

/// Gives commands to the daemon one after the other, each over a connection of its own, on a thread
/// of its own.
class CommandDesk {
 public:
  static constexpr std::size_t kMostWaiting = 8;

  using Done = std::function<void(const CommandOutcome&)>;  ///< on the desk's thread

  explicit CommandDesk(std::string socket);
  ~CommandDesk();
  CommandDesk(const CommandDesk&) = delete;
  CommandDesk& operator=(const CommandDesk&) = delete;

  /// Any thread. `done` is called once, also at the end. @returns false: too many wait, or it is
  /// closed; then `done` is not called
  bool Take(DaemonCommand command, Done done);

  /// Breaks off the command that is under way and those that wait, and waits until `done` of each
  /// was called. Not on the desk's thread.
  void Close();

 private:
  struct Job {
    DaemonCommand command;
    Done done;
  };

  void Run();
  CommandOutcome Give(const DaemonCommand& command);
  /// @throws RejectedError
  std::string Ask(const DaemonCommand& command);
  void SetCurrent(DaemonConnection* connection);

  std::string socket_;
  std::mutex mutex_;  // of what follows
  std::condition_variable news_;
  std::deque<Job> waiting_;
  bool closed_ = false;
  DaemonConnection* current_ = nullptr;
  std::thread thread_;
};

}  // namespace flexarm
