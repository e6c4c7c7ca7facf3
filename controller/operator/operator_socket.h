#pragma once

#include <string>
#include <vector>

namespace flexarm {

/// The daemon's Unix stream socket: clients send lines, and get lines back.
///
/// Never waits: a client that does not read its replies is closed, and so is one that sends a line
/// longer than kMaxLine. Thread: the operator's.
class OperatorSocket {
 public:
  static constexpr std::size_t kMaxLine = 1 << 20;  ///< an experiment file is a few kB
  static constexpr std::size_t kMaxClients = 16;

  struct Message {
    int client;
    std::string line;  ///< without its newline
  };

  /// Listens on `path`, for its owner and group only. A socket that a dead daemon left is replaced.
  /// @throws Refused if the path cannot be used, or a daemon is listening there already
  explicit OperatorSocket(std::string path);
  ~OperatorSocket();  ///< closes every client and removes the socket
  OperatorSocket(const OperatorSocket&) = delete;
  OperatorSocket& operator=(const OperatorSocket&) = delete;

  /// Accepts and reads what is there.
  std::vector<Message> Poll();

  /// Sends one line; a client that is gone, or too slow, is closed.
  void Reply(int client, const std::string& line);

 private:
  struct Client {
    int fd;
    std::string received;
  };

  void Accept();
  /// False if the client is gone or must go.
  bool Read(Client* client, std::vector<Message>* messages);
  void Close(int fd);

  std::string path_;
  int listener_ = -1;
  std::vector<Client> clients_;
};

/// Client's side: sends one line to the daemon at `path` and waits for its answer.
/// @throws Refused saying what to do if no daemon answers within `timeout_s`
std::string AskDaemon(const std::string& path, const std::string& line, double timeout_s);

}  // namespace flexarm
