#pragma once

#include <functional>
#include <optional>
#include <string>

#include "controller/operator/credentials.h"
#include "controller/operator/peer.h"

namespace flexarm {

/// Decides what a process may ask of the daemon.
///
/// | user | role |
/// |---|---|
/// | root, the daemon's own user, members of the group `flexarm` | kOperate |
/// | members of the group `flexarm-view` | kView |
/// | others, and a process whose credentials are not known | kNone |
///
/// A group counts that the process had when it connected. Not real-time safe. Thread: operator.
class OperatorRoles {
 public:
  static constexpr const char* kOperators = "flexarm";
  static constexpr const char* kViewers = "flexarm-view";

  /// Who is who on a computer.
  struct Computer {
    uid_t own;                                       ///< the daemon's user
    std::optional<gid_t> operators;                  ///< empty: there is no such group
    std::optional<gid_t> viewers;                    ///< the same
    std::function<std::string(uid_t)> account_name;  ///< as AccountName
  };

  /// Of this computer, as it is now.
  static Computer ThisComputer();

  explicit OperatorRoles(Computer computer = ThisComputer()) : computer_(std::move(computer)) {}

  Peer Judge(const Credentials& credentials) const;

 private:
  Role RoleOf(const Credentials& credentials) const;

  Computer computer_;
};

/// Whether a role may give a command.
bool Permits(Role role, const std::string& command);

/// The answer to a command that the role of `peer` does not permit, with "refusal"
/// "not-permitted". @param command  its name; empty: not read
nlohmann::json NotPermittedJson(const Peer& peer, const std::string& command);

}  // namespace flexarm
