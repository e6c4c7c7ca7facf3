#include "controller/operator/gauge_monitor.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

struct Gauges {
  // One sample in which the fit uses the channels of these bits.
  std::uint32_t Take(std::uint32_t used, SafetyState state = SafetyState::kRunning) {
    StepInput input{};
    input.safety_state = state;
    StepOutput output{};
    output.strain_used = static_cast<decltype(output.strain_used)>(used);
    return monitor.Take(input, output);
  }

  GaugeMonitor monitor{3};
};

TEST(GaugeMonitor, AChannelIsMissingAfterThreeSamplesWithoutItAndIsToldOnce) {
  Gauges gauges;
  EXPECT_EQ(gauges.monitor.missing(), 0u);
  EXPECT_EQ(gauges.Take(0b110), 0u);
  EXPECT_EQ(gauges.Take(0b110), 0u);
  EXPECT_EQ(gauges.monitor.missing(), 0u);
  EXPECT_EQ(gauges.Take(0b110), 0b001u);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(gauges.monitor.missing(), 0b001u);
    EXPECT_EQ(gauges.Take(0b110), 0u) << "told already";
  }
}

TEST(GaugeMonitor, ASampleWithTheChannelBeginsTheCountAgain) {
  Gauges gauges;
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(gauges.Take(0b101), 0u);
    EXPECT_EQ(gauges.Take(0b101), 0u);
    EXPECT_EQ(gauges.Take(0b111), 0u);
  }
  for (int k = 0; k < 5; ++k) gauges.Take(0b101);
  EXPECT_EQ(gauges.monitor.missing(), 0b010u);
  gauges.Take(0b111);
  EXPECT_EQ(gauges.monitor.missing(), 0u);
}

TEST(GaugeMonitor, EachChannelHasItsOwnTime) {
  Gauges gauges;
  EXPECT_EQ(gauges.Take(0b110), 0u);
  EXPECT_EQ(gauges.Take(0b010), 0u);
  EXPECT_EQ(gauges.Take(0b010), 0b001u);
  EXPECT_EQ(gauges.Take(0b010), 0b100u);
  EXPECT_EQ(gauges.monitor.missing(), 0b101u);
}

TEST(GaugeMonitor, AChannelThatComesAndGoesIsToldOnceARun) {
  Gauges gauges;
  std::uint32_t told = 0;
  for (int k = 0; k < 40; ++k) told += gauges.Take(k % 8 < 4 ? 0b011 : 0b111);
  EXPECT_EQ(told, 0b100u);
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(gauges.Take(0b011, SafetyState::kArmed), 0u) << "between the runs nothing is new";
  }
  EXPECT_EQ(gauges.Take(0b011), 0b100u) << "the next run";
  EXPECT_EQ(gauges.Take(0b011), 0u);
}

TEST(GaugeMonitor, AChannelThatIsMissingBeforeARunIsToldThenToo) {
  Gauges gauges;
  std::uint32_t told = 0;
  for (int k = 0; k < 5; ++k) told += gauges.Take(0b110, SafetyState::kArmed);
  EXPECT_EQ(told, 0b001u);
}

TEST(GaugeMonitor, LooksAtTheChannelsOfTheRigAlone) {
  Gauges gauges;
  for (int k = 0; k < 5; ++k) EXPECT_EQ(gauges.Take(0b111), 0u) << "the rig has no channel 4";
}

}  // namespace
}  // namespace flexarm
