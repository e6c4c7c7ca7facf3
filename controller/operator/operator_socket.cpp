#include "controller/operator/operator_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "controller/operator/unix_address.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

// What answers to a connection at an address: 0, or the error. ECONNREFUSED: none listens.
int ConnectError(const UnixAddress& address) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int error = connect(fd, address.get(), address.size()) == 0 ? 0 : errno;
  close(fd);
  return error;
}

// A socket on which no process listens, and which a process of this user made.
bool IsLeft(const std::string& path, int connect_error) {
  struct stat there{};
  return connect_error == ECONNREFUSED && lstat(path.c_str(), &there) == 0 &&
         S_ISSOCK(there.st_mode) && there.st_uid == geteuid();
}

}  // namespace

OperatorSocket::OperatorSocket(std::string path, OperatorRoles roles,
                               CredentialsReader credentials_of)
    : path_(std::move(path)), roles_(std::move(roles)), credentials_of_(std::move(credentials_of)) {
  const UnixAddress address(path_);
  const int error = ConnectError(address);
  if (error == 0 || error == EAGAIN) {
    throw RejectedError(path_ +
                        ": a daemon is listening there already; stop it first, or set "
                        "daemon.socket to another path");
  }
  if (IsLeft(path_, error)) unlink(path_.c_str());
  listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t old_mask = umask(0111);  // rw-rw-rw-: the roles say who may do what
  const bool bound = listener_ >= 0 && bind(listener_, address.get(), address.size()) == 0 &&
                     listen(listener_, kBacklog) == 0;
  const std::string cause = std::strerror(errno);
  umask(old_mask);
  struct stat made{};
  if (bound && lstat(path_.c_str(), &made) == 0) {
    device_ = made.st_dev;
    inode_ = made.st_ino;
    return;
  }
  if (listener_ >= 0) close(listener_);
  throw RejectedError(path_ + ": cannot listen (" + cause +
                      "); set daemon.socket to a path in a folder that exists and is writable");
}

OperatorSocket::~OperatorSocket() {
  close(listener_);
  struct stat there{};
  const bool own =
      lstat(path_.c_str(), &there) == 0 && there.st_dev == device_ && there.st_ino == inode_;
  if (own) unlink(path_.c_str());
}

std::size_t OperatorSocket::CountOf(uid_t user) const {
  return static_cast<std::size_t>(std::count_if(clients_.begin(), clients_.end(),
                                                [user](const auto& c) { return c.uid() == user; }));
}

uid_t OperatorSocket::UserWithMost() const {
  const auto rank = [this](const OperatorConnection& c) {
    return std::pair(!IsKept(c.uid()), CountOf(c.uid()));
  };
  return std::max_element(clients_.begin(), clients_.end(),
                          [&rank](const auto& a, const auto& b) { return rank(a) < rank(b); })
      ->uid();
}

// One whose line has come meanwhile is heard first: it had only just connected.
void OperatorSocket::MakeRoomFor(uid_t user, std::vector<Message>* messages) {
  const bool too_many_of_user = CountOf(user) >= kMaxClientsOfUser;
  if (!too_many_of_user && clients_.size() < kMaxClients) return;
  const uid_t of = too_many_of_user ? user : UserWithMost();
  const auto rank = [of](const OperatorConnection& c) {
    return std::tuple(c.uid() == of, c.ended() || !c.CanBeReached(), c.unanswered() == 0,
                      c.quiet_polls());
  };
  const auto victim = [&] {
    return std::max_element(clients_.begin(), clients_.end(),
                            [&rank](const auto& a, const auto& b) { return rank(a) < rank(b); });
  };
  for (std::size_t k = 0; k < clients_.size() && victim()->unanswered() == 0; ++k) {
    const auto quiet = victim();
    quiet->Read(true);
    if (quiet->HasLongLine() || !Take(&*quiet, messages)) break;
  }
  const auto closed = victim();
  closed->Dismiss("too-many-clients",
                  "too many clients are connected, and it has been quiet the longest");
  clients_.erase(closed);
}

// A new client is heard at once: the next one may close it.
void OperatorSocket::Accept(std::vector<Message>* messages) {
  for (int k = 0; k < kAcceptsPerPoll; ++k) {
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) return;
    OperatorConnection client(fd, next_number_++, roles_.Judge(credentials_of_(fd)));
    if (client.peer().role == Role::kNone) {
      client.CloseWith(NotPermittedJson(client.peer(), "").dump());
      turned_away_.push_back(client.peer());
      continue;
    }
    client.Read(true);
    if (!client.HasLongLine()) Take(&client, messages);
    MakeRoomFor(client.uid(), messages);
    clients_.push_back(std::move(client));
  }
}

// The clients are in order of their numbers.
void OperatorSocket::TakeLongLine(std::vector<Message>* messages) {
  const auto has = [](const OperatorConnection& c) { return c.HasLongLine(); };
  const auto next = std::find_if(clients_.begin(), clients_.end(), [&](const auto& c) {
    return has(c) && c.number() > long_line_of_;
  });
  const auto found =
      next != clients_.end() ? next : std::find_if(clients_.begin(), clients_.end(), has);
  if (found == clients_.end()) return;
  long_line_of_ = found->number();
  Take(&*found, messages);
}

bool OperatorSocket::Take(OperatorConnection* client, std::vector<Message>* messages) {
  const int waited = client->waited_polls();
  std::optional<std::string> line = client->NextLine();
  if (line) {
    messages->push_back({.client = client->number(),
                         .line = std::move(*line),
                         .by = client->peer(),
                         .waited_polls = waited});
  }
  return line.has_value();
}

// Most periods bring nothing: one system call tells, instead of one for each client.
void OperatorSocket::LookWhatArrived() {
  arrived_.clear();
  for (const OperatorConnection& client : clients_) {
    arrived_.push_back({.fd = client.fd(), .events = POLLIN, .revents = 0});
  }
  arrived_.push_back({.fd = listener_, .events = POLLIN, .revents = 0});
  if (poll(arrived_.data(), arrived_.size(), 0) >= 0) return;
  for (pollfd& source : arrived_) source.revents = POLLIN;
}

std::vector<OperatorSocket::Message> OperatorSocket::Poll() {
  std::erase_if(clients_, [](const OperatorConnection& client) { return client.over(); });
  turned_away_.clear();
  std::vector<Message> messages;
  LookWhatArrived();
  for (std::size_t i = 0; i < clients_.size(); ++i) {
    clients_[i].Read(arrived_[i].revents != 0);
    if (!clients_[i].HasLongLine()) Take(&clients_[i], &messages);
  }
  if (arrived_.back().revents != 0) Accept(&messages);
  TakeLongLine(&messages);
  for (bool more = true; more;) {
    more = false;
    for (OperatorConnection& client : clients_) {
      if (messages.size() >= kLinesPerPoll) return messages;
      if (!client.HasLongLine()) more = Take(&client, &messages) || more;
    }
  }
  return messages;
}

bool OperatorSocket::IsThere(int client) const {
  return std::any_of(clients_.begin(), clients_.end(), [client](const OperatorConnection& c) {
    return c.number() == client && c.CanBeReached();
  });
}

void OperatorSocket::Reply(int client, const std::string& line) {
  for (OperatorConnection& c : clients_) {
    if (c.number() == client) c.Reply(line);
  }
}

}  // namespace flexarm
