#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tools/dashboard/newest_message.h"

namespace flexarm {

/// Asks the daemon for its status once a period, over one connection however many browsers there
/// are, and publishes each answer as a server-sent event:
///
///     event: status            data: the answer of docs/protocol.md
///     event: gone              data: {"error": why there is none, "age_s": since the last one}
///
/// When the daemon has gone it says so, and connects again.
class StatusLink {
 public:
  /// @param messages  outlives this
  StatusLink(std::string socket, double period_s, NewestMessage& messages);

  /// The newest answer, one line of JSON; empty: there is none now.
  std::string NewestStatus() const;

 private:
  void Run(const std::stop_token& stop);
  /// Until the daemon no longer answers. @throws RejectedError, InputError
  void Follow(const std::stop_token& stop);
  void TellGone(const std::string& why);
  void Wait(const std::stop_token& stop, double seconds);

  std::string socket_;
  double period_s_;
  NewestMessage& messages_;
  double newest_at_s_ = 0.0;  // of the clock; 0: there was none
  bool answered_ = false;     // on this connection
  mutable std::mutex mutex_;  // of what follows
  std::string newest_;
  std::jthread thread_;
};

}  // namespace flexarm
