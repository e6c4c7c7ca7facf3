#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <tuple>

#include "tests/controller/wired/hostile_rig.h"

// A node that loses its power, in every state: the angles that it, or the configuration that
// follows, has cost are unknown afterwards, and no experiment runs before `zero`.

namespace flexarm {
namespace {

using testing::HasSubstr;

class LostCountBench : public HostileBus {
 protected:
  void Start(SafetyState state) {
    if (state == SafetyState::kRunning) return StartRun();
    ASSERT_NO_FATAL_FAILURE(StartIdle());
    if (state == SafetyState::kIdle) return;
    ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
    rig_->RunFor(200 * kMs);
    ASSERT_EQ(rig_->permit().state, SafetyState::kArmed);
  }

  // The world shows where the encoders stand, not what they count.
  void PowerCycle(CanopenRole role) {
    rig_->world->node(role).PowerCycle();
    rig_->looks_at_counters = false;
  }
  Commissioner& commissioner() { return rig_->commissioner; }
  double angle_rad(std::size_t counter) { return rig_->last.output.angle_rad[counter]; }

  nlohmann::json Zero(const std::array<double, 2>& angle_deg) {
    rig_->Disarm();
    commissioner().Start({{"command", "zero"}, {"angle_deg", angle_deg}}, rig_->permit().state);
    std::optional<nlohmann::json> answer;
    rig_->RunUntil(4000 * kMs, [&] {
      if (!answer) answer = commissioner().TakeAnswer();
      return answer.has_value();
    });
    rig_->RunFor(700 * kMs);  // the new calibration resets the loop, which is at rest again then
    return answer.value_or(nlohmann::json{});
  }

  void ExpectRunsAfterZero(const std::array<double, 2>& angle_deg) {
    const nlohmann::json answer = Zero(angle_deg);
    EXPECT_TRUE(answer.value("ok", false)) << answer;
    EXPECT_EQ(commissioner().WhyNoRun(), "");
    EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone) << CauseNames(rig_->present);
    EXPECT_EQ(rig_->Ask(RequestKind::kRun), Refusal::kNone) << CauseNames(rig_->present);
  }
};

using NodeInState = std::tuple<CanopenRole, SafetyState>;

class LostCount : public LostCountBench, public testing::WithParamInterface<NodeInState> {};

std::string NameOfNode(const testing::TestParamInfo<NodeInState>& tested) {
  return std::string(ToString(std::get<0>(tested.param))) + ToString(std::get<1>(tested.param));
}

INSTANTIATE_TEST_SUITE_P(Of, LostCount,
                         testing::Combine(testing::Values(CanopenRole::kDrive1,
                                                          CanopenRole::kDrive2, CanopenRole::kHub1,
                                                          CanopenRole::kHub2, CanopenRole::kRotor1,
                                                          CanopenRole::kRotor2),
                                          testing::Values(SafetyState::kIdle, SafetyState::kArmed,
                                                          SafetyState::kRunning)),
                         NameOfNode);

TEST_P(LostCount, IsKnownAndRefusesRunsUntilZero) {
  const auto [role, state] = GetParam();
  ASSERT_NO_FATAL_FAILURE(Start(state));
  ASSERT_EQ(commissioner().WhyNoRun(), "");
  PowerCycle(role);
  ExpectNamed(ToString(role));
  ExpectArmable([] {});
  EXPECT_EQ(commissioner().angles().unknown(), 0b11) << "every node was configured again";
  EXPECT_THAT(commissioner().WhyNoRun(), HasSubstr("The angle of joint 1 is unknown: its encoder"));
  EXPECT_THAT(commissioner().WhyNoRun(), HasSubstr("Run `flexarm zero` or `flexarm home` first."));
  ExpectRunsAfterZero({0.0, 0.0});
}

TEST_F(LostCountBench, EncodersThatLosePowerAtThirtyDegreesRefuseTheRunUntilZero) {
  ASSERT_NO_FATAL_FAILURE(StartRun());
  ASSERT_GT(std::fabs(angle_rad(0)), 0.4) << "the first move of the experiment is done";
  for (const CanopenRole role :
       {CanopenRole::kHub1, CanopenRole::kHub2, CanopenRole::kRotor1, CanopenRole::kRotor2}) {
    PowerCycle(role);
  }
  ExpectNamed("vcan0: node 1");
  ExpectArmable([] {});
  EXPECT_LT(std::fabs(angle_rad(0)), 0.05) << "so the loop sees an arm at zero";
  const std::array<double, 2> truth_rad = rig_->world->hub_angle_rad();
  EXPECT_GT(std::fabs(truth_rad[0]), 0.3);
  EXPECT_THAT(commissioner().WhyNoRun(), HasSubstr("The angle of joint 1 is unknown"));
  ExpectRunsAfterZero({truth_rad[0] * 180.0 / M_PI, truth_rad[1] * 180.0 / M_PI});
}

// An unknown joint begins at 0: hub and rotor agree again, and no soft limit stands in the way of
// the reset and of `zero`.
TEST_F(LostCountBench, AHubAndItsRotorThatDisagreeDoNotPreventTheReset) {
  ASSERT_NO_FATAL_FAILURE(StartRun());
  const double before_rad = angle_rad(0);
  ASSERT_GT(std::fabs(before_rad), 0.4);
  PowerCycle(CanopenRole::kHub1);  // its rotor keeps its count
  ExpectNamed("hub1");
  ExpectArmable([] {});
  EXPECT_LT(std::fabs(angle_rad(0)), 0.05);
  EXPECT_LT(std::fabs(angle_rad(2)), 0.05);
}

// `zero` measures for a while: what it measured before the loss is worth nothing.
TEST_F(LostCountBench, ALossDuringZeroEndsTheCommand) {
  ASSERT_NO_FATAL_FAILURE(StartIdle());
  commissioner().Start({{"command", "zero"}}, rig_->permit().state);
  rig_->RunFor(100 * kMs);
  PowerCycle(CanopenRole::kHub2);
  rig_->RunFor(100 * kMs);
  const std::optional<nlohmann::json> answer = commissioner().TakeAnswer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_FALSE((*answer)["ok"]);
  EXPECT_THAT((*answer)["error"].get<std::string>(), HasSubstr("The angle of joint 2 is unknown"));
  EXPECT_NE(commissioner().angles().unknown() & 0b10, 0);
}

TEST_F(LostCountBench, AnAmplifierThatComesBackCostsNoAngle) {
  ASSERT_NO_FATAL_FAILURE(StartRun());
  Behave(WireFault::kAway);
  ExpectNamed("strain-amplifier-1");
  ExpectArmable([this] { Behave(WireFault::kNone); });
  EXPECT_EQ(commissioner().WhyNoRun(), "");
}

}  // namespace
}  // namespace flexarm
