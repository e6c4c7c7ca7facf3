#pragma once

#include <string>
#include <vector>

#include "controller/operator/operator_client.h"  // the socket's other end, for its users

namespace flexarm {

/// Server side of the operator socket, a Unix stream socket: clients send lines and receive lines.
///
/// Never blocks: a client that does not read its replies is closed, and so is one that sends a line
/// longer than kMaxLine. Lines of a client that has closed its connection are dropped.
/// Not real-time safe: allocates. Thread: operator.
class OperatorSocket {
 public:
  static constexpr std::size_t kMaxLine = 1 << 20;  ///< bytes; an experiment file is a few kB
  static constexpr std::size_t kMaxClients = 16;    ///< at once; one more is closed

  struct Message {
    int client;        ///< for Reply
    std::string line;  ///< without its newline
  };

  /// Listens on `path`, for its owner and group only. A socket left by a daemon
  /// that has ended is replaced.
  /// @throws RejectedError if the path cannot be used, or a daemon is listening there already
  explicit OperatorSocket(std::string path);
  ~OperatorSocket();  ///< closes every client and removes the socket
  OperatorSocket(const OperatorSocket&) = delete;
  OperatorSocket& operator=(const OperatorSocket&) = delete;

  /// Accepts clients and reads what has arrived, without waiting. Once a period.
  std::vector<Message> Poll();

  /// Sends one line; a client that is gone, or too slow, is closed.
  void Reply(int client, const std::string& line);

 private:
  struct Client {
    int fd;
    std::string received;
  };

  void Accept();
  /// False if the client has closed its connection, or must be closed.
  bool Read(Client* client, std::vector<Message>* messages);
  void Close(int fd);

  std::string path_;
  int listener_ = -1;
  std::vector<Client> clients_;
};

}  // namespace flexarm
