// What a step gets of the reference: the state when its torque acts, and the state at its sampling
// instant, which is a period and the torque's lateness before.

#include "controller/tasks/follow_reference.h"

#include <gtest/gtest.h>

#include "tests/controller/loop/simulated_runs.h"

namespace flexarm {
namespace {

// Angle of joint 1 and lateness of the torque by `overrides`, at sample 30 of the base command.
struct Followed {
  explicit Followed(const std::vector<std::string>& overrides)
      : config(ShippedRig(overrides)),
        table(ShippedExperiment(), ShippedDesign(), config.loop.period_s(), {0.0, 0.0},
              ShippedLimits()) {
    reference.Start(&table, nullptr);
    FollowReference(reference, LoopGrid(config.loop), kSample, kSample, &input);
  }

  double At(int k) const { return reference.At(k).x_m[0]; }
  double now() const { return input.reference_now.x_m[0]; }

  static constexpr int kSample = 30;  // the arm moves
  RigConfig config;
  ReferenceTable table;
  TimedReference reference;
  StepInput input{};
};

// 1e-15: one sum of products of numbers below 1.
constexpr double kRounding_rad = 1e-15;

TEST(FollowReference, GivesTheStateWhenTheTorqueActs) {
  const Followed f({});
  EXPECT_NE(f.At(f.kSample), f.At(f.kSample + 1));
  EXPECT_EQ(f.input.reference_next.x_m[0], f.At(f.kSample));
  EXPECT_EQ(f.now(), f.At(f.kSample - 1));
  EXPECT_EQ(f.input.reference_ended, 0);
}

TEST(FollowReference, InterpolatesWhereTorquesActBetweenSamples) {
  const Followed late({"loop.actuation_delay_ms=7"});
  EXPECT_NEAR(late.now(), 0.35 * late.At(late.kSample - 2) + 0.65 * late.At(late.kSample - 1),
              kRounding_rad);
  const Followed early({"loop.output=at_once", "loop.output_after_ms=15"});
  EXPECT_NEAR(early.now(), 0.75 * early.At(early.kSample - 1) + 0.25 * early.At(early.kSample),
              kRounding_rad);
}

TEST(FollowReference, AFoundDelayMovesTheNextStateOnly) {
  Followed f({});
  FollowReference(f.reference, LoopGrid(f.config.loop), f.kSample, f.kSample + 1, &f.input);
  EXPECT_EQ(f.input.reference_next.x_m[0], f.At(f.kSample + 1));
  EXPECT_EQ(f.now(), f.At(f.kSample - 1));
}

TEST(FollowReference, EndsWithItsLastPeriod) {
  Followed f({});
  const int periods = f.reference.periods();
  for (const int sample : {periods - 2, periods - 1}) {
    FollowReference(f.reference, LoopGrid(f.config.loop), sample, sample, &f.input);
    EXPECT_EQ(f.input.reference_ended, sample == periods - 1 ? 1 : 0);
  }
}

}  // namespace
}  // namespace flexarm
