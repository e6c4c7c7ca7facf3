// A run that violates one rule of `flexarm check` fails that rule and no other.

#include "tools/runs/conformance.h"

#include <functional>

#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

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
  run.config.safety.slew_limit_nm_per_s = {500, 150};
  run.contents.info.result_json = "{}";
  run.contents.safety.push_back(
      MakeSafety(0, {SafetyState::kIdle, TripCause::kNone}, RequestKind::kArm));
  for (int tick = 1; tick <= 10; ++tick) {
    TickRecord record{};
    record.input.tick = record.output.tick = tick;
    record.input.now_ns = tick * kTestPeriodNs;
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
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 5).output.torque_nm[1] = NAN; }),
            Names{"torque-finite"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { run->config.safety.torque_limit_nm[0] = 4.9; }),
            Names{"torque-limit"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 5).input.applied_torque_nm[1] = 4.1; }),
            Names{"slew-limit"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 9).input.applied_torque_nm[0] = 0.1; }),
            Names{"torque-only-where-allowed"});
  EXPECT_EQ(Broken([&](LoadedRun* run) { tick(run, 2).output.torque_nm[0] = 0.1; }),
            Names{"torque-only-where-allowed"});
  EXPECT_EQ(
      Broken([](LoadedRun* run) { run->contents.safety[0].after.state = SafetyState::kRunning; }),
      Names{"safety-replay"});
  EXPECT_EQ(Broken([](LoadedRun* run) { run->state = RunState::kLeft; }), Names{"closed"});
  EXPECT_EQ(
      Broken([](LoadedRun* run) { run->contents.info.result_json = R"({"recovered":true})"; }),
      Names{"closed"});
  EXPECT_EQ(Broken([](LoadedRun* run) { run->contents.tick.clear(); }), Names{"has-ticks"});
}

}  // namespace
}  // namespace flexarm
