// Commissioning of the simulated arm by the whole stack, in lock step.

#include "controller/commissioning/commissioner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/realtime/lockstep_executor.h"
#include "controller/tasks/simulated_stack.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/commissioning/rest_ticks.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr std::int64_t kLookNs = 20'000'000;

RigConfig CommissionedRig(std::vector<std::string> overrides) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string folder = testing::TempDir() + "commissioner_" + test->name();
  std::filesystem::remove_all(folder);
  overrides.push_back("log.directory='" + folder + "'");
  return ShippedRig(overrides);
}

// The stack with an operator who only sends commissioning commands.
class Bench {
 public:
  explicit Bench(const std::vector<std::string>& overrides = {})
      : config_(CommissionedRig(overrides)),
        stack_(config_, ShippedDesign(), config_.arm.payload_mass_kg),
        commissioner_(config_) {
    for (Task* task : stack_.tasks()) executor_.Add(*task);
    Run(1.0);
  }

  void Run(double seconds) {
    const std::int64_t end_ns = now_ns_ + std::llround(seconds * 1e9);
    while (now_ns_ < end_ns) Look();
  }

  /// @returns the number of the request
  std::uint32_t Ask(RequestKind kind, const RunOrder& run = {}) {
    stack_.requests().Push({.kind = kind, .number = ++requests_, .not_before_ns = 0, .run = run});
    return requests_;
  }
  void Arm() {
    Ask(RequestKind::kArm);
    Run(0.04);
  }

  void Begin(const Json& command) {
    CommissioningMotion motion = commissioner_.Start(command, state(), stack_.reduced());
    if (motion.planned == nullptr) return;
    motions_.push_back(std::move(motion.planned));
    commissioner_.Expect(
        Ask(RequestKind::kRun, {.experiment = motions_.back().get(), .may_open = motion.may_open}));
    Run(0.04);
  }

  /// Starts the command and runs until its answer.
  Json Do(const Json& command, double within_s = 40.0) {
    Begin(command);
    return Answer(within_s);
  }

  Json Answer(double within_s) {
    const std::int64_t end_ns = now_ns_ + std::llround(within_s * 1e9);
    while (now_ns_ < end_ns) {
      Look();
      if (const std::optional<Json> answer = commissioner_.TakeAnswer()) {
        stack_.Calibrate(commissioner_.calibration());
        Run(1.0);
        return *answer;
      }
    }
    return {{"ok", false}, {"error", "no answer"}};
  }

  SafetyState state() { return stack_.operator_permits().Read().Newest().value.state; }
  TripCause trip() { return stack_.operator_permits().Read().Newest().value.cause; }
  double angle_deg(std::size_t joint) const { return last_.output.angle_rad[joint] * 180.0 / M_PI; }
  double truth_deg(std::size_t joint) const {
    return truth_.truth.hub_angle_rad[joint] * 180.0 / M_PI;
  }
  Commissioner& commissioner() { return commissioner_; }
  const RigConfig& config() const { return config_; }
  void Press(Line line, int level) { stack_.Press({.line = line, .level = level}); }
  /// `later_ns` after now the run of `motion` is asked for, and 2 ms later, when it has been
  /// granted, the emergency stop is pressed.
  void StopAsSoonAsGranted(const CommissioningMotion& motion, std::int64_t later_ns) {
    executor_.RunUntil(now_ns_ + later_ns);
    commissioner_.Expect(
        Ask(RequestKind::kRun, {.experiment = motion.planned.get(), .may_open = motion.may_open}));
    executor_.RunUntil(now_ns_ + later_ns + 2'000'000);
    Press(Line::kEmergencyStop, 0);
  }
  void PressFor(Line line, std::int64_t duration_ns) {
    Press(line, 0);
    executor_.RunUntil(now_ns_ + duration_ns);
    Press(line, 1);
  }
  /// Largest torque that has acted.
  double most_torque_nm(std::size_t joint) const { return most_torque_nm_[joint]; }

 private:
  void Look() {
    now_ns_ += kLookNs;
    executor_.RunUntil(now_ns_);
    while (stack_.operator_ticks().Pop(&last_)) {
      commissioner_.Take(last_);
      for (std::size_t i = 0; i < 2; ++i) {
        most_torque_nm_[i] =
            std::max(most_torque_nm_[i], std::fabs(last_.input.applied_torque_nm[i]));
      }
    }
    RequestAnswer answer{};
    while (stack_.answers().Pop(&answer)) {
      const bool granted = answer.kind == RequestKind::kRun && answer.refusal == Refusal::kNone;
      if (granted) commissioner_.Granted(answer.number, now_ns_);
    }
    while (stack_.truth_records()->Pop(&truth_)) {
    }
  }

