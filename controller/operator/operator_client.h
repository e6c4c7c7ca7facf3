#pragma once

#include <string>

#include "controller/runlog/file_descriptor.h"

namespace flexarm {

/// Client side of the operator socket: a connection on which lines are asked and answered in turn.
class DaemonConnection {
 public:
  /// Connects to the daemon at `path`. @throws RejectedError saying what to do if no daemon listens
  /// there within `timeout_s`, or this user may not connect
  DaemonConnection(std::string path, double timeout_s);

  /// Sends one line, waits for its answer, and returns that without its newline. Blocks for up to
  /// `timeout_s` after every byte. After an exception the connection is of no more use: an answer
  /// that comes late would be mistaken for the next one.
  /// @throws RejectedError if the daemon does not answer, or has closed the connection
  std::string Ask(const std::string& line, double timeout_s);

  /// Any thread: ends a wait for an answer, which throws, and all that follow.
  void Interrupt() noexcept;

 private:
  [[noreturn]] void Fail(const std::string& what) const;
  void Receive(double timeout_s, const std::string& problem);

  std::string path_;
  FileDescriptor socket_;
  std::string received_;
};

/// A connection for one question. @throws RejectedError as DaemonConnection
std::string AskDaemon(const std::string& path, const std::string& line, double timeout_s);

}  // namespace flexarm
