#include "hal/canopen/canopen_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "hal/canopen/can_frame.h"
#include "tests/hal/canopen/canopen_bench.h"

namespace flexarm {
namespace {

TEST(CanopenConfig, TheBenchConfigHasNoProblems) {
  EXPECT_TRUE(BenchConfig().Problems("").empty());
}

// Each rule violated once: the key that must be named.
TEST(CanopenConfig, EachViolatedRuleNamesItsKey) {
  struct Case {
    const char* key;
    void (*spoil)(CanopenConfig*);
  };
  const std::array cases = {
      Case{"interface", [](CanopenConfig* c) { c->interface = ""; }},
      Case{"interface", [](CanopenConfig* c) { c->interface = "sixteen_letters_"; }},
      Case{"bitrate_bps", [](CanopenConfig* c) { c->bitrate_bps = 300'000; }},
      Case{"period_ms", [](CanopenConfig* c) { c->period_ms = 0.0; }},
      Case{"master_node_id", [](CanopenConfig* c) { c->master_node_id = 128; }},
      Case{"node[0].node_id", [](CanopenConfig* c) { c->master_node_id = 1; }},
      Case{"node", [](CanopenConfig* c) { c->node.clear(); }},
      Case{"node",
           [](CanopenConfig* c) { c->node.resize(9, BenchDrive(CanopenRole::kDrive1, 1)); }},
      Case{"node[2].node_id", [](CanopenConfig* c) { c->node[2].node_id = 0; }},
      Case{"node[3].node_id", [](CanopenConfig* c) { c->node[3].node_id = 11; }},
      Case{"node[5].role", [](CanopenConfig* c) { c->node[5].role = CanopenRole::kHub1; }},
      Case{"node[0].vendor", [](CanopenConfig* c) { c->node[0].vendor = 0; }},
      Case{"node[0].torque_per_mille_nm",
           [](CanopenConfig* c) { c->node[0].torque_per_mille_nm = 0.0; }},
      Case{"node[0].torque_per_mille_nm",
           [](CanopenConfig* c) {
             c->node[0].torque_per_mille_nm = std::numeric_limits<double>::quiet_NaN();
           }},
      Case{"node[1].sign", [](CanopenConfig* c) { c->node[1].sign = 0; }},
      Case{"node[1].gear", [](CanopenConfig* c) { c->node[1].gear = 0.0; }},
      Case{"node[0].torque_range_nm", [](CanopenConfig* c) { c->node[0].torque_range_nm = 0.02; }},
      Case{"node[0].torque_range_nm", [](CanopenConfig* c) { c->node[0].torque_range_nm = 151; }},
      Case{"node[2].role", [](CanopenConfig* c) { c->node[2].sign = 1; }},
      Case{"node[4].position_is_rotor",
           [](CanopenConfig* c) { c->node[0].position_is_rotor = true; }},
      Case{"answer_timeout_ms", [](CanopenConfig* c) { c->answer_timeout_ms = 2.0; }},
      Case{"answer_timeout_ms", [](CanopenConfig* c) { c->answer_timeout_ms = 11.0; }},
      Case{"answer_timeout_ms", [](CanopenConfig* c) { c->bitrate_bps = 250'000; }},
      Case{"sdo_timeout_ms", [](CanopenConfig* c) { c->sdo_timeout_ms = 0; }},
      Case{"boot_timeout_ms", [](CanopenConfig* c) { c->boot_timeout_ms = 0; }},
      Case{"node_heartbeat_ms", [](CanopenConfig* c) { c->node_heartbeat_ms = 0; }},
      Case{"node_timeout_ms", [](CanopenConfig* c) { c->node_timeout_ms = 99; }},
      Case{"master_timeout_ms", [](CanopenConfig* c) { c->master_timeout_ms = 49; }},
      Case{"master_timeout_ms", [](CanopenConfig* c) { c->master_timeout_ms = 201; }},
  };
  for (const Case& c : cases) {
    CanopenConfig config = BenchConfig();
    c.spoil(&config);
    const std::vector<Problem> problems = config.Problems("hal.canopen[0].");
    ASSERT_FALSE(problems.empty()) << c.key;
    EXPECT_EQ(problems[0].key, std::string("hal.canopen[0].") + c.key);
    EXPECT_FALSE(problems[0].rule.empty());
  }
}

// A slow bus with a slow loop, and the heartbeats of six nodes every 5 ms: 62 % for them alone.
TEST(CanopenConfig, ABusTooSlowForItsNodesIsRejected) {
  CanopenConfig config = BenchConfig();
  config.bitrate_bps = 125'000;
  config.period_ms = 60.0;
  config.answer_timeout_ms = 25.0;
  config.master_timeout_ms = 150;
  ASSERT_TRUE(config.Problems("").empty());
  config.node_heartbeat_ms = 5;
  const std::vector<Problem> problems = config.Problems("");
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].key, "bitrate_bps");
}

// By hand, at 1 Mbit/s, in microseconds: one frame that had begun 135, SYNC 55, the daemon's
// heartbeat 65; a drive: command 95, answer 135, heartbeat 65, emergency 135; an encoder: answer
// 95, heartbeat 65, emergency 135.
TEST(CanopenConfig, TheWorstCaseIsTheSumOfAllFramesAtTheirLongest) {
  const CanopenConfig config = BenchConfig();
  EXPECT_EQ(config.wire_time_ns(), (135 + 55 + 65 + 2 * 430 + 4 * 295) * 1000);
  EXPECT_EQ(config.worst_case_exchange_ns(), 6 * kMs);
}

// 50 exchanges a second of 55 + 65 + 2 (95 + 135) + 4 * 95 bits, and 20 heartbeats of 6 nodes.
TEST(CanopenConfig, TheBusLoadIsTheSumOfTheFramesPerSecond) {
  EXPECT_DOUBLE_EQ(BenchConfig().bus_load(), (50.0 * 960.0 + 20.0 * 6.0 * 65.0) / 1e6);
}

TEST(CanopenConfig, NodesProvideTheCountersOfTheFrame) {
  const CanopenConfig config = BenchConfig();
  EXPECT_EQ(config.node[0].counter(), -1);
  EXPECT_EQ(config.node[2].counter(), 0);
  EXPECT_EQ(config.node[5].counter(), 3);
  CanopenNodeConfig drive = config.node[1];
  drive.position_is_rotor = true;
  EXPECT_EQ(drive.counter(), 3);
}

// 0.03 N m per 0.1 % is 30 N m at the output, 6 N m at the motor before its gear of 5.
TEST(CanopenConfig, RatedTorqueAndRangeFollowFromTheTorquePerMille) {
  const CanopenNodeConfig drive = BenchDrive(CanopenRole::kDrive1, 1);
  EXPECT_DOUBLE_EQ(drive.rated_motor_torque_mnm(), 6000.0);
  EXPECT_EQ(drive.torque_range_per_mille(), 1200);
  CanopenNodeConfig rounded = drive;  // 0.3 / 0.1 is 2.9999999999999996
  rounded.torque_per_mille_nm = 0.1;
  rounded.torque_range_nm = 0.3;
  EXPECT_EQ(rounded.torque_range_per_mille(), 3);
}

}  // namespace
}  // namespace flexarm
