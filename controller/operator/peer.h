#pragma once

#include <sys/types.h>

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace flexarm {

/// What a user of the computer may ask of the daemon.
enum class Role : std::uint8_t {
  kNone,     ///< nothing
  kView,     ///< status, and stop
  kOperate,  ///< everything
};

/// The user at the other end of a connection, when it connected.
struct Peer {
  std::string name;  ///< of the account; "uid 1234": this computer has no such account
  uid_t uid;
  pid_t pid;
  Role role;
};

/// Key "by" of an answer and of an event: {"name", "uid", "pid"}.
nlohmann::json PeerJson(const Peer& peer);

/// For the journal: "alice (uid 1000, pid 4711)".
std::string PeerText(const Peer& peer);

}  // namespace flexarm
