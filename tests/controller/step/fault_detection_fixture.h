#pragma once

#include <gtest/gtest.h>

#include <limits>

#include "controller/step/fault_detection.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/step/healthy_facts.h"
#include "tests/support/loop_time.h"

namespace flexarm {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The faults of the control step of the shipped rig.
class FaultDetectionTest : public testing::Test {
 protected:
  // As StrainFit without enough gauges of a link.
  static Facts Unfitted(std::size_t link, int gauges) {
    Facts facts;
    facts.modes.valid[link] = false;
    facts.modes.root_strain[link] = kNan;
    facts.modes.gauges[link] = gauges;
    return facts;
  }
  static Facts WithoutCounter(std::size_t counter) {
    Facts facts;
    facts.counters.good &= ~(1U << counter);
    return facts;
  }

  // Judges `facts` repeatedly; expects only `cause`, with its evidence, from the `ticks`-th sample
  // on, and no fault once the inputs are healthy again.
  void Expect(TripCause cause, int ticks, const Facts& facts, double value, double limit,
              std::uint16_t channel) {
    SCOPED_TRACE(ToString(cause));
    monitor_.Reset();
    for (int k = 1; k < ticks; ++k) {
      EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u) << "after " << k;
    }
    for (int k = 0; k < 3; ++k) {
      const auto verdict = monitor_.Judge(facts.Now());
      EXPECT_EQ(verdict.faults, CauseBit(cause));
      EXPECT_DOUBLE_EQ(verdict.value, value);
      EXPECT_DOUBLE_EQ(verdict.limit, limit);
      EXPECT_EQ(verdict.channel, channel);
    }
    EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u) << "the inputs are healthy again";
  }

  const RigConfig config_ = ShippedRig({"limits.following_error_deg=[20, 35]"});
  FaultDetection monitor_{config_.safety,  config_.estimator, kPeriod_s,
                          config_.sensors, kGaugesNeeded,     {761.59, 497.96}};
};

}  // namespace flexarm
