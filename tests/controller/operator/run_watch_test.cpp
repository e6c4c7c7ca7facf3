#include "controller/operator/run_watch.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/tasks/planned_experiment.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using enum SafetyState;

constexpr double kPeriod = 0.02;

class RunWatchTest : public testing::Test {
 protected:
  // The run `number` is granted now.
  void Grant(std::uint32_t number, const std::string& name, LineLevels may_open = 0) {
    watch_.Answered({.number = number,
                     .kind = RequestKind::kRun,
                     .refusal = Refusal::kNone,
                     .state = kArmed,
                     .present = 0},
                    name);
    permit_.run_number = number;
    permit_.run = {.experiment = &experiment_, .may_open = may_open};
    permit_.running_since_ns = now_ns_;
  }
  void Stop() {
    watch_.Answered({.number = 2'000,
                     .kind = RequestKind::kStop,
                     .refusal = Refusal::kNone,
                     .state = kRunning,
                     .present = 0},
                    "");
  }
  Json In(SafetyState state, double later_s = 0.5, bool shutting_down = false) {
    now_ns_ += static_cast<std::int64_t>(later_s * 1e9);
    permit_.state = state;
    watch_.Follow(now_ns_, permit_, tick_, shutting_down);
    return watch_.Json();
  }

  PlannedExperiment experiment_{std::vector<std::array<double, 2>>(100)};
  Permit permit_ = kNoPermit;
  TickRecord tick_{};
  std::int64_t now_ns_ = 60 * kMs;
  RunWatch watch_{kPeriod};
};

TEST_F(RunWatchTest, ThereIsNoneBeforeTheFirst) {
  EXPECT_TRUE(In(kIdle).is_null());
  Stop();
  EXPECT_TRUE(In(kArmed).is_null());
}

TEST_F(RunWatchTest, ARunGoesOnUntilTheArmIsAtRest) {
  Grant(1'002, "square");
  EXPECT_EQ(In(kRunning), Json({{"number", 1'002},
                                {"name", "square"},
                                {"outcome", "running"},
                                {"elapsed_s", 0.5},
                                {"duration_s", 2.0},
                                {"trip", nullptr},
                                {"speed_percent", nullptr}}));
  EXPECT_EQ(In(kStopping)["outcome"], "running");
  const Json ended = In(kArmed, 1.0);
  EXPECT_EQ(ended["outcome"], "done");
  EXPECT_EQ(ended["elapsed_s"], 1.0) << "when it was last moving";
  EXPECT_EQ(In(kIdle)["outcome"], "done") << "until the next";
}

// The answer comes in the period before the permit that has the run.
TEST_F(RunWatchTest, AnOlderPermitDoesNotEndIt) {
  Grant(1'002, "square");
  permit_.run_number = 1'001;
  EXPECT_EQ(In(kArmed)["outcome"], "running");
  permit_.run_number = 1'002;
  EXPECT_EQ(In(kRunning)["outcome"], "running");
}

TEST_F(RunWatchTest, AStopTheEndOfTheDaemonAndATripAreNotDone) {
  Grant(1'002, "stopped");
  In(kRunning);
  Stop();
  In(kStopping);
  EXPECT_EQ(In(kArmed)["outcome"], "stopped");
  Grant(1'003, "ended");
  In(kRunning, 0.1, true);
  EXPECT_EQ(In(kIdle, 0.1, true)["outcome"], "stopped");
  Grant(1'004, "tripped");
  In(kRunning);
  permit_.cause = TripCause::kHubRate1;
  EXPECT_EQ(In(kFaultStopping)["outcome"], "running");
  const Json ended = In(kTripped);
  EXPECT_EQ(ended["outcome"], "tripped");
  EXPECT_EQ(ended["trip"], "hub-rate-1");
}

TEST_F(RunWatchTest, ATripBetweenTwoLooksIsSeen) {
  Grant(1'002, "square");
  permit_.cause = TripCause::kEmergencyStop;
  EXPECT_EQ(In(kTripped)["trip"], "emergency-stop");
}

TEST_F(RunWatchTest, ASearchForASwitchHasNoDuration) {
  Grant(1'002, "home", 0b1);
  EXPECT_TRUE(In(kRunning)["duration_s"].is_null());
}

}  // namespace
}  // namespace flexarm
