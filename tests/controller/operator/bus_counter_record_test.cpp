#include "controller/operator/bus_counter_record.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/controller/operator/operator_records.h"

namespace flexarm {
namespace {

using State = SafetyState;

TEST(BusCounterRecord, TheCountersAreInTheLogOfEachRunOnce) {
  EventQueue events(64);
  BusCounterRecord record(&events);
  const std::vector<BusHealth> buses = {{.name = "can0",
                                         .ok = true,
                                         .fault = "",
                                         .failed = 0,
                                         .recovered = 0,
                                         .counters = {{"stale_answers", 6}, {"missed_answers", 0}}},
                                        {.name = "gauges",
                                         .ok = true,
                                         .fault = "",
                                         .failed = 0,
                                         .recovered = 0,
                                         .counters = {{"late_bytes", 3}}}};
  std::int64_t now_ns = 0;
  const auto follow = [&](State state) { record.Follow(++now_ns, state, buses); };
  for (const State quiet : {State::kIdle, State::kArmed, State::kRunning, State::kStopping}) {
    follow(quiet);
    EXPECT_TRUE(TakeEvents(&events).empty()) << ToString(quiet);
  }
  for (const State end : {State::kArmed, State::kTripped, State::kDisarming}) {
    follow(State::kRunning);
    follow(end);
    follow(end);
    follow(State::kIdle);
    const std::vector<RunEvent> logged = TakeEvents(&events);
    ASSERT_EQ(logged.size(), 1U) << ToString(end);
    EXPECT_EQ(logged[0].kind, "counters");
    EXPECT_EQ(logged[0].time_ns, now_ns - 2);
    EXPECT_EQ(nlohmann::json::parse(logged[0].value_json),
              nlohmann::json({{"can0", {{"stale_answers", 6}, {"missed_answers", 0}}},
                              {"gauges", {{"late_bytes", 3}}}}));
  }
}

TEST(BusCounterRecord, ASimulatedArmHasNone) {
  EventQueue events(64);
  BusCounterRecord record(&events);
  record.Follow(1, State::kRunning, {});
  record.Follow(2, State::kTripped, {});
  EXPECT_TRUE(TakeEvents(&events).empty());
}

}  // namespace
}  // namespace flexarm
