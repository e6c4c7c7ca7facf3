#include "controller/telemetry/telemetry_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/controller/telemetry/telemetry_parts.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TickRecord Sample() {
  TickRecord tick{};
  tick.run_number = 1002;
  StepInput& in = tick.input;
  in.tick = 171;
  in.sampling_instant_ns = 3'420'000'000;
  in.safety_state = SafetyState::kRunning;
  in.reference_now.x_m = {M_PI / 6.0, -M_PI / 3.0};
  in.applied_torque_nm = {1.25, -0.5};
  in.frame.strain[0] = 100;
  in.frame.levels = kHealthyLevels;
  StepOutput& out = tick.output;
  out.angle_rad = {M_PI / 6.0, -M_PI / 3.0, 0.5, 0.25};
  out.counts = {217, -219, 3, 4};
  out.root_strain = {9.5e-4, kNan};
  out.payload_kg = kNan;
  out.at_rest = 1;
  out.limits = kLimitTorque2;
  return tick;
}

Json LineOf(const TickRecord& tick) {
  return Json::parse(TelemetryLine(ThesisSource(), tick, 1'764'233'100.125, 3));
}

TEST(TelemetryLine, ASampleHasItsTimesAndItsState) {
  const Json line = LineOf(Sample());
  EXPECT_EQ(line["telemetry"], kTelemetryVersion);
  EXPECT_EQ(line["rig"], "thesis-rig");
  EXPECT_EQ(line["timestamp_s"], 1'764'233'100.125);
  EXPECT_DOUBLE_EQ(line["time_s"], 3.42);
  EXPECT_EQ(line["tick"], 171);
  EXPECT_EQ(line["state"], "Running");
  EXPECT_EQ(line["state_number"], 3);
  EXPECT_EQ(line["run"], 1002);
  EXPECT_EQ(line["at_rest"], true);
  EXPECT_EQ(line["limits"], 2);
  EXPECT_EQ(line["lost"], 3);
}

TEST(TelemetryLine, AnglesAreInDegreesAndWhatIsNotKnownIsNull) {
  const Json line = LineOf(Sample());
  EXPECT_EQ(line["hub_angle_deg"], Json({30.0, -60.0}));
  EXPECT_EQ(line["reference_deg"], Json({30.0, -60.0}));
  EXPECT_EQ(line["applied_torque_nm"], Json({1.25, -0.5}));
  EXPECT_EQ(line["root_strain"], Json({9.5e-4, nullptr}));
  EXPECT_TRUE(line["payload_kg"].is_null());
  TickRecord idle = Sample();
  idle.input.safety_state = SafetyState::kIdle;
  EXPECT_EQ(LineOf(idle)["reference_deg"], Json({nullptr, nullptr}));
}

TEST(TelemetryLine, EachChannelIsThereInCountsAndInStrain) {
  const Json line = LineOf(Sample());
  ASSERT_EQ(line["strain"].size(), 20u);
  ASSERT_EQ(line["strain_counts"].size(), 20u);
  EXPECT_EQ(line["strain_counts"][0], 100);
  // 2.5 V on 2048 counts and 1250 V a unit of strain (config/thesis-rig.toml): 9.765625e-7 a count.
  EXPECT_NEAR(line["strain"][0], 9.765625e-5, 1e-11) << "rounded to seven digits";
  EXPECT_EQ(line["encoder_counts"], Json({217, -219, 3, 4}));
  EXPECT_EQ(line["levels"], kHealthyLevels);
}

TEST(TelemetryLine, ARigWithoutRotorEncodersHasNoRotorAngles) {
  TelemetrySource source = ThesisSource();
  std::erase_if(source.sensors.encoder, [](const EncoderConfig& e) { return e.counter >= 2; });
  const Json line = Json::parse(TelemetryLine(source, Sample(), 0.0, 0));
  EXPECT_EQ(line["rotor_angle_deg"], Json({nullptr, nullptr}));
  EXPECT_EQ(line["hub_angle_deg"][0], 30.0);
}

// A datagram on Ethernet holds 1472 bytes; a longer one is two packets, of which none may be lost.
TEST(TelemetryLine, WithThesisRigFitsTwoPackets) {
  TickRecord tick = Sample();
  for (double& value : tick.output.x_hat) value = -1.0 / 3.0;
  for (double& value : tick.output.modal_m) value = -1.0 / 3e5;
  for (std::int32_t& counts : tick.input.frame.strain) counts = -2048;
  EXPECT_LE(TelemetryLine(ThesisSource(), tick, 1'764'233'100.123456, 1'000'000).size(), 2u * 1472);
}

}  // namespace
}  // namespace flexarm
