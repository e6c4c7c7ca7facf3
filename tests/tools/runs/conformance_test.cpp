// A run that violates one rule of `flexarm check` fails that rule and no other.

#include "tools/runs/conformance.h"

#include <cmath>
#include <functional>

#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSafetyTickNs = 1'000'000;

LoadedRun GoodRun() {
  LoadedRun run{.file = "run",
                .state = RunState::kClosed,
                .left_out_bytes = 0,
                .digest = "",
                .digest_holds = true,
                .contents = {},
                .config = {},
                .experiment = {}};
  run.config.loop.period_ms = 20;
  run.config.safety.torque_limit_nm = {30, 6};
  run.config.safety.permit_timeout_ms = 5;
  run.config.safety.slew_limit_nm_per_s = {500, 150};
  run.contents.info.result_json = "{}";
  // Armed before tick 1, Running from tick 4 on, at rest after tick 7.
  SafetyRecord grant =
      MakeSafety(3 * kTestPeriodNs, {SafetyState::kArmed, TripCause::kNone}, RequestKind::kRun);
  grant.request_number = 12;
  run.contents.safety = {
      MakeSafety(0, kIdleStatus, RequestKind::kArm), grant,
      MakeSafety(7 * kTestPeriodNs, grant.after, RequestKind::kStop),
      MakeSafety(7 * kTestPeriodNs + kSafetyTickNs, {SafetyState::kStopping, TripCause::kNone},
                 RequestKind::kNone)};
  for (int tick = 1; tick <= 10; ++tick) {
    TickRecord record{};
    record.input.tick = record.output.tick = tick;
    record.input.now_ns = tick * kTestPeriodNs;
    record.input.sampling_instant_ns = record.input.now_ns - kTestPeriodNs / 2;
    record.input.reset = tick == 1 ? 1 : 0;
    const bool running = tick > 3 && tick < 8;
    record.input.safety_state = running ? SafetyState::kRunning : SafetyState::kArmed;
    if (running) record.output.torque_nm = record.input.applied_torque_nm = {5, 1};
    run.contents.tick.push_back(record);
  }
  return run;
}

std::vector<std::string> Broken(const std::function<void(LoadedRun*)>& damage) {
  LoadedRun run = GoodRun();
  damage(&run);
  std::vector<std::string> names;
  for (const ConformanceCheck& check : CheckConformance(run)) {
    if (!check.passed) names.push_back(check.name);
    EXPECT_EQ(check.passed, check.detail.empty()) << check.name;
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(Conformance, ACorrectRunViolatesNoRule) {
  EXPECT_EQ(Broken([](LoadedRun*) {}), Names{});
}

TEST(Conformance, EachRuleDetectsItsOwnViolation) {
  const auto tick = [](LoadedRun* run, int number) -> TickRecord& {
    return run->contents.tick[static_cast<std::size_t>(number) - 1];
  };
  EXPECT_EQ(
      Broken([](LoadedRun* run) { run->contents.tick.erase(run->contents.tick.begin() + 4); }),
      Names{"no-gap"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 5).input.now_ns -= kTestPeriodNs; }),
            Names{"time-runs-forward"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 1).input.reset = 0; }),
            Names{"begins-with-reset"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 5).output.tick = 4; }),
            Names{"output-belongs-to-input"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 5).output.torque_nm[1] = std::nan(""); }),
            Names{"torque-finite"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { run->config.safety.torque_limit_nm[0] = 4.9; }),
            Names{"torque-limit"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 5).input.applied_torque_nm[1] = 4.1; }),
            Names{"slew-limit"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 9).input.applied_torque_nm[0] = 0.1; }),
            Names{"torque-only-where-allowed"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 2).output.torque_nm[0] = 0.1; }),
            Names{"torque-only-where-allowed"});
  EXPECT_EQ(Broken([](LoadedRun* run) { run->state = RunState::kLeft; }), Names{"closed"});
  EXPECT_EQ(
      Broken([](LoadedRun* run) { run->contents.info.result_json = R"({"recovered":true})"; }),
      Names{"closed"});
  EXPECT_EQ(Broken([](LoadedRun* run) { run->contents.tick.clear(); }), Names{"has-ticks"});
}

