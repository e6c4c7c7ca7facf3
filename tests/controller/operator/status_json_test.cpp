#include "controller/operator/status_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimator/payload_knowledge.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

struct StatusJsonTest : testing::Test {
  StatusJsonTest() {
    for (const int link : {1, 2, 2}) {
      sensors.strain.push_back({.link = link,
                                .position_m = 0.1,
                                .face = 1,
                                .gain_v_per_unit = 1.0,
                                .offset_counts = 0.0});
    }
    now.now_ns = 1'500 * kMs;
    now.permit.state = SafetyState::kArmed;
    now.tick.output.payload_kg = std::numeric_limits<double>::quiet_NaN();
  }

  Json Status() const { return StatusOf(latch); }

  Json StatusOf(const TripLatch& of) const {
    return StatusJson({.now = &now,
                       .delay = &delay,
                       .sensors = &sensors,
                       .angles = &angles,
                       .missing_gauges = missing_gauges,
                       .experiment = experiment,
                       .buses = buses,
                       .bus_text = [this](TripCause, const Evidence&) { return bus_text; },
                       .present = &present,
                       .latch = &of,
                       .threads = Json::array({"control"}),
                       .host = nullptr,
                       .design = {{"verdict", "forced"}},
                       .overrides = Json::array({"host"}),
                       .switches = {{"proved", true}},
                       .log = nullptr,
                       .telemetry = {{"sent", 7}},
                       .health = nullptr,
                       .identity = {{"rig", "thesis"}, {"version", "1.2"}},
                       .lease = nullptr,
                       .run = nullptr,
                       .why_no_run = why_no_run});
  }

  OperatorSnapshot now;
  DelayMonitor delay{kPeriodNs, 0.009};
  SensorConfig sensors{};
  AngleKnowledge angles{AnglesAtStart::kAtZero, sensors};
  std::vector<std::string> missing_gauges;
  std::string experiment;
  std::vector<BusHealth> buses;
  std::string bus_text;
  PresentCauses present;
  std::string why_no_run;
  LatchFolder folder;
  TripLatch latch{folder.path(), "/runs", [](bool, const std::string&) {}};
};

TEST_F(StatusJsonTest, TheVersionOfTheProtocolIsThatOfItsPage) {
  EXPECT_EQ(Status()["protocol"], 1);
}

TEST_F(StatusJsonTest, AnglesAreInDegreesAndTimesInTheirUnit) {
  now.tick.output.angle_rad = {M_PI / 6.0, -M_PI / 2.0, 9.0, 9.0};
  now.tick.input.tick = 75;
  now.tick.output.torque_nm = {1.5, -0.5};
  now.tick.output.at_rest = 1;
  const Json status = Status();
  EXPECT_TRUE(status["ok"]);
  EXPECT_EQ(status["state"], "Armed");
  EXPECT_DOUBLE_EQ(status["time_s"], 1.5);
  EXPECT_EQ(status["tick"], 75);
  EXPECT_NEAR(status["joint_angle_deg"][0], 30.0, 1e-12);
  EXPECT_NEAR(status["joint_angle_deg"][1], -90.0, 1e-12);
  EXPECT_EQ(status["joint_angle_deg"].size(), 2u) << "hubs, not rotors";
  EXPECT_EQ(status["torque_nm"], Json({1.5, -0.5}));
  EXPECT_EQ(status["at_rest"], true);
  EXPECT_DOUBLE_EQ(status["delay_margin_ms"], 9.0);
  EXPECT_EQ(status["threads"], Json({"control"}));
  EXPECT_TRUE(status["host"].is_null());
  EXPECT_EQ(status["design"]["verdict"], "forced");
  EXPECT_EQ(status["overrides"], Json({"host"}));
  EXPECT_EQ(status["switches"]["proved"], true);
  EXPECT_EQ(status["telemetry"]["sent"], 7);
}

TEST_F(StatusJsonTest, GaugesThatAreMissingAreNamedAndUnknownStrainIsNull) {
  EXPECT_EQ(Status()["gauges_missing"], Json::array());
  missing_gauges = {"strain_1_03"};
  now.tick.output.root_strain = {1e-4, std::numeric_limits<double>::quiet_NaN()};
  const Json status = Json::parse(Status().dump());
  EXPECT_EQ(status["gauges_missing"], Json({"strain_1_03"}));
  EXPECT_DOUBLE_EQ(status["root_strain"][0], 1e-4);
  EXPECT_TRUE(status["root_strain"][1].is_null());
}

