#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "controller/operator/peer.h"

namespace flexarm {

/// One connection of the operator socket, accepted: what it has sent, in lines, and how many of
/// them have not been answered yet.
///
/// Never blocks. What it holds of a client is bounded: kMaxLine and one read. Whatever else the
/// client sends waits in the kernel, and so does the client. Not real-time safe: allocates.
/// Thread: operator.
class OperatorConnection {
 public:
  static constexpr std::size_t kMaxLine = 1 << 20;        ///< bytes; an experiment is a few kB
  static constexpr std::size_t kReadPerPoll = 256 << 10;  ///< bytes
  static constexpr std::size_t kLongLine = 4 << 10;       ///< bytes: takes time to read
  /// Polls after which a client that sends nothing more, and has answers to come, is forgotten.
  static constexpr int kLingerPolls = 250;

  /// @param fd      connected, non-blocking; closed by the destructor
  /// @param number  of the client; never used twice
  OperatorConnection(int fd, int number, Peer peer);
  ~OperatorConnection();
  OperatorConnection(OperatorConnection&& other) noexcept;
  OperatorConnection& operator=(OperatorConnection&& other) noexcept;
  OperatorConnection(const OperatorConnection&) = delete;
  OperatorConnection& operator=(const OperatorConnection&) = delete;

  int fd() const { return fd_; }  ///< -1: closed
  int number() const { return number_; }
  const Peer& peer() const { return peer_; }
  uid_t uid() const { return peer_.uid; }
  /// The client has closed its end, and sends nothing more.
  bool ended() const { return ended_; }
  /// Lines that were handed out and have no reply yet.
  int unanswered() const { return unanswered_; }
  /// Polls in which a whole line of it has waited, since none did.
  int waited_polls() const { return waited_polls_; }
  /// Polls without a line from it, since the last one or since it connected.
  std::int64_t quiet_polls() const { return quiet_polls_; }
  /// The client still reads: it has not closed the connection, or its end of sending alone.
  bool CanBeReached() const;
  /// Nothing more will come of it, and nothing can reach it or is due to it.
  bool over() const;

  /// A whole line waits.
  bool HasLine() const { return line_end_ != std::string::npos; }
  /// That line is longer than kLongLine.
  bool HasLongLine() const { return HasLine() && line_end_ - read_ > kLongLine; }

  /// Reads what has arrived. Once a poll, before NextLine.
  /// @param arrived  false: nothing has
  void Read(bool arrived);

  /// Hands out the next whole line, without its newline. Lines that a client sent before it closed
  /// its end are handed out like others.
  std::optional<std::string> NextLine();

  /// Sends one line. A client that does not read its replies is closed.
  void Reply(const std::string& line);

  /// Says why, and closes. @param refusal  its machine name
  void Dismiss(const std::string& refusal, const std::string& reason);
  /// Sends a line that is no reply, and closes.
  void CloseWith(const std::string& line);

 private:
  void Send(const std::string& line);
  void Close();

  int fd_;
  int number_;
  Peer peer_;
  std::string received_;
  std::size_t read_ = 0;                      // bytes of received_ that were handed out
  std::size_t line_end_ = std::string::npos;  // of the next line; npos: it is not whole
  bool ended_ = false;                        // the client sends nothing more
  int unanswered_ = 0;
  std::int64_t quiet_polls_ = 0;
  int waited_polls_ = 0;
};

}  // namespace flexarm
