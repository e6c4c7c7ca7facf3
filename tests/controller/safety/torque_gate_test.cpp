#include "controller/safety/torque_gate.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr GateLimits kGateLimits{.torque_nm = {30.0, 6.0},
                                 .slew_nm_per_s = {500.0, 150.0},
                                 .command_timeout_ns = 40 * kMs,
                                 .permit_timeout_ns = 5 * kMs,
                                 .homing_fraction = 0.9,
                                 .reduced_fraction = 0.8};

constexpr GateInput FineInput() {
  return {.asked_nm = {2.0, -1.0},
          .asked_age_ns = 3 * kMs,
          .permit = SafetyState::kRunning,
          .homing = false,
          .reduced = false,
          .permit_age_ns = 1 * kMs,
          .previous_nm = {1.9, -0.9},
          .dt_s = 1e-3};
}

void ExpectZeroed(const GateInput& in, std::uint32_t why) {
  const GateResult result = Gate(in, kGateLimits);
  EXPECT_EQ(result.torque_nm[0], 0.0);
  EXPECT_EQ(result.torque_nm[1], 0.0);
  EXPECT_EQ(result.why, why);
}

TEST(Gate, PassesAnAdmissibleTorqueUnchanged) {
  const GateResult result = Gate(FineInput(), kGateLimits);
  EXPECT_EQ(result.torque_nm[0], 2.0);
  EXPECT_EQ(result.torque_nm[1], -1.0);
  EXPECT_EQ(result.why, 0u);
}

TEST(Gate, AnOldCommandIsZeroAtOnce) {
  GateInput in = FineInput();
  in.previous_nm = {25.0, 5.0};  // far from zero: no slew on the way down
  in.asked_age_ns = 40 * kMs;
  EXPECT_EQ(Gate(in, kGateLimits).why & kGateZeroed, 0u) << "exactly two periods is not too old";
  in.asked_age_ns = 40 * kMs + 1;
  ExpectZeroed(in, kGateCommandOld);
  in.asked_age_ns = AgeNs(0, INT64_MIN);  // there was no command
  ExpectZeroed(in, kGateCommandOld);
  in.asked_age_ns = -1;  // a clock error
  ExpectZeroed(in, kGateCommandOld);
}

TEST(Gate, AnOldPermitIsZeroAtOnce) {
  GateInput in = FineInput();
  in.previous_nm = {25.0, 5.0};
  in.permit_age_ns = 5 * kMs;
  EXPECT_EQ(Gate(in, kGateLimits).why & kGateZeroed, 0u);
  in.permit_age_ns = 5 * kMs + 1;
  ExpectZeroed(in, kGatePermitOld);
  in.permit_age_ns = -1;
  ExpectZeroed(in, kGatePermitOld);
}

TEST(Gate, WhatBeganInThisInstantIsYoung) {
  GateInput in = FineInput();
  in.asked_age_ns = 0;
  in.permit_age_ns = 0;
  EXPECT_EQ(Gate(in, kGateLimits).why, 0u);
}

TEST(Gate, EveryReasonIsNamedBesideTheOthers) {
  GateInput in = FineInput();
  in.asked_age_ns = -1;
  in.permit_age_ns = -1;
  in.permit = SafetyState::kArmed;
  in.dt_s = kNan;
  ExpectZeroed(in, kGateCommandOld | kGatePermitOld | kGateNotAllowed | kGateNotFinite);
}

// By docs/safety.md, "States".
bool HasTorque(SafetyState state) {
  return state == SafetyState::kRunning || state == SafetyState::kStopping ||
         state == SafetyState::kFaultStopping;
}

TEST(Gate, OnlyRunningAndTheTwoStopsPassTorque) {
  for (int state = 0; state < 256; ++state) {
    GateInput in = FineInput();
    in.permit = static_cast<SafetyState>(state);
    if (HasTorque(in.permit)) {
      EXPECT_EQ(Gate(in, kGateLimits).why, 0u) << state;
    } else {
      SCOPED_TRACE(state);
      ExpectZeroed(in, kGateNotAllowed);
    }
  }
}