TEST_F(StatusJsonTest, EachGaugeHasItsCountsItsStrainAndItsAge) {
  EXPECT_EQ(Status()["gauges"], Json::array()) << "before the first sample";
  sensors.strain_input.converter_bits = 12;
  sensors.strain_input.range_v = 5.0;
  sensors.strain[1].face = -1;
  now.tick.input.now_ns = 1'490 * kMs;
  now.tick.input.frame.sampled_at_ns = 1'480 * kMs;
  now.tick.input.frame.strain = {100, 100, -50};
  now.tick.input.frame.strain_offset_ns = {0, 2'000'000, -700 * 1'000'000};
  now.tick.input.calibration.strain_zero_counts = {0.0F, 20.0F, 0.0F};
  now.tick.output.strain_used = 0b011;
  const Json gauges = Status()["gauges"];
  ASSERT_EQ(gauges.size(), 3u);
  // 10 V on 4096 counts, 1 V a unit of strain.
  EXPECT_EQ(gauges[0], Json({{"name", "strain_1_01"},
                             {"link", 1},
                             {"counts", 100},
                             {"counts_limit", 2047},
                             {"strain", 1000.0 / 4096.0},
                             {"used", true},
                             {"age_ms", 20.0}}));
  EXPECT_DOUBLE_EQ(gauges[1]["strain"], -800.0 / 4096.0) << "its zero, and the other face";
  EXPECT_EQ(gauges[1]["age_ms"], 18.0) << "read 2 ms after the instant";
  EXPECT_EQ(gauges[2]["age_ms"], 720.0) << "the last good reading of a bus that is lost";
  EXPECT_EQ(gauges[2]["used"], false);
}

TEST_F(StatusJsonTest, EncodersAreShownWhetherOrNotTheAngleIsKnown) {
  sensors.encoder = {{.counter = 0, .counts_per_turn = 3600.0, .counter_bits = 16, .sign = 1},
                     {.counter = 3, .counts_per_turn = 3600.0, .counter_bits = 16, .sign = 1}};
  EXPECT_EQ(Status()["encoders"], Json::array()) << "before the first sample";
  angles = AngleKnowledge(AnglesAtStart::kLost, sensors);
  now.tick.input.now_ns = 1'490 * kMs;
  now.tick.input.frame.sampled_at_ns = 1'480 * kMs;
  now.tick.output.counts = {900, 1, 1, -7};
  now.tick.output.angle_rad = {M_PI / 2.0, 0.0, 0.0, 0.0};
  now.tick.output.counters_used = 0b0001;
  const Json status = Status();
  EXPECT_TRUE(status["joint_angle_deg"][0].is_null());
  ASSERT_EQ(status["encoders"].size(), 2u) << "the rig has no others";
  EXPECT_EQ(status["encoders"][0], Json({{"name", "hub1"},
                                         {"counts", 900},
                                         {"angle_deg", 90.0},
                                         {"used", true},
                                         {"age_ms", 20.0}}));
  EXPECT_EQ(status["encoders"][1]["name"], "rotor2");
  EXPECT_EQ(status["encoders"][1]["counts"], -7);
  EXPECT_EQ(status["encoders"][1]["used"], false);
}

TEST_F(StatusJsonTest, SampleAndPermitHaveTheirAge) {
  now.permit.renewed_ns = INT64_MIN;
  EXPECT_TRUE(Status()["tick_age_ms"].is_null()) << "there is none yet";
  EXPECT_TRUE(Status()["permit_age_ms"].is_null());
  now.tick.input.now_ns = 1'490 * kMs;
  now.permit.renewed_ns = 1'499 * kMs;
  EXPECT_EQ(Status()["tick_age_ms"], 10.0);
  EXPECT_EQ(Status()["permit_age_ms"], 1.0);
}

TEST_F(StatusJsonTest, ReferenceAndSourceOfTheTorqueAreThoseOfTheSample) {
  now.tick.input.reference_now.x_m = {M_PI / 6.0, -M_PI / 3.0};
  now.tick.input.reference_next.x_m = {M_PI / 2.0, 0.0};
  now.tick.output.x_hat = {0.0, 0.0, 0.0, 0.0, 1.5, -2.5};  // R8: four coordinates, four rates
  now.tick.input.safety_state = SafetyState::kArmed;
  EXPECT_TRUE(Status()["reference_deg"].is_null()) << "no torque";
  EXPECT_TRUE(Status()["torque_source"].is_null());
  EXPECT_EQ(Status()["hub_rate_rad_s"], Json({1.5, -2.5}));
  now.tick.input.safety_state = SafetyState::kRunning;
  EXPECT_NEAR(Status()["reference_deg"][0], 30.0, 1e-12);
  EXPECT_NEAR(Status()["reference_deg"][1], -60.0, 1e-12);
  EXPECT_EQ(Status()["torque_source"], "law");
  now.tick.input.safety_state = SafetyState::kFaultStopping;
  EXPECT_EQ(Status()["torque_source"], "stop-controller");
  now.tick.input.mode = LoopMode::kOpenLoop;
  EXPECT_EQ(Status()["torque_source"], "open-loop");
  now.tick.input.mode = LoopMode::kRegulate;
  EXPECT_EQ(Status()["torque_source"], "regulator");
  EXPECT_NEAR(Status()["reference_deg"][0], 90.0, 1e-12) << "its goal";
}

