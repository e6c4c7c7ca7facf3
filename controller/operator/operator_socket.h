#pragma once

#include <poll.h>
#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "controller/operator/operator_connection.h"
#include "controller/operator/operator_roles.h"

namespace flexarm {

/// Server side of the operator socket, a Unix stream socket: clients send lines and receive lines.
///
/// Never blocks, and always admits one more client: if there are kMaxClients, or kMaxClientsOfUser
/// of its user, another is closed, of the user who has most, but not one of root or of the holder
/// of the lease if there is another: first one that has closed its end, then one to whom no answer
/// is due, then the one that has been quiet the longest. It is told so. So a stop needs no free
/// connection.
///
/// Any user may connect. Who has no role gets one line that says so, and is closed before anything
/// that it sends is read.
///
/// Each client has a number, which is never used twice: an answer reaches no other client. Not
/// real-time safe: allocates. Thread: operator.
class OperatorSocket {
 public:
  static constexpr std::size_t kMaxClients = 16;
  static constexpr std::size_t kMaxClientsOfUser = 8;
  /// More wait outside until a poll has accepted those: so a client that has connected is heard in
  /// the next poll.
  static constexpr int kBacklog = 32;
  static constexpr int kAcceptsPerPoll = kBacklog + 8;
  static constexpr std::size_t kLinesPerPoll = 16;  ///< of all clients; the others come later

  struct Message {
    int client;        ///< number of the client, for Reply
    std::string line;  ///< without its newline
    Peer by;           ///< who sent it
    int waited_polls;  ///< in which a line of its client waited already
  };

  /// Listens on `path`. A socket left by a daemon of the same user that has ended is replaced;
  /// anything else that is there stays.
  /// @throws RejectedError if the path cannot be used, or a daemon is listening there already
  explicit OperatorSocket(std::string path, OperatorRoles roles = OperatorRoles(),
                          CredentialsReader credentials_of = CredentialsOf);
  ~OperatorSocket();  ///< closes every client, and removes the socket that it made
  OperatorSocket(const OperatorSocket&) = delete;
  OperatorSocket& operator=(const OperatorSocket&) = delete;

  /// Who holds the lease: closed last when there are too many.
  void SetHolder(std::optional<uid_t> user) { holder_ = user; }

  /// Accepts clients and reads what has arrived, without waiting. One line of each client, new ones
  /// included, then further ones in turn, kLinesPerPoll in all; of long ones (kLongLine) one in
  /// all, of each client in turn, so that they do not hold up the others. Once a period.
  std::vector<Message> Poll();

  /// Whether a client can still get an answer. One that has only closed its end of sending can.
  bool IsThere(int client) const;

  /// Users without a role that have connected in the last poll.
  const std::vector<Peer>& turned_away() const { return turned_away_; }

  /// Sends one line; a client that is gone, or too slow, is closed.
  void Reply(int client, const std::string& line);

 private:
  void LookWhatArrived();
  void Accept(std::vector<Message>* messages);
  /// The next line of a client; false: it has none.
  static bool Take(OperatorConnection* client, std::vector<Message>* messages);
  void TakeLongLine(std::vector<Message>* messages);
  bool IsKept(uid_t user) const { return user == 0 || user == holder_; }
  void MakeRoomFor(uid_t user, std::vector<Message>* messages);
  std::size_t CountOf(uid_t user) const;
  uid_t UserWithMost() const;

  std::string path_;
  OperatorRoles roles_;
  CredentialsReader credentials_of_;
  int listener_ = -1;
  dev_t device_ = 0;  // of the socket's file, with
  ino_t inode_ = 0;   // its number
  int next_number_ = 1;
  std::vector<OperatorConnection> clients_;
  std::vector<pollfd> arrived_;  // of the clients, in their order, and last of the listener
  std::vector<Peer> turned_away_;
  std::optional<uid_t> holder_;
  int long_line_of_ = 0;  // number of the client whose long line was the last
};

}  // namespace flexarm
