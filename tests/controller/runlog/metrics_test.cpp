// Metrics of hand-made traces with known results.

#include "controller/runlog/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "model/units.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

// The distances in the tests below are about the 15 mm of an arm of 1.7 m.
const TipGeometry kGeometry{.layout = kR12,
                            .length_m = {1.0, 0.7},
                            .tip_slope_per_m = {1.5, 4.0},
                            .settled_within_m = 0.015};

// The tip at the target while the reference is zero: both links straight along x.
constexpr double kTarget_m = 1.7;

// Two moves: rests are 1..3 s and 4..6 s.
Experiment TwoMoves() {
  const auto move = [](double start_s) {
    return Doublet{
        .start_s = start_s, .duration_s = 1, .shape = DoubletShape::kSquare, .move_deg = {30, 30}};
  };
  return {
      .name = "two", .text = "", .duration_s = 6, .doublet = {move(0), move(3)}, .sim_event = {}};
}

// Armed, then Running with `fill(t, record)`, t = 0 at sample 0, then Stopping.
std::vector<TickRecord> Trace(double end_s, const std::function<void(double, TickRecord*)>& fill) {
  std::vector<TickRecord> ticks;
  const int last = static_cast<int>(std::lround(end_s / kPeriod_s));
  for (int n = -6; n <= last + 5; ++n) {
    TickRecord record{};
    record.input.tick = 1000 + n;
    record.input.safety_state = n < -1      ? SafetyState::kArmed
                                : n <= last ? SafetyState::kRunning
                                            : SafetyState::kStopping;
    record.truth.known = true;
    const bool running = record.input.safety_state == SafetyState::kRunning;
    if (running) fill(n * kPeriod_s, &record);
    if (!running) record.truth = {{9, 9}, {9, 9}, {9, 9}, true};  // must not count
    ticks.push_back(record);
  }
  return ticks;
}

RunMetrics Judge(const std::vector<TickRecord>& ticks) {
  return ComputeMetrics(ticks, TwoMoves(), kPeriod_s, kGeometry);
}

TEST(RunMetrics, RmsIsOverAllRunningTicksAgainstTheReference) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->input.reference_now.x_m[0] = std::sin(t);
    record->truth.hub_angle_rad[0] = std::sin(t) + 2 * kRadPerDeg;
    const bool odd = record->input.tick % 2 != 0;
    record->truth.hub_angle_rad[1] = odd ? 4 * kRadPerDeg : 0;  // 999 .. 1300: 151 of 302 are odd
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_EQ(metrics.ticks, 302);
  EXPECT_TRUE(metrics.truth);
  EXPECT_NEAR(metrics.joint_rms_error_deg[0], 2, 1e-12);
  EXPECT_NEAR(metrics.joint_rms_error_deg[1], 4 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(metrics.joint_peak_error_deg[0], 2, 1e-12);
  EXPECT_NEAR(metrics.joint_peak_error_deg[1], 4, 1e-12);
}

TEST(RunMetrics, FinalErrorIsTheWorstRestsMeanOverItsLastThreeTenths) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    if (t > 2.71 && t < 3.01)
      record->truth.hub_angle_rad[0] = -0.5 * kRadPerDeg;  // the window exactly
    if (t > 5.71) record->truth.hub_angle_rad[0] = 0.3 * kRadPerDeg;
    if (t > 2.69 && t < 2.71) record->truth.hub_angle_rad[1] = 50 * kRadPerDeg;  // just before it
    if (t > 3.01 && t < 3.03) record->truth.hub_angle_rad[1] = 50 * kRadPerDeg;  // just after it
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_NEAR(metrics.joint_final_error_deg[0], 0.5, 1e-12);
  EXPECT_NEAR(metrics.joint_final_error_deg[1], 0, 1e-12);
}

