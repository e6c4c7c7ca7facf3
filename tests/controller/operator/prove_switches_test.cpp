#include "controller/operator/prove_switches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "config/config.h"
#include "controller/operator/switch_proof_record.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class ProveSwitchesTest : public testing::Test {
 protected:
  ProveSwitchesTest() { latch_.Open(); }

  void Hold(LineLevels levels, SafetyState state = SafetyState::kIdle) {
    TickRecord tick{};
    tick.input.safety_state = state;
    tick.input.frame.levels = levels;
    for (int i = 0; i < 5; ++i) switches_.Take(tick);
  }

  // What a person does: every step.
  void DoAll() {
    Hold(kHealthyLevels);
    for (const ProofStep& step : kProofSteps) {
      Hold(kHealthyLevels ^ LineBit(step.line), SafetyState::kTripped);
      Hold(kHealthyLevels, SafetyState::kTripped);
    }
  }

  nlohmann::json Answer() {
    const std::optional<ClientAnswer> answer = switches_.TakeAnswer(permit_);
    if (!answer) return nullptr;
    EXPECT_EQ(answer->client, 7);
    return answer->json;
  }
  bool MayRun() const { return switches_.UnmetToRun().empty(); }

  RigConfig config_ = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil-wire.toml");
  Permit permit_{};
  RecordedJournal journal_;
  LatchFolder folder_;
  TripLatch latch_{folder_.path(), "/runs", [](bool, const std::string&) {}};
  std::int64_t unix_s_ = 1'790'000'000;
  ProveSwitches switches_{config_, &latch_, journal_.Report(), [this] { return unix_s_; }};
};

TEST_F(ProveSwitchesTest, AWiredRigRunsOnlyAfterTheWholeProof) {
  ASSERT_EQ(switches_.UnmetToRun().size(), 1U);
  EXPECT_EQ(switches_.UnmetToRun()[0].refusal, "switches-not-proved");
  EXPECT_TRUE(switches_.UnmetToRun()[0].may_override);
  switches_.Start(7, SafetyState::kIdle);
  EXPECT_EQ(switches_.Json()["step"], 1);
  EXPECT_EQ(Answer(), nullptr);
  EXPECT_FALSE(MayRun());
  DoAll();
  EXPECT_EQ(Answer()["ok"], true);
  EXPECT_EQ(Answer(), nullptr) << "once";
  EXPECT_TRUE(MayRun());
  EXPECT_EQ(switches_.Json()["proved"], true);
  EXPECT_EQ(switches_.Json()["step"], nullptr);
}

TEST_F(ProveSwitchesTest, TheProofOutlivesTheDaemonAndExpires) {
  switches_.Start(7, SafetyState::kTripped);
  DoAll();
  const ProveSwitches next(config_, &latch_, journal_.Report(), [this] { return unix_s_; });
  EXPECT_TRUE(next.UnmetToRun().empty());
  unix_s_ += static_cast<std::int64_t>(config_.safety.prove_days * 86'400) + 1;
  EXPECT_EQ(next.UnmetToRun().size(), 1U);
}

TEST_F(ProveSwitchesTest, ASimulatedRigNeedsNone) {
  const RigConfig simulated = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  const ProveSwitches switches(simulated, &latch_, journal_.Report());
  EXPECT_TRUE(switches.UnmetToRun().empty());
  EXPECT_EQ(switches.Json()["proved"], false);
}

TEST_F(ProveSwitchesTest, NeedsAnOpenRelayFromBeginningToEnd) {
  for (const SafetyState state :
       {SafetyState::kArmed, SafetyState::kRunning, SafetyState::kStopping, SafetyState::kStarting,
        SafetyState::kDisarming, SafetyState::kFaultStopping, SafetyState::kTestingPump,
        SafetyState::kTestingRelay, SafetyState::kTestingPower}) {
    EXPECT_THAT(MessageOf<RejectedError>([&] { switches_.Start(7, state); }),
                HasSubstr("flexarm disarm"));
  }
  switches_.Start(7, SafetyState::kIdle);
  Hold(kHealthyLevels);
  Hold(kHealthyLevels, SafetyState::kArmed);
  EXPECT_THAT(Answer().dump(), HasSubstr("was armed during the proof"));
  DoAll();
  EXPECT_EQ(Answer(), nullptr) << "it has ended";
  EXPECT_FALSE(MayRun());
}

TEST_F(ProveSwitchesTest, OneProofAtATime) {
  switches_.Start(7, SafetyState::kIdle);
  EXPECT_THAT(MessageOf<RejectedError>([&] { switches_.Start(8, SafetyState::kIdle); }),
              HasSubstr("under way"));
}

TEST_F(ProveSwitchesTest, AProofThatCannotBeKeptIsNone) {
  switches_.Start(7, SafetyState::kIdle);
  {
    const FullDisk full;
    DoAll();
  }
  const nlohmann::json answer = Answer();
  EXPECT_EQ(answer["ok"], false);
  EXPECT_THAT(answer.dump(), HasSubstr("cannot be kept"));
  EXPECT_FALSE(MayRun());
}

TEST_F(ProveSwitchesTest, AFileThatCannotBeReadIsNoProof) {
  folder_.Put(ProveSwitches::kFile, "{}");
  ASSERT_EQ(switches_.UnmetToRun().size(), 1U);
  EXPECT_THAT(switches_.UnmetToRun()[0].found, HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace flexarm