  RigConfig config_;
  SimulatedStack stack_;
  Commissioner commissioner_;
  LockstepExecutor executor_;
  std::vector<std::unique_ptr<PlannedExperiment>> motions_;
  std::uint32_t requests_ = 0;
  TickRecord last_{};
  TruthRecord truth_{};
  std::array<double, 2> most_torque_nm_{};
  std::int64_t now_ns_ = 0;
};

// Switches within the travel of a search, with the soft limits inside them.
const std::vector<std::string> kNearSwitches = {
    "sim.switch_angle_deg=[25.0, 25.0]", "limits.soft_angle_deg=[20.0, 20.0]",
    "commissioning.switch_angle_deg=[-125.0, 25.0, -25.0, 25.0]",
    "commissioning.home_back_deg=10.0"};

TEST(Commissioner, TareRemovesAndSavesTheAmplifierOffsets) {
  Bench bench;
  const Json answer = bench.Do({{"command", "tare"}});
  EXPECT_TRUE(answer["ok"]) << answer;
  EXPECT_EQ(answer["strain"].size(), 20u);
  const Commissioner again(bench.config());
  EXPECT_EQ(again.calibration(), bench.commissioner().calibration());
}

TEST(Commissioner, ZeroSetsTheAnglesOfTheCommand) {
  Bench bench;
  const Json answer = bench.Do({{"command", "zero"}, {"angle_deg", {10.0, -15.0}}});
  EXPECT_TRUE(answer["ok"]) << answer;
  EXPECT_NEAR(bench.angle_deg(0), 10.0, 360.0 / 2540.0);
  EXPECT_NEAR(bench.angle_deg(1), -15.0, 360.0 / 2540.0);
}

TEST(Commissioner, PluckProvesTheWiringAndEndsArmed) {
  Bench bench({"commissioning.prove_before_run=true"});
  EXPECT_THAT(bench.commissioner().WhyNoRun(), HasSubstr("flexarm pluck"));
  bench.Arm();
  const Json answer = bench.Do({{"command", "pluck"}});
  EXPECT_TRUE(answer["ok"]) << answer;
  EXPECT_TRUE(answer["passed"]);
  EXPECT_EQ(bench.state(), SafetyState::kArmed);
  EXPECT_EQ(bench.commissioner().WhyNoRun(), "");
}

TEST(Commissioner, HomingFindsTheSwitchAndTheAngle) {
  Bench bench(kNearSwitches);
  bench.Arm();
  const Json answer = bench.Do({{"command", "home"}, {"joint", 2}, {"side", "high"}});
  EXPECT_TRUE(answer["ok"]) << answer;
  EXPECT_EQ(bench.state(), SafetyState::kArmed);
  EXPECT_NEAR(answer["contact_before_deg"].get<double>(), 25.0, 0.5);
  EXPECT_NEAR(bench.truth_deg(1), 15.0, 2.0) << "back off the switch";
  // Tolerance: the motion in one sample at 5 deg/s, and one count.
  EXPECT_NEAR(bench.angle_deg(1), bench.truth_deg(1), 0.3);
}

TEST(Commissioner, HomingFindsAnUnknownAngle) {
  std::vector<std::string> overrides = kNearSwitches;
  overrides.push_back("commissioning.angles_at_start=lost");
  Bench bench(overrides);
  EXPECT_THAT(bench.commissioner().WhyNoRun(), HasSubstr("angle of joint 1"));
  bench.Arm();
  // The config has the low switch of joint 1 at -125 degrees, and the rig at -25.
  EXPECT_TRUE(bench.Do({{"command", "home"}, {"joint", 1}, {"side", "low"}})["ok"]);
  EXPECT_NEAR(bench.angle_deg(0), bench.truth_deg(0) - 100.0, 0.3);
  EXPECT_THAT(bench.commissioner().WhyNoRun(), HasSubstr("angle of joint 2"));
}