TEST_F(StatusJsonTest, TheRelayIsClosedWhereTheSafetyMachineClosesIt) {
  EXPECT_EQ(Status()["relay_closed"], true) << "Armed";
  now.permit.state = SafetyState::kIdle;
  EXPECT_EQ(Status()["relay_closed"], false);
}

TEST_F(StatusJsonTest, EveryCauseThatIsPresentHasItsValues) {
  EXPECT_EQ(Status()["present"], Json::array());
  const auto add = [this](TripCause cause, const Evidence& evidence) {
    present.causes |= CauseBit(cause);
    present.evidence[static_cast<std::size_t>(cause)] = evidence;
  };
  add(TripCause::kStrainStuck, {.value = 3.0, .limit = 2.0, .channel = 2, .detail = 0});
  add(TripCause::kLimitSwitch1High, {.value = 0.0, .limit = 1.0, .channel = 1, .detail = 0});
  add(TripCause::kHubRate2, {});  // the loop has told the values of another
  const Json all = Status()["present"];
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0]["name"], "limit-switch-1-high");
  EXPECT_EQ(all[0]["limit"], 1.0);
  EXPECT_EQ(all[1]["name"], "hub-rate-2");
  EXPECT_TRUE(all[1]["value"].is_null());
  EXPECT_EQ(all[2]["name"], "strain-stuck");
  EXPECT_EQ(all[2]["channel_name"], "strain_2_01");
  EXPECT_EQ(all[2]["value"], 3.0);
}

TEST_F(StatusJsonTest, RigProgramInputsAndProofOfTheWiringAreShown) {
  now.permit.levels = LineBit(Line::kLimit1Low) | LineBit(Line::kResetButton);
  Json status = Status();
  EXPECT_EQ(status["rig"], "thesis");
  EXPECT_EQ(status["version"], "1.2");
  EXPECT_EQ(status["inputs"]["limit-1-low"], 1);
  EXPECT_EQ(status["inputs"]["emergency-stop"], 0);
  EXPECT_EQ(status["inputs"].size(), 6u);
  EXPECT_EQ(status["wiring"], Json({{"proved", true}, {"why_not", nullptr}}));
  why_no_run = "run pluck";
  EXPECT_EQ(Status()["wiring"], Json({{"proved", false}, {"why_not", "run pluck"}}));
}

TEST_F(StatusJsonTest, WhatThereIsNotIsNull) {
  const Json status = Status();
  EXPECT_TRUE(status["trip"].is_null());
  EXPECT_TRUE(status["payload"].is_null());
  EXPECT_TRUE(status["experiment"].is_null());
  EXPECT_EQ(status["buses"], Json::array());
}

TEST_F(StatusJsonTest, ThePayloadHasItsWarningsByName) {
  now.tick.output.payload_kg = 0.25;
  now.tick.output.payload_warnings = kPayloadAtBound | kPayloadNotObservable;
  now.tick.output.delay_found = -1;
  now.tick.input.planned = 1;
  const Json payload = Status()["payload"];
  EXPECT_EQ(payload["kg"], 0.25);
  EXPECT_EQ(payload["warnings"], Json({"payload-at-bound", "payload-not-observable"}));
  EXPECT_EQ(payload["delay_found"], -1);
  EXPECT_EQ(payload["planned"], true);
}

TEST_F(StatusJsonTest, ATripHasItsCauseItsValuesAndItsChannel) {
  now.permit.state = SafetyState::kTripped;
  now.permit.cause = TripCause::kStrainSaturated;
  now.permit.evidence = {.value = 2047.0, .limit = 2000.0, .channel = 3, .detail = 0};
  experiment = "square";
  const Json status = Status();
  EXPECT_EQ(status["experiment"], "square");
  const Json& trip = status["trip"];
  EXPECT_EQ(trip["name"], "strain-saturated");
  EXPECT_EQ(trip["number"], static_cast<int>(TripCause::kStrainSaturated));
  EXPECT_EQ(trip["value"], 2047.0);
  EXPECT_EQ(trip["limit"], 2000.0);
  EXPECT_EQ(trip["channel"], 3);
  EXPECT_EQ(trip["channel_name"], "strain_2_02");
  EXPECT_EQ(trip["text"], OperatorText(TripCause::kStrainSaturated));
  EXPECT_TRUE(trip["bus"].is_null());
}