// What follows the stop does not count, nor a rest that it leaves nothing of.
TEST(RunMetrics, FiguresEndWhereTheRunWasStopped) {
  const auto off_after_4s = [](double t, TickRecord* record) {
    if (t > 4.01) record->truth.hub_angle_rad[0] = 7 * kRadPerDeg;
  };
  const RunMetrics in_the_move = Judge(Trace(3.8, off_after_4s));
  const RunMetrics just_after_it = Judge(Trace(4.2, off_after_4s));
  const RunMetrics in_the_rest = Judge(Trace(4.6, off_after_4s));
  EXPECT_EQ(in_the_move.ticks, 192);
  EXPECT_NEAR(in_the_move.joint_final_error_deg[0], 0, 1e-12);
  EXPECT_NEAR(just_after_it.joint_final_error_deg[0], 0, 1e-12) << "0.2 s are no rest";
  EXPECT_NEAR(in_the_rest.joint_final_error_deg[0], 7, 1e-12);
  EXPECT_FALSE(Judge(Trace(0.8, off_after_4s)).tip_settling_time_s.has_value());
}

TEST(RunMetrics, StillWithinFiveMillimetresIsTheNarrowBand) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->truth.tip_m = {1.0, 0.0};
    if (t > 3.5 && t < 4.71) record->truth.tip_m[1] = 0.0051;  // last outside at 4.70
    if (t > 5.0 && t < 5.1) record->truth.tip_m[1] = 0.0049;   // inside
  });
  const RunMetrics metrics = Judge(ticks);
  ASSERT_TRUE(metrics.tip_still_within_5mm_s.has_value());
  EXPECT_NEAR(*metrics.tip_still_within_5mm_s, 0.72, 1e-9);
}

// Every other sample from 5 s to 6 s deviates by 1 mm: 0.5 mm rms about the mean.
TEST(RunMetrics, TheLastSecondIsThatOfTheLastRest) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->truth.tip_m = {1.0, 0.0};
    if (t < 4.99) record->truth.tip_m[0] += 0.3 * std::sin(40.0 * t);  // before it: must not count
    if (t > 4.99 && record->input.tick % 2 == 0) record->truth.tip_m[1] = 1e-3;
  });
  EXPECT_NEAR(Judge(ticks).tip_last_second_rms_mm, 0.5, 1e-9);
}

// A reference of 0.2 sin t, and a hub that follows it 30 ms late: to first order in the lag.
TEST(RunMetrics, TheLagIsThatOfTheReferenceThatFitsTheErrors) {
  constexpr double kLag_s = 0.03;
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->input.reference_now.x_m[0] = 0.2 * std::sin(t);
    record->input.reference_now.x_m[6] = 0.2 * std::cos(t);
    record->truth.hub_angle_rad[0] = 0.2 * std::sin(t - kLag_s);
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_NEAR(metrics.joint_lag_s[0], kLag_s, kLag_s * kLag_s);
  EXPECT_NEAR(metrics.peak_angle_deg[0], 0.2 / kRadPerDeg, 1e-3);  // between two samples
}

// An angle that jumps by a between samples, to and fro, has the second difference 2 a throughout;
// one that turns steadily has none.
TEST(RunMetrics, RoughnessIsTheSecondDifferenceInTheRests) {
  constexpr double kJump_rad = 1e-3;
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->truth.hub_angle_rad[0] = record->input.tick % 2 == 0 ? kJump_rad : 0.0;
    record->truth.hub_angle_rad[1] = 0.1 * t;
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_NEAR(metrics.joint_roughness_rad_s2[0], 2.0 * kJump_rad / (kPeriod_s * kPeriod_s), 1e-9);
  EXPECT_NEAR(metrics.joint_roughness_rad_s2[1], 0.0, 1e-9);
}