TEST(Commissioner, HomingReportsThatNoSwitchOpened) {
  Bench bench({"commissioning.home_travel_deg=5.0"});
  bench.Arm();
  const Json answer = bench.Do({{"command", "home"}, {"joint", 1}, {"side", "low"}});
  EXPECT_FALSE(answer["ok"]);
  EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr("limit-1-low did not open"));
  EXPECT_EQ(bench.state(), SafetyState::kArmed);
  EXPECT_EQ(bench.commissioner().calibration(), Calibration{});
}

TEST(Commissioner, HomingOntoAnotherSwitchTrips) {
  Bench bench(kNearSwitches);
  bench.Arm();
  bench.Begin({{"command", "home"}, {"joint", 1}, {"side", "low"}});
  bench.Run(1.0);
  EXPECT_EQ(bench.state(), SafetyState::kRunning);
  bench.Press(Line::kLimit2High, 0);
  bench.Run(0.02);
  EXPECT_EQ(bench.state(), SafetyState::kTripped);
  EXPECT_EQ(bench.trip(), TripCause::kLimitSwitch2High);
}

TEST(Commissioner, HomingThatStaysOnItsSwitchTrips) {
  Bench bench({"commissioning.home_back_deg=60.0", "safety.homing_contact_s=1.0"});
  bench.Arm();
  bench.Begin({{"command", "home"}, {"joint", 1}, {"side", "low"}});
  bench.Run(1.0);
  bench.Press(Line::kLimit1Low, 0);
  bench.Run(0.9);
  EXPECT_EQ(bench.state(), SafetyState::kRunning) << "on its way back";
  bench.Run(0.2);
  EXPECT_EQ(bench.state(), SafetyState::kTripped);
  EXPECT_EQ(bench.trip(), TripCause::kLimitSwitch1Low);
}

// A switch that bounces gains no time: the contact is summed.
TEST(Commissioner, HomingThatBouncesOnItsSwitchTripsAfterAsMuchContact) {
  Bench bench({"commissioning.home_back_deg=60.0", "safety.homing_contact_s=1.0"});
  bench.Arm();
  bench.Begin({{"command", "home"}, {"joint", 1}, {"side", "low"}});
  bench.Run(1.0);
  for (int i = 0; i < 9; ++i) {
    bench.Press(Line::kLimit1Low, 0);
    bench.Run(0.1);
    bench.Press(Line::kLimit1Low, 1);
    bench.Run(0.1);
  }
  EXPECT_EQ(bench.state(), SafetyState::kRunning) << "0.9 s of contact";
  bench.Press(Line::kLimit1Low, 0);
  bench.Run(0.14);
  EXPECT_EQ(bench.state(), SafetyState::kTripped);
  EXPECT_EQ(bench.trip(), TripCause::kLimitSwitch1Low);
}

// The step looks every 20 ms, the safety task every millisecond.
TEST(Commissioner, HomingSeesAContactOfAFewMilliseconds) {
  Bench bench;
  bench.Arm();
  bench.Begin({{"command", "home"}, {"joint", 1}, {"side", "low"}});
  bench.Run(1.0);
  bench.PressFor(Line::kLimit1Low, 3'000'000);
  const Json answer = bench.Answer(10.0);
  EXPECT_TRUE(answer["ok"]) << answer;
}

TEST(Commissioner, HomingHasThePermittedShareOfTheTorque) {
  Bench bench(kNearSwitches);
  bench.Arm();
  bench.Begin({{"command", "home"}, {"joint", 2}, {"side", "high"}});
  const double share = bench.config().safety.homing_torque_fraction;
  const Json answer = bench.Answer(40.0);
  EXPECT_TRUE(answer["ok"]) << answer;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LE(bench.most_torque_nm(i), share * bench.config().safety.torque_limit_nm[i]);
  }
}

// A run of another number is none of the command's, whatever it does.
TEST(Commissioner, AnotherRunIsNotItsMotion) {
  Bench bench(kNearSwitches);
  bench.Arm();
  CommissioningMotion motion = bench.commissioner().Start(
      {{"command", "home"}, {"joint", 1}, {"side", "low"}}, bench.state());
  bench.commissioner().Expect(1'000'000);  // its run is not granted
  bench.Ask(RequestKind::kRun, {.experiment = motion.planned.get(), .may_open = motion.may_open});
  EXPECT_EQ(bench.Answer(10.0)["error"], "no answer");
  EXPECT_TRUE(bench.commissioner().busy());
  EXPECT_EQ(bench.commissioner().calibration(), Calibration{});
}

