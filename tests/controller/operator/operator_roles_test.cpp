#include "controller/operator/operator_roles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/controller/operator/peers.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

const OperatorRoles kRoles = RolesInTests();

Role RoleOf(uid_t uid, std::vector<gid_t> groups) {
  return kRoles.Judge({.uid = uid, .pid = 7, .groups = std::move(groups)}).role;
}

TEST(OperatorRoles, RootTheDaemonsUserAndTheGroupOperate) {
  EXPECT_EQ(RoleOf(0, {}), Role::kOperate);
  EXPECT_EQ(RoleOf(250, {250}), Role::kOperate);
  EXPECT_EQ(RoleOf(1000, {1000, kOperatorGroup}), Role::kOperate);
  EXPECT_EQ(RoleOf(1000, {kViewerGroup, kOperatorGroup}), Role::kOperate) << "the more";
}

TEST(OperatorRoles, TheGroupOfViewersViewsAndAllOthersHaveNoRole) {
  EXPECT_EQ(RoleOf(1000, {1000, kViewerGroup}), Role::kView);
  EXPECT_EQ(RoleOf(1000, {1000, 250}), Role::kNone) << "the daemon's number is no group's";
  EXPECT_EQ(RoleOf(1000, {}), Role::kNone);
  EXPECT_EQ(kRoles.Judge(Credentials{}).role, Role::kNone) << "not known";
}

TEST(OperatorRoles, AGroupThatIsNotThereHasNoMembers) {
  const OperatorRoles roles({.own = 250, .operators = {}, .viewers = {}, .account_name = [](uid_t) {
                               return std::string("x");
                             }});
  EXPECT_EQ(roles.Judge({.uid = 1000, .pid = 1, .groups = {0, kOperatorGroup}}).role, Role::kNone);
  EXPECT_EQ(roles.Judge({.uid = 250, .pid = 1, .groups = {}}).role, Role::kOperate);
}

TEST(OperatorRoles, AViewerMaySeeAndStopOnly) {
  for (const char* name : {"status", "stop"}) {
    EXPECT_TRUE(Permits(Role::kView, name)) << name;
    EXPECT_FALSE(Permits(Role::kNone, name)) << name;
  }
  for (const char* name : {"arm", "run", "disarm", "reset", "tare", "zero", "calibrate", "pluck",
                           "home", "prove-switches", "sim", "no-such"}) {
    EXPECT_FALSE(Permits(Role::kView, name)) << name;
    EXPECT_TRUE(Permits(Role::kOperate, name)) << name;
  }
}

TEST(OperatorRoles, ARefusalSaysWhoAskedAndWhatToDo) {
  const Peer viewer = kRoles.Judge({.uid = 1000, .pid = 7, .groups = {kViewerGroup}});
  const nlohmann::json answer = NotPermittedJson(viewer, "arm");
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["refusal"], "not-permitted");
  EXPECT_EQ(answer["command"], "arm");
  EXPECT_EQ(answer["by"], nlohmann::json({{"name", "u1000"}, {"uid", 1000}, {"pid", 7}}));
  EXPECT_EQ(answer["error"], "u1000 may see the status of the arm and stop it, nothing else");
  const nlohmann::json outsider = NotPermittedJson(kRoles.Judge({.uid = 9, .pid = 7}), "");
  EXPECT_EQ(outsider["error"], "u9 may not operate the arm");
  EXPECT_THAT(outsider.value("remedy", ""), HasSubstr("flexarm-view"));
  EXPECT_FALSE(outsider.contains("command"));
}

TEST(Peer, IsNamedWithItsNumbers) {
  const Peer peer{.name = "alice", .uid = 1000, .pid = 4711, .role = Role::kOperate};
  EXPECT_EQ(PeerText(peer), "alice (uid 1000, pid 4711)");
}

}  // namespace
}  // namespace flexarm