// Each damage is one that some other rule does not see, or the rules that see it.
TEST(Conformance, EachRuleOfTheSafetyRecordsDetectsItsOwnViolation) {
  const auto records = [](LoadedRun* run) -> std::vector<SafetyRecord>& {
    return run->contents.safety;
  };
  EXPECT_EQ(Broken([&](LoadedRun* run) { records(run)[3].facts.at_rest = 0; }),
            Names{"safety-table"})
      << "Stopping ended although the arm was not at rest";
  EXPECT_EQ(Broken([&](LoadedRun* run) { records(run)[2].refusal = Refusal::kWrongState; }),
            Names{"safety-table"})
      << "a stop was refused and carried out";
  EXPECT_EQ(Broken([&](LoadedRun* run) { records(run)[3].due_ns -= 2 * kSafetyTickNs; }),
            Names{"safety-chain"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { records(run).erase(records(run).begin() + 2); }),
            Names{"safety-chain"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { records(run)[1].request_number = 0; }),
            Names{"running-was-granted"});
  EXPECT_EQ(Broken([](LoadedRun* run) {
              run->contents.tick[5].input.safety_state = SafetyState::kStopping;
            }),
            Names{"state-from-safety"});
  EXPECT_EQ(Broken([](LoadedRun* run) { run->contents.tick[7].input.applied_torque_nm = {1, 0}; }),
            Names{})
      << "torque of the period in which the stop came";
  EXPECT_EQ(Broken([&](LoadedRun* run) { records(run).clear(); }), Names{"safety-table"});
}

// Behind the good run: a trip of the armed arm, and what follows it.
LoadedRun TrippedRun() {
  LoadedRun run = GoodRun();
  const SafetyStatus armed{SafetyState::kArmed, TripCause::kNone};
  SafetyRecord trip = MakeSafety(11 * kTestPeriodNs, armed, RequestKind::kNone,
                                 CauseBit(TripCause::kEmergencyStop));
  SafetyRecord waits = MakeSafety(12 * kTestPeriodNs, trip.after, RequestKind::kReset);
  SafetyRecord reset = waits;
  reset.due_ns = 13 * kTestPeriodNs;
  reset.facts.reset_pressed = 1;
  reset.after = kIdleStatus;
  reset.refusal = Refusal::kNone;
  run.contents.safety.insert(run.contents.safety.end(), {trip, waits, reset});
  return run;
}

TEST(Conformance, ATripIsLatchedUntilTheButtonAndTheReset) {
  const auto broken = [](std::size_t from_end, const std::function<void(SafetyRecord*)>& damage) {
    LoadedRun run = TrippedRun();
    damage(&run.contents.safety[run.contents.safety.size() - from_end]);
    Names names;
    for (const ConformanceCheck& check : CheckConformance(run)) {
      if (!check.passed) names.push_back(check.name);
    }
    return names;
  };
  EXPECT_EQ(broken(1, [](SafetyRecord*) {}), Names{});
  EXPECT_EQ(broken(1, [](SafetyRecord* reset) { reset->facts.reset_pressed = 0; }),
            (Names{"safety-table", "trip-latched"}));
  EXPECT_EQ(broken(1, [](SafetyRecord* reset) { reset->facts.request = RequestKind::kNone; }),
            (Names{"safety-table", "trip-latched"}));
  EXPECT_EQ(broken(1, [](SafetyRecord* reset) { reset->after.state = SafetyState::kArmed; }),
            (Names{"safety-table", "trip-latched"}));
  EXPECT_EQ(broken(2, [](SafetyRecord* waits) { waits->after.cause = TripCause::kBusLost; }),
            (Names{"safety-table", "safety-chain", "trip-latched"}));
  EXPECT_EQ(broken(2, [](SafetyRecord* waits) { waits->after.state = SafetyState::kRunning; }),
            (Names{"safety-table", "safety-chain", "trip-latched", "running-was-granted"}));
}

TEST(Conformance, AViolationIsToldWithItsTimeItsRecordAndItsRule) {
  LoadedRun run = GoodRun();
  run.contents.safety[3].facts.at_rest = 0;
  for (const ConformanceCheck& check : CheckConformance(run)) {
    if (check.name != "safety-table") continue;
    EXPECT_EQ(check.record, 4);
    EXPECT_DOUBLE_EQ(check.time_s.value_or(0), 0.141);  // 7 periods of 20 ms and a safety tick
    EXPECT_EQ(check.detail,
              "record 4: Stopping to Armed, request none; the table requires Stopping (no row "
              "holds: the state stays)");
  }
  run.contents.safety[3].facts.at_rest = 1;
  run.contents.safety[3].after.state = SafetyState::kStopping;
  for (const ConformanceCheck& check : CheckConformance(run)) {
    if (check.name != "safety-table") continue;
    EXPECT_EQ(check.detail,
              "record 4: Stopping to Stopping, request none; the table requires Armed (row "
              "Stopping, !cause_present && at_rest: Armed)");
  }
}

}  // namespace
}  // namespace flexarm