// A trip between the grant and the next step, up to 20 ms later, leaves a run without a sample.
TEST(Commissioner, AMotionThatTripsBeforeItsFirstStepIsAnswered) {
  int before_it_moved = 0;
  for (std::int64_t later_ms = 0; later_ms < 20; ++later_ms) {
    Bench bench;
    bench.Arm();
    const CommissioningMotion motion = bench.commissioner().Start(
        {{"command", "home"}, {"joint", 1}, {"side", "low"}}, bench.state());
    bench.StopAsSoonAsGranted(motion, later_ms * 1'000'000);
    const Json answer = bench.Answer(1.0);
    EXPECT_EQ(answer["ok"], false) << later_ms;
    EXPECT_NE(answer["error"], "no answer") << later_ms;
    EXPECT_FALSE(bench.commissioner().busy()) << later_ms;
    if (answer.dump().find("before it moved") != std::string::npos) ++before_it_moved;
  }
  EXPECT_GT(before_it_moved, 10);
}

TEST(Commissioner, RefusesCommandsThatTheStateForbids) {
  Bench bench;
  Commissioner& commissioner = bench.commissioner();
  const auto refusal = [&](const Json& command) {
    return MessageOf<RejectedError>([&] { commissioner.Start(command, bench.state()); });
  };
  EXPECT_THAT(refusal({{"command", "pluck"}}), HasSubstr("flexarm arm"));
  EXPECT_THAT(refusal({{"command", "home"}, {"joint", 1}, {"side", "low"}}),
              HasSubstr("flexarm arm"));
  bench.Arm();
  for (const char* name : {"tare", "zero"}) {
    EXPECT_THAT(refusal({{"command", name}}), HasSubstr("needs the state Idle")) << name;
  }
}

TEST(Commissioner, RefusesInvalidArguments) {
  Bench bench;
  const auto refusal = [&](const Json& command) {
    return MessageOf<RejectedError>(
        [&] { bench.commissioner().Start(command, SafetyState::kArmed); });
  };
  EXPECT_THAT(refusal({{"command", "home"}, {"joint", 3}, {"side", "low"}}), HasSubstr("1 or 2"));
  EXPECT_THAT(refusal({{"command", "home"}, {"joint", 1}, {"side", "up"}}),
              HasSubstr("low or high"));
  EXPECT_THAT(refusal({{"command", "home"}, {"side", "low"}}), HasSubstr("'joint'"));
  EXPECT_THAT(refusal({{"command", "calibrate"}, {"link", 1}, {"force_n", 5}, {"at_m", 2.0}}),
              HasSubstr("lie on link 1"));
  EXPECT_THAT(refusal({{"command", "zero"}, {"angle_deg", {1}}}), HasSubstr("two numbers"));
  for (const double outside_deg : {1e300, -1000.0, 90.1}) {  // the rig's soft limit is 90 deg
    EXPECT_THAT(refusal({{"command", "zero"}, {"angle_deg", {0.0, outside_deg}}}),
                HasSubstr("of joint 2 is"))
        << outside_deg;
  }
}

TEST(Commissioner, RefusesASecondCommandWhileBusy) {
  Bench bench;
  bench.commissioner().Start({{"command", "tare"}}, bench.state());
  EXPECT_THAT(MessageOf<RejectedError>(
                  [&] { bench.commissioner().Start({{"command", "zero"}}, bench.state()); }),
              HasSubstr("busy with tare"));
}

// The pulse of the config turns hub 1 at 2.47 rad/s, and 2 are allowed then.
TEST(Commissioner, WithReducedLimitsThePulseIsSmallerAndProvesTheWiringToo) {
  Bench bench({"commissioning.prove_before_run=true", "safety.reduced=true"});
  bench.Arm();
  const Json answer = bench.Do({{"command", "pluck"}});
  EXPECT_EQ(answer["ok"], true) << answer.dump();
  EXPECT_EQ(bench.state(), SafetyState::kArmed);
  EXPECT_EQ(bench.commissioner().WhyNoRun(), "");
}

TEST(Commissioner, HomingNeedsAPassedPluckTest) {
  Bench bench({"commissioning.prove_before_run=true"});
  bench.Arm();
  EXPECT_THAT(MessageOf<RejectedError>([&] {
                bench.commissioner().Start({{"command", "home"}, {"joint", 1}, {"side", "low"}},
                                           bench.state());
              }),
              HasSubstr("flexarm pluck"));
}

}  // namespace
}  // namespace flexarm
