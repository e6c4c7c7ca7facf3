#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace flexarm {

/// Of the process at the other end of a connected Unix socket, as the kernel kept them when it
/// connected: no process can claim others.
struct Credentials {
  uid_t uid = static_cast<uid_t>(-1);  ///< -1: not known
  pid_t pid = 0;
  std::vector<gid_t> groups{};  ///< its own group, and the supplementary ones
};

/// Reads the credentials of the peer of a connected socket.
using CredentialsReader = std::function<Credentials(int fd)>;

/// The kernel's: SO_PEERCRED and SO_PEERGROUPS. What it does not tell is not known. Never waits.
Credentials CredentialsOf(int fd);

// Accounts of the computer, from /etc/passwd and /etc/group alone: a directory service may take
// half a minute to answer, and a `stop` must not wait for it.

/// The name of an account; "uid 1234": there is no such account.
std::string AccountName(uid_t uid);

/// The number of a group; empty: there is no such group.
std::optional<gid_t> GroupNumber(const std::string& name);

}  // namespace flexarm
