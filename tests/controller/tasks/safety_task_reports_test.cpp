// What the safety task tells the others: causes that are present, the end of the power, records.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "controller/tasks/planned_experiment.h"
#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

namespace flexarm {
namespace {

using enum SafetyState;

TEST_F(SafetyTaskTest, WhatIsPresentIsPublishedWithItsEvidenceUntilItIsGone) {
  GoTo(kIdle);
  EXPECT_EQ(present_.Read().causes, 0U);
  control_.report.faults = CauseBit(TripCause::kHubRate2);
  control_.report.evidence = {.value = 14.0, .limit = 12.0, .channel = 2, .detail = 0};
  lines_.levels &= ~LineBit(Line::kLimit1High);
  RunFor(40 * kMs);
  const PresentCauses& present = present_.Read();
  EXPECT_EQ(present.causes,
            CauseBit(TripCause::kHubRate2) | CauseBit(TripCause::kLimitSwitch1High));
  EXPECT_EQ(present.evidence[static_cast<std::size_t>(TripCause::kHubRate2)].value, 14.0);
  EXPECT_EQ(present.evidence[static_cast<std::size_t>(TripCause::kLimitSwitch1High)].channel, 1U);
  control_.report.faults = 0;
  lines_.levels = kHealthyLevels;
  RunFor(40 * kMs);
  EXPECT_EQ(present_.Read().causes, 0U);
}

// The buses are woken so that the drives learn at once that they are off.
TEST_F(SafetyTaskTest, WakesTheBusesWhenThePowerGoesAndOnlyThen) {
  GoTo(kRunning);
  EXPECT_FALSE(wakeup_.Take());
  stop_.Set(++number_);
  control_.report.at_rest = true;
  RunFor(100 * kMs);
  ASSERT_EQ(safety_.status().state, kArmed);
  EXPECT_FALSE(wakeup_.Take()) << "the drives stay on";
  lines_.levels &= ~LineBit(Line::kEmergencyStop);
  RunUntilTripped(10 * kMs);
  EXPECT_TRUE(wakeup_.Take());
  RunFor(100 * kMs);
  EXPECT_FALSE(wakeup_.Take()) << "once";
}

TEST_F(SafetyTaskTest, ThePermitHasTheRunThatWasGranted) {
  const PlannedExperiment experiment{std::vector<std::array<double, 2>>(10)};
  GoTo(kArmed);
  EXPECT_EQ(permit().run_number, 0U);
  Ask(RequestKind::kReset);  // refused
  const std::uint32_t run = Ask(RequestKind::kRun, INT64_MIN, {.experiment = &experiment});
  RunFor(2 * kMs);
  ASSERT_EQ(safety_.status().state, kRunning);
  EXPECT_EQ(permit().run_number, run);
  EXPECT_EQ(permit().run.experiment, &experiment);
}

TEST_F(SafetyTaskTest, ARecordHasTheNumberOfItsRequestOrNone) {
  GoTo(kRunning);
  const std::uint32_t disarm = Ask(RequestKind::kDisarm);
  RunFor(kMs);
  std::uint32_t last = 0;
  for (const SafetyRecord& record : Records()) {
    EXPECT_EQ(record.request_number == 0, record.facts.request == RequestKind::kNone);
    if (record.request_number != 0) last = record.request_number;
  }
  EXPECT_EQ(last, disarm);
}

// With the same facts in both ticks: Stopping ends, and an armed arm is disarmed.
TEST_F(SafetyTaskTest, EachTransitionIsRecordedThoughTheFactsAreTheSame) {
  GoTo(kRunning);
  control_.report.at_rest = true;
  RunFor(100 * kMs);
  shutting_down_ = true;
  RunFor(200 * kMs);
  ASSERT_EQ(safety_.status().state, kIdle);
  const std::vector<SafetyRecord> records = Records();
  for (std::size_t i = 1; i < records.size(); ++i) {
    EXPECT_EQ(records[i].before, records[i - 1].after) << i;
  }
  EXPECT_EQ(records.back().after.state, kIdle);
}

}  // namespace
}  // namespace flexarm
