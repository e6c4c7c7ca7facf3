#include "controller/operator/run_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/controller/operator/operator_records.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

struct RunWarningsTest : testing::Test {
  RunWarningsTest() {
    tick.input.safety_state = SafetyState::kRunning;
    tick.output.strain_used = 0b11;
  }

  // One step of which a warning comes; returns it, after comparing it with the journal.
  RunEvent TheWarning(std::int64_t now_ns) {
    warnings.Take(now_ns, tick);
    const std::vector<RunEvent> logged = TakeEvents(&events);
    EXPECT_EQ(logged.size(), 1u);
    if (logged.size() != 1 || journal.lines.size() != 1) return {};
    EXPECT_EQ(logged[0].kind, "warning");
    EXPECT_EQ(logged[0].time_ns, now_ns);
    EXPECT_EQ(journal.lines[0], RecordedJournal::Line(true, logged[0].text));
    EXPECT_THAT(logged[0].text, HasSubstr(logged[0].value_json)) << "the figures";
    return logged[0];
  }

  EventQueue events{64};
  RecordedJournal journal;
  RunWarnings warnings{kPeriodNs, 0.008, {"strain_1_01", "strain_2_01"}, &events, journal.Report()};
  TickRecord tick{};
};

TEST_F(RunWarningsTest, ALateTorqueWarnsOfTheDelayMargin) {
  warnings.Take(0, tick);
  tick.input.acted_late_ns = 5 * kMs;  // predicted: 0; margin: 8 ms
  const RunEvent warning = TheWarning(kPeriodNs);
  EXPECT_EQ(warning.name, "delay-margin");
  EXPECT_EQ(Json::parse(warning.value_json), Json({{"delay_ms", 25.0}, {"delay_margin_ms", 3.0}}));
  EXPECT_THAT(warning.text, HasSubstr("loop.actuation_delay_ms"));
  EXPECT_DOUBLE_EQ(warnings.delay().delay_ms(), 25.0) << "for the status";
}

TEST_F(RunWarningsTest, AFoundDelayIsToldWithWhatTheLoopDoesAboutIt) {
  tick.output.delay_found = 2;
  const RunEvent warning = TheWarning(0);
  EXPECT_EQ(warning.name, "delay-found");
  EXPECT_EQ(Json::parse(warning.value_json), Json({{"delay_found", 2}, {"delay_ms", 60.0}}))
      << "one period and two samples";
  EXPECT_THAT(warning.text,
              testing::EndsWith("; the loop compensates for this delay until the arm is armed "
                                "again; set loop.actuation_delay_ms"));
}

TEST_F(RunWarningsTest, AWarningOfThePayloadHasItsFigures) {
  tick.output.payload_kg = 0.4;
  tick.output.payload_warnings = kPayloadModelMismatch;
  const RunEvent warning = TheWarning(0);
  EXPECT_EQ(warning.name, "payload-model-mismatch");
  EXPECT_EQ(Json::parse(warning.value_json)["kg"], 0.4);
}

TEST_F(RunWarningsTest, AGaugeThatIsMissingForThreeSamplesIsNamed) {
  tick.output.strain_used = 0b01;
  warnings.Take(0, tick);
  warnings.Take(kPeriodNs, tick);
  EXPECT_TRUE(TakeEvents(&events).empty());
  EXPECT_TRUE(warnings.missing_gauges().empty());
  const RunEvent warning = TheWarning(2 * kPeriodNs);
  EXPECT_EQ(warning.name, "gauges-missing");
  EXPECT_EQ(Json::parse(warning.value_json), Json({{"gauges", {"strain_2_01"}}}));
  EXPECT_THAT(warnings.missing_gauges(), testing::ElementsAre("strain_2_01"));
  warnings.Take(3 * kPeriodNs, tick);
  EXPECT_TRUE(TakeEvents(&events).empty()) << "once a run";
  tick.output.strain_used = 0b11;
  warnings.Take(4 * kPeriodNs, tick);
  EXPECT_TRUE(warnings.missing_gauges().empty()) << "for the status: at once";
}

TEST_F(RunWarningsTest, AGaugeThatMissesSingleSamplesIsNoNews) {
  for (int k = 0; k < 30; ++k) {
    tick.output.strain_used = k % 3 == 0 ? 0b11 : 0b10;
    warnings.Take(k * kPeriodNs, tick);
  }
  EXPECT_TRUE(TakeEvents(&events).empty());
}

TEST_F(RunWarningsTest, SeveralOfOneStepComeInTheirOrder) {
  warnings.Take(0, tick);
  tick.input.acted_late_ns = 5 * kMs;
  tick.output.payload_warnings = kPayloadNotObservable | kPayloadAtBound;
  tick.output.delay_found = 1;
  warnings.Take(kPeriodNs, tick);
  std::vector<std::string> names;
  for (const RunEvent& event : TakeEvents(&events)) names.push_back(event.name);
  EXPECT_THAT(names, testing::ElementsAre("delay-margin", "payload-at-bound",
                                          "payload-not-observable", "delay-found"));
}

TEST_F(RunWarningsTest, EachComesOnceARun) {
  tick.output.delay_found = 1;
  tick.output.payload_warnings = kPayloadAtBound;
  for (int k = 0; k < 3; ++k) warnings.Take(k * kPeriodNs, tick);
  EXPECT_EQ(TakeEvents(&events).size(), 2u);
  tick.input.safety_state = SafetyState::kArmed;
  warnings.Take(3 * kPeriodNs, tick);
  tick.input.safety_state = SafetyState::kRunning;
  warnings.Take(4 * kPeriodNs, tick);
  EXPECT_EQ(TakeEvents(&events).size(), 2u) << "of the next run";
}

TEST_F(RunWarningsTest, AStepWithinItsLimitsGivesNone) {
  for (int k = 0; k < 3; ++k) warnings.Take(k * kPeriodNs, tick);
  EXPECT_TRUE(TakeEvents(&events).empty());
  EXPECT_TRUE(journal.lines.empty());
}

}  // namespace
}  // namespace flexarm
