// Whether a law can run an experiment, as `run` and `simulate` judge it before it runs.

#include "controller/host/run_judge.h"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "controller/operator/run_command.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::array<double, 2> kHome = {0.0, 0.0};

// `sobel` trips at both ends of the payloads (docs/laws.md).
Experiment TipPositions(std::vector<ControllerKind> laws = {}) {
  Experiment experiment = ShippedExperiment("tip-positions");
  experiment.laws = std::move(laws);
  experiment.payload_kg = {0.0, 1.0};
  return experiment;
}

class RunJudgeTest : public testing::Test {
 protected:
  RunJudge JudgeOf(const RigConfig& config) {
    return {config, [this](const RigConfig& rig, const std::string& law) {
              ++tried_;
              return WithLaw(rig, law);
            }};
  }

  int tried_ = 0;  // laws
};

TEST_F(RunJudgeTest, AnExperimentThatStatesNothingIsNotJudged) {
  Experiment experiment = ShippedExperiment("square-30deg");
  experiment.laws = {};
  experiment.payload_kg = {};
  experiment.move.push_back({.start_s = -1.0});  // a simulation would refuse it
  EXPECT_FALSE(JudgeOf(ShippedRig()).Judge(experiment, kHome));
}

TEST_F(RunJudgeTest, ALawThatIsNotOfTheExperimentIsRefusedAndOneThatWorksIsNamed) {
  Experiment experiment = ShippedExperiment("waypoints");
  experiment.laws = {ControllerKind::kRecedingHorizon, ControllerKind::kGainScheduled};
  const auto objection = JudgeOf(ShippedRig()).Judge(experiment, kHome);
  ASSERT_TRUE(objection);
  EXPECT_EQ(objection->refusal, "law-not-for-experiment");
  EXPECT_EQ(objection->name, kExperimentCondition);
  EXPECT_TRUE(objection->may_override);
  EXPECT_THAT(objection->found,
              AllOf(HasSubstr("\"sobel\""), HasSubstr("\"receding-horizon\", \"gain-scheduled\"")));
  EXPECT_THAT(objection->remedy, HasSubstr("controller.name = \"receding-horizon\" completes it"));
  EXPECT_FALSE(JudgeOf(ShippedRig({"controller.name=gain-scheduled"})).Judge(experiment, kHome));
}

TEST_F(RunJudgeTest, APredictedTripIsRefusedWithItsValuesAndALawThatWorks) {
  const auto objection = JudgeOf(ShippedRig()).Judge(TipPositions(), kHome);
  ASSERT_TRUE(objection);
  EXPECT_EQ(objection->refusal, "predicted-trip");
  EXPECT_THAT(objection->found,
              AllOf(HasSubstr("controller.name = \"sobel\""), HasSubstr("with 0 kg trips by "),
                    HasSubstr("limit"), HasSubstr(" s: ")));
  EXPECT_THAT(objection->remedy, HasSubstr("\"gain-scheduled\" completes it"));
  EXPECT_FALSE(
      JudgeOf(ShippedRig({"controller.name=gain-scheduled"})).Judge(TipPositions(), kHome));
}

TEST_F(RunJudgeTest, TheMiddlePayloadIsPredictedToo) {
  Experiment experiment = TipPositions();
  experiment.payload_kg = {0.1, 0.1};
  EXPECT_FALSE(JudgeOf(ShippedRig()).Judge(experiment, kHome)) << "completes with 0.1 kg";
  experiment.payload_kg = {0.1, 1.0};
  const auto objection = JudgeOf(ShippedRig()).Judge(experiment, kHome);
  ASSERT_TRUE(objection);
  EXPECT_THAT(objection->found, HasSubstr("with 0.55 kg"));
}

TEST_F(RunJudgeTest, AVerdictIsKeptForTheSameExperimentAtTheSamePlace) {
  RunJudge judge = JudgeOf(ShippedRig());
  const Experiment experiment = TipPositions({ControllerKind::kGainScheduled});
  ASSERT_TRUE(judge.Judge(experiment, kHome));
  const int tried = tried_;
  EXPECT_GT(tried, 0);
  ASSERT_TRUE(judge.Judge(experiment, {0.009, -0.009}));
  EXPECT_EQ(tried_, tried);
  ASSERT_TRUE(judge.Judge(experiment, {0.05, 0.0}));
  EXPECT_GT(tried_, tried);
  Experiment other = experiment;
  other.text += "\n";
  const int before = tried_;
  ASSERT_TRUE(judge.Judge(other, kHome));
  EXPECT_GT(tried_, before);
}

TEST_F(RunJudgeTest, ARequestedStopEndsItAndIsNotKept) {
  RunJudge judge = JudgeOf(ShippedRig({"controller.name=gain-scheduled"}));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(judge.Judge(TipPositions(), kHome, stop.get_token()), RejectedError);
  EXPECT_FALSE(judge.Judge(TipPositions(), kHome));
}