// The second target is with joint 1 at 90 deg.
TEST(RunMetrics, SettlingIsTheWorstTimeFromTheMovesEnd) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->truth.tip_m = {t < 3.5 ? kTarget_m : 0.0, t < 3.5 ? 0.0 : kTarget_m};
    if (t > 3.01) record->input.reference_now.x_m[0] = 90.0 * kRadPerDeg;
    if (t > 0.5 && t < 1.39) record->truth.tip_m[0] += 0.016;   // last outside at 1.38
    if (t > 3.5 && t < 4.71) record->truth.tip_m[1] -= 0.0151;  // last outside at 4.70
    if (t > 5.0 && t < 5.1) record->truth.tip_m[0] += 0.0149;   // inside
  });
  const RunMetrics metrics = Judge(ticks);
  ASSERT_TRUE(metrics.tip_settling_time_s.has_value());
  EXPECT_NEAR(*metrics.tip_settling_time_s, 0.72, 1e-9);
  EXPECT_EQ(metrics.tip_settling_time_s, metrics.tip_still_within_15mm_s);
  EXPECT_NEAR(metrics.tip_residual_rms_mm, 0, 1e-9);
  EXPECT_NEAR(metrics.tip_target_error_mm, 0, 1e-9);
}

TEST(RunMetrics, ATipThatNeverLeavesItsTargetSettlesAtOnce) {
  const auto ticks =
      Trace(6, [](double, TickRecord* record) { record->truth.tip_m = {kTarget_m, 0}; });
  EXPECT_EQ(Judge(ticks).tip_settling_time_s, 0.0);
}

// One of two rests is off its target, by a little less and a little more than 15 mm.
TEST(RunMetrics, ATipThatRestsOffItsTargetIsNotSettled) {
  for (const double off_m : {0.0149, 0.0151}) {
    const auto ticks = Trace(6, [off_m](double t, TickRecord* record) {
      record->truth.tip_m = {kTarget_m, t < 3.5 ? off_m : 0.001};
    });
    const RunMetrics metrics = Judge(ticks);
    EXPECT_EQ(metrics.tip_settling_time_s.has_value(), off_m < 0.015);
    EXPECT_EQ(metrics.tip_still_within_15mm_s, 0.0);
    EXPECT_EQ(metrics.tip_still_within_5mm_s, 0.0);
    EXPECT_NEAR(metrics.tip_target_error_mm, 1e3 * off_m, 1e-9);
  }
}

// The joints are where they should be, and so is the tip although the links are bent at the target:
// the target is that of straight links.
TEST(RunMetrics, TheTargetIsWhereTheReferencesJointsEnd) {
  const auto ticks = Trace(6, [](double, TickRecord* record) {
    record->input.reference_now.x_m = {0.5, -0.3, 0.1, 0.0, 0.1};  // bending of the reference
    record->truth.tip_m = {std::cos(0.5) + 0.7 * std::cos(0.2),
                           std::sin(0.5) + 0.7 * std::sin(0.2)};
  });
  EXPECT_NEAR(Judge(ticks).tip_target_error_mm, 0.0, 1e-9);
}

