// Reduced limits (safety.reduced): what is planned, what the gate lets through, what trips.

#include <gmock/gmock.h>

#include <cmath>

#include "model/units.h"
#include "tests/controller/operator/operator_session.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class ReducedLimits : public OperatorSession {
 protected:
  Json Set(const char* which) { return Ask(Json{{"command", "limits"}, {"limits", which}}); }
  Json Limits() { return Ask("status")["limits"]; }
  Json Move(double to_deg, double duration_s) {
    const std::string toml =
        "name = \"m\"\n[[move]]\nstart_s = 0.0\nduration_s = " + std::to_string(duration_s) +
        "\nto_deg = [" + std::to_string(to_deg) + ", 0.0]\n";
    return Ask(Json{{"command", "run"}, {"experiment", toml}}, kPlan_s);
  }
  void MoveAndDisarm(double to_deg) {
    ASSERT_EQ(Ask("arm")["ok"], true);
    ASSERT_EQ(Move(to_deg, 3.0)["ok"], true);
    ASSERT_TRUE(ComesTo("Armed", 6.0));
    ASSERT_EQ(Ask("disarm")["ok"], true);
    ASSERT_TRUE(ComesTo("Idle"));
  }
};

// The shipped limits: 90 deg, 30 and 6 N m, 8 and 10 rad/s.
TEST_F(ReducedLimits, HoldFromTheStartUntilTheyAreLifted) {
  StartAtRest({"safety.reduced=true", "safety.reduced_angle=0.2"});
  EXPECT_EQ(Limits()["reduced"], true);
  EXPECT_EQ(Limits()["angle_deg"], Json({18.0, 18.0}));
  EXPECT_EQ(Limits()["torque_nm"], Json({15.0, 3.0}));
  EXPECT_EQ(Limits()["hub_rate_rad_s"], Json({2.0, 2.5}));
  ASSERT_EQ(Ask("arm")["ok"], true);
  const Json refused = Move(25.0, 3.0);
  EXPECT_EQ(refused["refusal"], "experiment-refused");
  EXPECT_THAT(refused.value("error", ""), HasSubstr("18"));
  EXPECT_EQ(Set("full")["refusal"], "wrong-state") << "not while it is armed";
  EXPECT_EQ(Move(15.0, 3.0)["ok"], true);
  EXPECT_TRUE(ComesTo("Armed", 6.0));
  ASSERT_EQ(Ask("disarm")["ok"], true);
  ASSERT_TRUE(ComesTo("Idle"));
  EXPECT_EQ(Set("full")["ok"], true);
  Run(0.1);
  EXPECT_EQ(Limits()["reduced"], false);
  EXPECT_EQ(Limits()["angle_deg"], Json({90.0, 90.0}));
  ASSERT_EQ(Ask("arm")["ok"], true);
  EXPECT_EQ(Move(25.0, 3.0)["ok"], true);
  EXPECT_TRUE(ComesTo("Armed", 6.0));
}

TEST_F(ReducedLimits, LeaveAnArmAloneThatIsWithinThem) {
  StartAtRest();
  MoveAndDisarm(25.0);
  EXPECT_EQ(Set("reduced")["ok"], true);
  Run(0.2);
  EXPECT_EQ(State(), "Idle") << "25 deg are within half of 90";
  EXPECT_EQ(Limits()["reduced"], true);
}

TEST_F(ReducedLimits, OfAnAngleThatTheArmHasPassedTripItAtOnce) {
  StartAtRest({"safety.reduced_angle=0.2"});
  MoveAndDisarm(25.0);
  EXPECT_EQ(Set("reduced")["ok"], true);
  EXPECT_TRUE(ComesTo("Tripped"));
  const Json status = Ask("status");
  EXPECT_EQ(status["trip"]["name"], "soft-limit-1") << status["trip"];
  EXPECT_NEAR(status["trip"]["limit"], RadFromDeg(18.0), 1e-12) << status["trip"];
}

TEST_F(ReducedLimits, AreFullOrReducedAndNothingElse) {
  StartAtRest();
  EXPECT_EQ(Set("half")["refusal"], "bad-request");
  EXPECT_EQ(Ask("limits")["refusal"], "bad-request");
  EXPECT_EQ(Set("reduced")["limits"], "reduced");
  EXPECT_EQ(Set("full")["limits"], "full");
}

// No torque beyond the reduced limit leaves the gate, whatever the law asks for.
TEST_F(ReducedLimits, BoundTheTorque) {
  StartAtRest({"safety.reduced=true", "safety.reduced_torque=0.05", "safety.reduced_rate=1.0"});
  ASSERT_EQ(Ask("arm")["ok"], true);
  Move(20.0, 6.0);
  double largest_nm = 0.0;
  for (int k = 0; k < 350; ++k) {
    Run(kPeriod_s);
    TickRecord record{};
    while (stack_->tick_records().Pop(&record)) {
      largest_nm = std::max(largest_nm, std::fabs(record.input.applied_torque_nm[0]));
      ASSERT_EQ(record.input.reduced, 1) << "the log says so";
    }
  }
  EXPECT_LE(largest_nm, 1.5 + 1e-12);
  EXPECT_GT(largest_nm, 0.3) << "the test is inconclusive";
}

}  // namespace
}  // namespace flexarm