TEST_F(StatusJsonTest, ATripHasItsTimeAndWhetherItIsFromBeforeTheStart) {
  now.permit.state = SafetyState::kTripped;
  now.permit.cause = TripCause::kSoftLimit1;
  latch.Open();
  latch.Follow(0, now.permit, false);
  EXPECT_EQ(Status()["trip"]["before_start"], false);
  EXPECT_EQ(Status()["trip"]["time_utc"], latch.trip()->time_utc);
  TripLatch next(folder.path() / "next", "/runs", [](bool, const std::string&) {});
  std::filesystem::create_directory(folder.path() / "next");
  std::filesystem::copy(folder.file(TripLatch::kFile), folder.path() / "next");
  next.Open();
  EXPECT_EQ(StatusOf(next)["trip"]["before_start"], true);
  EXPECT_EQ(StatusOf(next)["trip"]["time_utc"], latch.trip()->time_utc);
  EXPECT_TRUE(StatusOf(next)["latch_problem"].is_null());
}

TEST_F(StatusJsonTest, ARecordThatCannotBeReadOrWrittenIsNamed) {
  folder.Put(TripLatch::kFile, "garbage");
  latch.Open();
  now.permit.state = SafetyState::kTripped;
  now.permit.cause = TripCause::kTripRecordUnreadable;
  EXPECT_NE(Status()["trip"]["record_problem"].get<std::string>().find("JSON"), std::string::npos);
  EXPECT_TRUE(Status()["trip"]["time_utc"].is_null());
  now.permit.cause = TripCause::kSoftLimit1;  // another trip
  std::filesystem::remove_all(folder.path());
  latch.Follow(0, now.permit, false);
  EXPECT_NE(Status()["latch_problem"].get<std::string>().find(TripLatch::kFile), std::string::npos);
}

TEST_F(StatusJsonTest, ATripOfABusNamesTheDevice) {
  now.permit.state = SafetyState::kTripped;
  now.permit.cause = TripCause::kBusLost;
  bus_text = "can0: node 5 is silent";
  buses = {{.name = "can0",
            .ok = false,
            .fault = "node 5 is silent",
            .failed = 3,
            .recovered = 1,
            .slow = 5,
            .longest_ms = 7.5,
            .declared_ms = 6.0,
            .failed_in_window = 2,
            .slow_in_window = 4,
            .counters = {{"stale_answers", 6}, {"missed_answers", 0}}},
           {.name = "modbus", .ok = true, .fault = "", .failed = 0, .recovered = 0}};
  const Json status = Status();
  EXPECT_EQ(status["trip"]["bus"], "can0: node 5 is silent");
  EXPECT_EQ(status["buses"][0],
            Json({{"name", "can0"},
                  {"ok", false},
                  {"fault", "node 5 is silent"},
                  {"notice", nullptr},
                  {"failed", 3},
                  {"recovered", 1},
                  {"failed_in_window", 2},
                  {"slow", 5},
                  {"slow_in_window", 4},
                  {"longest_ms", 7.5},
                  {"declared_ms", 6.0},
                  {"counters", {{"stale_answers", 6}, {"missed_answers", 0}}}}));
  EXPECT_EQ(status["buses"][1]["counters"], Json::object()) << "a driver without counters";
  EXPECT_TRUE(status["buses"][1]["fault"].is_null());
}

TEST_F(StatusJsonTest, LateThreadsAreCountedAndSayWhetherTheyTrip) {
  EXPECT_EQ(Status()["timing"]["trips"], true);
  EXPECT_EQ(TimingJson({.safety_overruns = 7,
                        .oldest_permit_ns = 21'500'000,
                        .deadlines_missed = 3,
                        .deadlines_often_missed = 2},
                       false),
            Json({{"trips", false},
                  {"safety_overruns", 7},
                  {"safety_worst_ms", 21.5},
                  {"deadlines_missed_in_a_row", 3},
                  {"deadlines_often_missed", 2}}));
}

TEST_F(StatusJsonTest, AnUnknownAngleIsNullAndSaysWhy) {
  const AngleKnowledge lost{AnglesAtStart::kLost, sensors};
  angles = lost;
  angles.Know(0);
  now.tick.output.angle_rad = {M_PI / 6.0, 0.5, 0.0, 0.0};
  const Json status = Status();
  EXPECT_NEAR(status["joint_angle_deg"][0], 30.0, 1e-12);
  EXPECT_TRUE(status["joint_angle_deg"][1].is_null());
  EXPECT_TRUE(status["joint_angle_unknown"][0].is_null());
  EXPECT_EQ(status["joint_angle_unknown"][1], lost.Text(1));
}

TEST_F(StatusJsonTest, ACauseThatIsNoLongerLatchedIsNoTrip) {
  now.permit.cause = TripCause::kBusLost;
  EXPECT_TRUE(Status()["trip"].is_null()) << "Armed";
}

}  // namespace
}  // namespace flexarm