TEST(Gate, NonFiniteInputsGiveZeroOnBothJoints) {
  for (const double bad : {kNan, kInf, -kInf}) {
    for (std::size_t joint = 0; joint < 2; ++joint) {
      GateInput in = FineInput();
      in.asked_nm[joint] = bad;
      ExpectZeroed(in, kGateNotFinite);
      in = FineInput();
      in.previous_nm[joint] = bad;
      ExpectZeroed(in, kGateNotFinite);
      GateLimits limits = kGateLimits;
      limits.torque_nm[joint] = bad;
      EXPECT_EQ(Gate(FineInput(), limits).why, kGateNotFinite);
      limits = kGateLimits;
      limits.slew_nm_per_s[joint] = bad;
      EXPECT_EQ(Gate(FineInput(), limits).why, kGateNotFinite);
    }
    GateInput in = FineInput();
    in.dt_s = bad;
    ExpectZeroed(in, kGateNotFinite);
  }
}

TEST(Gate, LimitsTorqueAndNamesTheJoint) {
  GateInput in = FineInput();
  in.asked_nm = {1e300, -6.1};
  in.previous_nm = {30.0, -6.0};
  const GateResult result = Gate(in, kGateLimits);
  EXPECT_EQ(result.torque_nm[0], 30.0);
  EXPECT_EQ(result.torque_nm[1], -6.0);
  EXPECT_EQ(result.why, kGateTorque1 | kGateTorque2);
}

TEST(Gate, NamesOnlyTheJointThatItLimits) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    GateInput in = FineInput();
    in.asked_nm[joint] = in.previous_nm[joint] = 1.5 * kGateLimits.torque_nm[joint];  // beyond it
    EXPECT_EQ(Gate(in, kGateLimits).why & (kGateTorque1 | kGateTorque2),
              joint == 0 ? kGateTorque1 : kGateTorque2);
    in = FineInput();
    in.asked_nm[joint] = 0.0;  // 1.9 and 0.9 N m in 1 ms: more than 0.5 and 0.15
    EXPECT_EQ(Gate(in, kGateLimits).why, joint == 0 ? kGateSlew1 : kGateSlew2);
  }
}

TEST(Gate, LimitsSlewInBothDirectionsAndNamesTheJoint) {
  GateInput in = FineInput();
  in.asked_nm = {10.0, -5.0};
  in.previous_nm = {0.0, 0.0};
  const GateResult up = Gate(in, kGateLimits);
  EXPECT_DOUBLE_EQ(up.torque_nm[0], 0.5);    // 500 N m/s for 1 ms
  EXPECT_DOUBLE_EQ(up.torque_nm[1], -0.15);  // 150 N m/s for 1 ms
  EXPECT_EQ(up.why, kGateSlew1 | kGateSlew2);
  in.asked_nm = {0.0, -1.0};
  in.previous_nm = {10.0, -1.0};
  const GateResult down = Gate(in, kGateLimits);
  EXPECT_DOUBLE_EQ(down.torque_nm[0], 9.5);
  EXPECT_EQ(down.why, kGateSlew1);
}

TEST(Gate, TorqueLimitHasPriorityOverSlewLimit) {
  GateInput in = FineInput();
  in.asked_nm = {29.0, 0.0};
  in.previous_nm = {40.0, 0.0};
  EXPECT_EQ(Gate(in, kGateLimits).torque_nm[0], 30.0);
}

// A config has positive limits; a limit that is wrong all the same must not turn torque around.
TEST(Gate, ALimitOfZeroOrBelowPassesNoTorque) {
  GateLimits limits = kGateLimits;
  limits.torque_nm = {0.0, -6.0};
  EXPECT_EQ(Gate(FineInput(), limits).torque_nm, (std::array<double, 2>{0.0, 0.0}));
  limits = kGateLimits;
  limits.slew_nm_per_s = {0.0, -150.0};
  EXPECT_EQ(Gate(FineInput(), limits).torque_nm, FineInput().previous_nm);
}