TEST(RunMetrics, ATipThatNeverSettlesHasNoTime) {
  const auto ticks = Trace(6, [](double, TickRecord* record) {
    record->truth.tip_m = {record->input.tick % 2 != 0 ? 0.02 : -0.02, 0};
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_FALSE(metrics.tip_settling_time_s.has_value());
  EXPECT_FALSE(metrics.tip_still_within_15mm_s.has_value());
  // 15 ticks: mean of +-20 mm with one more of a sign is 20/15 mm off centre.
  EXPECT_NEAR(metrics.tip_residual_rms_mm, std::sqrt(400 - 400.0 / 225), 1e-9);
}

// The rests are 1..3 and 4..6 s: a tip that moves by +-3 mm in 1.32 .. 2.40 s and rests otherwise.
TEST(RunMetrics, MotionIsTheRestsMeanFromThreeTenthsAfterTheMove) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    const double sign = record->input.tick % 2 != 0 ? 1.0 : -1.0;
    if (t > 1.31 && t < 2.41) record->truth.tip_m = {sign * 0.003, 0.0};
    if (t > 4.01 && t < 4.31) record->truth.tip_m = {0.0, sign * 0.1};  // before the window
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_NEAR(metrics.tip_residual_rms_mm, 0.0, 1e-9);
  // 55 of 85 samples of one rest of two; a sample of a sign is left over: the mean is 3/85 mm off.
  EXPECT_NEAR(metrics.tip_motion_rms_mm, 1.5 * std::sqrt(55.0 / 85.0 - 1.0 / (85.0 * 85.0)), 1e-9);
}

TEST(RunMetrics, PeakTorqueIsTheLargestAppliedOfEitherSign) {
  const auto ticks = Trace(6, [](double t, TickRecord* record) {
    record->input.applied_torque_nm = {std::sin(t), t < 0.01 && t > -0.01 ? -3.0 : 1.0};
    record->output.torque_nm = {100, 100};  // asked only
  });
  EXPECT_NEAR(Judge(ticks).peak_torque_nm[0], 1, 1e-4);  // sampled near the crest
  EXPECT_EQ(Judge(ticks).peak_torque_nm[1], 3);
}

// Alternating 2 and 0 is sqrt(2) rms; a constant is itself. The trace has an even number of ticks.
TEST(RunMetrics, TorqueRmsIsThatOfTheAppliedTorqueOverAllTicks) {
  const auto ticks = Trace(6, [](double, TickRecord* record) {
    record->input.applied_torque_nm = {record->input.tick % 2 != 0 ? 2.0 : 0.0, -3.0};
    record->output.torque_nm = {100, 100};  // asked only
  });
  EXPECT_NEAR(Judge(ticks).torque_rms_nm[0], std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(Judge(ticks).torque_rms_nm[1], 3.0, 1e-12);
}

TEST(RunMetrics, PeakBendingIsTheTipsTrueDeflectionOrTheSumOfTheEstimatedModes) {
  for (const bool known : {true, false}) {
    const auto ticks = Trace(6, [known](double t, TickRecord* record) {
      record->truth.known = known;
      record->truth.tip_deflection_m = {t > 1.0 && t < 1.1 ? -0.2 : 0.1, 0.05};
      record->output.x_hat = {0, 0, 0.3, -0.1, 0.02, 0.01};
      record->output.modal_m = {1, 1, 1, 1};  // fitted, before the estimator
    });
    const RunMetrics metrics = Judge(ticks);
    EXPECT_NEAR(metrics.peak_bending_mm[0], 200.0, 1e-9) << known;  // |-0.2|, or 0.3 - 0.1
    EXPECT_NEAR(metrics.peak_bending_mm[1], known ? 50.0 : 30.0, 1e-9) << known;
  }
}

TEST(RunMetrics, ARunThatEndedInItsFirstRestUsesThatRestAlone) {
  const auto ticks = Trace(2, [](double t, TickRecord* record) {
    record->truth.hub_angle_rad[0] = t > 1.71 ? kRadPerDeg : 0;
  });
  EXPECT_NEAR(Judge(ticks).joint_final_error_deg[0], 1, 1e-12);
}

TEST(RunMetrics, ARunThatEndedInItsFirstMoveHasNoRest) {
  const RunMetrics metrics = Judge(Trace(0.5, [](double, TickRecord*) {}));
  EXPECT_EQ(metrics.ticks, 27);
  EXPECT_TRUE(std::isnan(metrics.joint_final_error_deg[0]));
  EXPECT_TRUE(std::isnan(metrics.tip_residual_rms_mm));
  EXPECT_TRUE(std::isnan(metrics.tip_motion_rms_mm));
  EXPECT_TRUE(std::isnan(metrics.tip_target_error_mm));
  EXPECT_FALSE(metrics.tip_settling_time_s.has_value());
}

// A move that is retargeted has no rest of its own, whatever the duration of its row: here the
// second retargets the first, and the third retargets one that would have lasted until 5.5 s.
TEST(Rests, AreThoseOfMovesThatEnd) {
  Experiment experiment = TwoMoves();
  experiment.doublet.clear();
  experiment.move = {{.start_s = 0.0, .duration_s = 2.0},
                     {.start_s = 0.5, .duration_s = 5.0},
                     {.start_s = 1.0, .duration_s = 1.5},
                     {.start_s = 3.0, .duration_s = 2.0},
                     {.start_s = 4.0, .duration_s = 0.5}};
  const std::vector<Rest> rests = RestsOf(experiment, 6.0);
  ASSERT_EQ(rests.size(), 2U);
  EXPECT_EQ(rests[0].start_s, 2.5);
  EXPECT_EQ(rests[0].end_s, 3.0);
  EXPECT_EQ(rests[1].start_s, 4.5);
  EXPECT_EQ(rests[1].end_s, 6.0);
}

TEST(RunMetrics, NoTickAtAllIsNoError) {
  const RunMetrics metrics = Judge({});
  EXPECT_EQ(metrics.ticks, 0);
  EXPECT_FALSE(metrics.truth);
  EXPECT_TRUE(std::isnan(metrics.joint_rms_error_deg[0]));
  EXPECT_TRUE(std::isnan(metrics.joint_peak_error_deg[0]));
}

TEST(RunMetrics, WithoutTruthTheEstimateIsUsed) {
  const auto ticks = Trace(6, [](double, TickRecord* record) {
    record->truth.known = false;
    record->output.x_hat[0] = kRadPerDeg;
  });
  const RunMetrics metrics = Judge(ticks);
  EXPECT_FALSE(metrics.truth);
  EXPECT_NEAR(metrics.joint_rms_error_deg[0], 1, 1e-12);
}

TEST(EstimatedTip, IsTheEndOfTwoRigidLinksWithoutBending) {
  const auto tip = EstimatedTip(kGeometry, {kRadPerDeg * 90, kRadPerDeg * 90});
  EXPECT_NEAR(tip[0], -0.7, 1e-12);
  EXPECT_NEAR(tip[1], 1.0, 1e-12);
}

TEST(EstimatedTip, TurnsLinkTwoByTheTipSlopeOfLinkOne) {
  // f11 = 0.1 m: the elbow is 0.1 m to the left, link 2 points along atan(0.15).
  const auto tip = EstimatedTip(kGeometry, {0, 0, 0.1, 0, 0.2, 0});
  const double gamma = std::atan(0.15);
  EXPECT_NEAR(tip[0], 1 + 0.7 * std::cos(gamma) - 0.2 * std::sin(gamma), 1e-12);
  EXPECT_NEAR(tip[1], 0.1 + 0.7 * std::sin(gamma) + 0.2 * std::cos(gamma), 1e-12);
}

// The same arm at the same place, in the state layout of each nominal model: two modes a link where
// the model has two, rotors (which do not enter the tip) elsewhere, and a rate that must not be
// read as a mode.
TEST(EstimatedTip, IsFoundInTheStatesOfEveryNominalModel) {
  const double th1 = 0.3, th2 = -0.2, f1 = 0.1, f2 = 0.2, rotor = 9.0, rate = 7.0;
  const TipGeometry one = kGeometry;
  const auto expected = EstimatedTip(one, {th1, th2, f1, 0.0, f2, 0.0});
  TipGeometry r8 = one, t12 = one, t16 = one;
  r8.layout = kR8;
  t12.layout = kT12;
  t16.layout = kT16;
  EXPECT_EQ(EstimatedTip(r8, {th1, th2, f1, f2, rate, rate}), expected);
  EXPECT_EQ(EstimatedTip(t12, {th1, th2, rotor, rotor, f1, f2, rate, rate}), expected);
  EXPECT_EQ(EstimatedTip(t16, {th1, th2, rotor, rotor, f1, 0.0, f2, 0.0, rate, rate}), expected);
}

}  // namespace
}  // namespace flexarm