// A real rig can run none of them, and `kill` would end the program that asks.
TEST_F(RunJudgeTest, EventsOfTheSimulatedRigTakeNoPartButThoseOfThePayload) {
  Experiment experiment = ShippedExperiment("waypoints");
  experiment.payload_kg = {0.0, 0.0};
  SimEvent kill = PayloadEvent(1.0, 0.0);
  kill.payload_kg.reset();
  kill.kill = true;
  SimEvent press = kill;
  press.kill = false;
  press.line = Line::kEmergencyStop;
  experiment.sim_event = {press, kill};
  EXPECT_FALSE(JudgeOf(ShippedRig()).Judge(experiment, kHome));
  experiment = TipPositions();
  experiment.payload_kg = {0.1, 0.1};
  experiment.text += "# with a load\n";
  experiment.sim_event = {PayloadEvent(0.0, 1.0)};
  EXPECT_TRUE(JudgeOf(ShippedRig()).Judge(experiment, kHome));
}

// Payloads of an experiment are for any rig: its own limits them.
TEST_F(RunJudgeTest, ThePayloadsOfTheRigLimitThoseOfTheExperiment) {
  const RigConfig light = ShippedRig({"controller.payload_range_kg=[0.1, 0.2]"});
  Experiment experiment = TipPositions();
  EXPECT_EQ(PayloadsOf(experiment, light), (std::array{0.1, 0.2}));
  experiment.payload_kg = {0.0, 0.1};
  EXPECT_FALSE(JudgeOf(light).Judge(experiment, kHome)) << "with 0.1 kg alone";
  experiment.payload_kg = {0.5, 1.0};
  const auto objection = JudgeOf(light).Judge(experiment, kHome);
  ASSERT_TRUE(objection);
  EXPECT_EQ(objection->refusal, "payload-not-for-rig");
  EXPECT_THAT(objection->found, AllOf(HasSubstr("0.5 to 1 kg"), HasSubstr("0.1 to 0.2 kg")));
}

TEST_F(RunJudgeTest, APayloadOutsideTheRangeIsRefused) {
  Experiment experiment = TipPositions();
  experiment.payload_kg = {0.05, 0.5};
  const RigConfig rig = ShippedRig();
  EXPECT_FALSE(PayloadObjection(experiment, rig, 0.05));
  EXPECT_FALSE(PayloadObjection(experiment, rig, 0.5));
  for (const double kg : {0.0, 0.501, 1.0}) {
    const auto objection = PayloadObjection(experiment, rig, kg);
    ASSERT_TRUE(objection) << kg;
    EXPECT_EQ(objection->refusal, "payload-not-for-experiment");
    EXPECT_THAT(objection->found, HasSubstr("0.05 to 0.5 kg (payload_kg)"));
  }
  experiment.payload_kg.reset();
  EXPECT_FALSE(PayloadObjection(experiment, rig, 50.0));
}

TEST_F(RunJudgeTest, WhereNoLawWorksTheReasonIsNamed) {
  const RigConfig config = ShippedRig({"limits.strain_limit=[2e-4, 2e-4]"});
  Experiment experiment = ShippedExperiment("square-30deg");
  experiment.laws = {ControllerKind::kPd, ControllerKind::kGainScheduled};
  const auto objection = JudgeOf(config).Judge(experiment, kHome);
  ASSERT_TRUE(objection);
  EXPECT_THAT(objection->remedy, AllOf(HasSubstr("no other law completes it"), HasSubstr("pd: ")));
}

// From where the arm stands, with a plan from there.
TEST(SimulationFromAnyPlace, TheArmStartsThereAndTheMovesEndOnTheirTargets) {
  for (const char* law : {"sobel", "gain-scheduled"}) {
    const SimulationResult run =
        Simulate({.config = ShippedRig({std::string("controller.name=") + law}),
                  .experiment = ShippedExperiment("waypoints"),
                  .payload_kg = 0.1,
                  .log = {},
                  .start_rad = {-0.6, 0.9}});
    EXPECT_TRUE(run.completed) << law;
    for (const double error_deg : run.metrics.joint_final_error_deg)
      EXPECT_LT(error_deg, 1.0) << law;
  }
}

TEST(SimulationFromAnyPlace, AStartBeyondTheSoftLimitTripsByIt) {
  EXPECT_THROW(Simulate({.config = ShippedRig(),
                         .experiment = ShippedExperiment("waypoints"),
                         .payload_kg = 0.1,
                         .log = {},
                         .start_rad = {1.6, 0.0}}),
               std::runtime_error);
}

}  // namespace
}  // namespace flexarm