TEST(Gate, TheLimitsOfARigComeFromItsConfig) {
  SafetyConfig safety{};
  safety.torque_limit_nm = {31.0, 7.0};
  safety.slew_limit_nm_per_s = {501.0, 151.0};
  safety.permit_timeout_ms = 5.25;
  safety.homing_torque_fraction = 0.375;
  safety.reduced_torque = 0.625;
  LoopConfig loop{};
  loop.period_ms = 20.0;
  const GateLimits limits = MakeGateLimits(safety, LoopGrid(loop));
  EXPECT_EQ(limits.torque_nm, safety.torque_limit_nm);
  EXPECT_EQ(limits.slew_nm_per_s, safety.slew_limit_nm_per_s);
  EXPECT_EQ(limits.command_timeout_ns, 40 * kMs);  // two periods
  EXPECT_EQ(limits.permit_timeout_ns, 5'250'000);  // 5.25 ms
  EXPECT_EQ(limits.homing_fraction, 0.375);
  EXPECT_EQ(limits.reduced_fraction, 0.625);
}

// Logs and status name the bits: each once, and those that zero the torque are the first four.
TEST(Gate, EachReasonHasABitAndANameOfItsOwn) {
  std::uint32_t bits = 0;
  std::set<std::string> names;
  for (const GateReason& reason : kGateReasons) {
    EXPECT_EQ(static_cast<std::uint32_t>(reason.bit), bits + 1) << reason.name;
    bits |= reason.bit;
    names.insert(reason.name);
  }
  EXPECT_EQ(bits, 0xFFu);
  EXPECT_EQ(names.size(), kGateReasons.size());
  EXPECT_EQ(kGateZeroed, 0x0Fu);
}

static_assert(AgeNs(7, 5) == 2);
static_assert(AgeNs(5, 7) == -2);
static_assert(AgeNs(0, INT64_MIN) == INT64_MAX);

