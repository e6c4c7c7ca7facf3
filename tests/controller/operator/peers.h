#pragma once

#include <string>

#include "controller/operator/operator_roles.h"

namespace flexarm {

// Two users who may operate the arm.
inline const Peer kAlice{.name = "alice", .uid = 1000, .pid = 11, .role = Role::kOperate};
inline const Peer kBob{.name = "bob", .uid = 1001, .pid = 12, .role = Role::kOperate};

// Groups of a computer whose daemon is user 250.
inline constexpr gid_t kOperatorGroup = 301;
inline constexpr gid_t kViewerGroup = 302;

inline OperatorRoles RolesInTests() {
  return OperatorRoles(
      {.own = 250,
       .operators = kOperatorGroup,
       .viewers = kViewerGroup,
       .account_name = [](uid_t uid) { return std::string("u").append(std::to_string(uid)); }});
}

}  // namespace flexarm
