#include "controller/operator/operator_roles.h"

#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace flexarm {
namespace {

bool Has(const std::vector<gid_t>& groups, const std::optional<gid_t>& wanted) {
  return wanted && std::find(groups.begin(), groups.end(), *wanted) != groups.end();
}

}  // namespace

OperatorRoles::Computer OperatorRoles::ThisComputer() {
  return {.own = geteuid(),
          .operators = GroupNumber(kOperators),
          .viewers = GroupNumber(kViewers),
          .account_name = AccountName};
}

Role OperatorRoles::RoleOf(const Credentials& credentials) const {
  if (credentials.uid == static_cast<uid_t>(-1)) return Role::kNone;
  if (credentials.uid == 0 || credentials.uid == computer_.own) return Role::kOperate;
  if (Has(credentials.groups, computer_.operators)) return Role::kOperate;
  return Has(credentials.groups, computer_.viewers) ? Role::kView : Role::kNone;
}

Peer OperatorRoles::Judge(const Credentials& credentials) const {
  return {.name = computer_.account_name(credentials.uid),
          .uid = credentials.uid,
          .pid = credentials.pid,
          .role = RoleOf(credentials)};
}

bool Permits(Role role, const std::string& command) {
  switch (role) {
    case Role::kNone:
      return false;
    case Role::kView:
      return command == "status" || command == "stop";
    case Role::kOperate:
      return true;
  }
  return false;
}

nlohmann::json NotPermittedJson(const Peer& peer, const std::string& command) {
  const std::string groups = std::string("be a member of the group ") + OperatorRoles::kOperators;
  const bool may_view = peer.role == Role::kView;
  nlohmann::json json{
      {"ok", false},
      {"refusal", "not-permitted"},
      {"error", may_view ? peer.name + " may see the status of the arm and stop it, nothing else"
                         : peer.name + " may not operate the arm"},
      {"remedy", groups +
                     (may_view ? ""
                               : std::string(", or of ") + OperatorRoles::kViewers +
                                     " to see its status and to stop it") +
                     " (adduser USER GROUP, and log in again)"},
      {"by", PeerJson(peer)}};
  if (!command.empty()) json["command"] = command;
  return json;
}

}  // namespace flexarm