TEST(Gate, HomingHasAShareOfTheTorqueLimit) {
  GateLimits limits = kGateLimits;
  limits.homing_fraction = 0.3;
  GateInput in = FineInput();
  in.asked_nm = {29.0, -5.0};
  in.previous_nm = {10.0, -2.0};
  in.dt_s = 0.1;
  EXPECT_EQ(Gate(in, limits).why, 0u) << "29 and -5 N m are within the limits of a run";
  in.homing = true;
  const GateResult homing = Gate(in, limits);
  EXPECT_DOUBLE_EQ(homing.torque_nm[0], 0.3 * 30.0);
  EXPECT_DOUBLE_EQ(homing.torque_nm[1], -0.3 * 6.0);
  EXPECT_EQ(homing.why, kGateTorque1 | kGateTorque2);
  limits.homing_fraction = kNan;
  EXPECT_EQ(Gate(in, limits).torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

TEST(Gate, ReducedLimitsAreAShareTooAndTheLeastShareHolds) {
  GateLimits limits = kGateLimits;
  limits.reduced_fraction = 0.5;
  limits.homing_fraction = 0.3;
  GateInput in = FineInput();
  in.asked_nm = {29.0, -5.0};
  in.previous_nm = {10.0, -2.0};
  in.dt_s = 0.1;
  in.reduced = true;
  EXPECT_DOUBLE_EQ(Gate(in, limits).torque_nm[0], 0.5 * 30.0);
  EXPECT_DOUBLE_EQ(Gate(in, limits).torque_nm[1], -0.5 * 6.0);
  in.homing = true;
  EXPECT_DOUBLE_EQ(Gate(in, limits).torque_nm[0], 0.3 * 30.0);
  limits.reduced_fraction = kNan;
  EXPECT_EQ(Gate(in, limits).torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

TEST(Gate, AShareAboveOnePassesNoMoreThanTheLimit) {
  GateLimits limits = kGateLimits;
  limits.homing_fraction = limits.reduced_fraction = 1.5;
  GateInput in = FineInput();
  in.asked_nm = in.previous_nm = {40.0, -8.0};
  for (const auto& [homing, reduced] : {std::pair{true, false}, {false, true}, {true, true}}) {
    in.homing = homing;
    in.reduced = reduced;
    EXPECT_EQ(Gate(in, limits).torque_nm, (std::array<double, 2>{30.0, -6.0}));
  }
}

TEST(Gate, NoTimePassedMeansNoChange) {
  GateInput in = FineInput();
  for (const double dt : {0.0, -1.0}) {
    in.dt_s = dt;
    EXPECT_EQ(Gate(in, kGateLimits).torque_nm, in.previous_nm);
  }
}

static_assert(noexcept(Gate(GateInput{}, GateLimits{})));

TEST(Gate, NeverExceedsItsLimitsForAnyInput) {
  setenv("RC_PARAMS", "seed=20261120 max_success=20000", 0);  // repeatable
  long passed = 0;
  long zeroed = 0;
  const bool held = rc::check("|out| <= limit, |out - previous| <= slew dt", [&] {
    const auto value = [](double scale) {
      const int pick = *rc::gen::inRange(0, 64);
      if (pick == 0) return kNan;
      if (pick == 1) return kInf;
      if (pick == 2) return -kInf;
      if (pick == 3) return 1e308;
      return *rc::gen::inRange(-1000, 1001) * 1e-3 * scale;
    };
    GateInput in{.asked_nm = {value(60.0), value(12.0)},
                 .asked_age_ns = *rc::gen::inRange<std::int64_t>(-kMs, 60 * kMs),
                 .permit = static_cast<SafetyState>(*rc::gen::inRange(0, 8)),
                 .homing = *rc::gen::inRange(0, 2) == 1,
                 .reduced = *rc::gen::inRange(0, 2) == 1,
                 .permit_age_ns = *rc::gen::inRange<std::int64_t>(-kMs / 10, 7 * kMs),
                 .previous_nm = {},
                 .dt_s = *rc::gen::inRange(0, 21) * 1e-3};
    for (std::size_t joint = 0; joint < 2; ++joint) {
      in.previous_nm[joint] = *rc::gen::inRange(-1000, 1001) * 1e-3 * kGateLimits.torque_nm[joint];
    }
    const GateResult out = Gate(in, kGateLimits);
    const bool allowed = HasTorque(in.permit);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double torque = out.torque_nm[joint];
      const double share = in.reduced ? 0.8 : in.homing ? 0.9 : 1.0;
      const double limit = share * kGateLimits.torque_nm[joint];
      RC_ASSERT(std::abs(torque) <= limit);  // false for NaN too
      if ((out.why & kGateZeroed) != 0) {
        RC_ASSERT(torque == 0.0);
      } else {
        // previous +- step is rounded once: half an ulp of at most 40 N m, 4e-15. A slew limit that
        // is wrong by 0.1 % would be off by 1e-4.
        const double step = kGateLimits.slew_nm_per_s[joint] * in.dt_s;
        const double from = std::clamp(in.previous_nm[joint], -limit, limit);
        RC_ASSERT(std::abs(torque - from) <= step + 1e-14);
      }
      if (torque != 0.0) {
        RC_ASSERT(allowed);
        RC_ASSERT(in.asked_age_ns >= 0 && in.asked_age_ns <= 40 * kMs);
        RC_ASSERT(in.permit_age_ns >= 0 && in.permit_age_ns <= 5 * kMs);
      }
      if (out.why == 0) RC_ASSERT(torque == in.asked_nm[joint]);
    }
    passed += (out.why & kGateZeroed) == 0;
    zeroed += (out.why & kGateZeroed) != 0;
  });
  EXPECT_TRUE(held);
  // Shares, not numbers: the first property of a program sets how many cases all of it run.
  EXPECT_GT(20 * passed, passed + zeroed) << "the cases must reach what they are to test";
  EXPECT_GT(20 * zeroed, passed + zeroed);
}

}  // namespace
}  // namespace flexarm
