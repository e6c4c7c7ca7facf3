// The pluck test on the simulated arm: correct wiring passes, each wiring fault is named.

#include "controller/commissioning/pluck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "tests/controller/commissioning/plucked_rig.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

std::string Text(const PluckVerdict& verdict) {
  std::string text;
  for (const PluckFinding& f : verdict.finding) text += f.channel + ": " + f.problem + "\n";
  return text;
}

PluckVerdict Judged(const Miswiring& wrong = {}, const RigConfig& config = ShippedRig()) {
  return JudgePluck(config, PluckedRun(wrong, config));
}

TEST(PluckTorques, PulsesHaveZeroAreaAndActOnOneJointAtATime) {
  const RigConfig config = ShippedRig();
  std::array<double, 2> area{}, largest{};
  for (const std::array<double, 2>& torque : PluckTorques(config.commissioning, 0.02)) {
    EXPECT_EQ(torque[0] * torque[1], 0.0);
    for (std::size_t i = 0; i < 2; ++i) {
      area[i] += torque[i];
      largest[i] = std::max(largest[i], torque[i]);
    }
  }
  for (const double a : area) EXPECT_NEAR(a, 0.0, 1e-12);
  EXPECT_EQ(largest, config.commissioning.pluck_torque_nm);
}

TEST(Pluck, ARigWiredAsConfiguredPasses) {
  const PluckVerdict verdict = Judged();
  EXPECT_TRUE(verdict.passed()) << Text(verdict);
  EXPECT_EQ(verdict.answer.size(), 2u + 4u + 20u);
  for (const PluckAnswer& a : verdict.answer) EXPECT_TRUE(a.provable) << a.channel;
}

// The model of the test has neither the true payload nor the true friction: the result must not
// depend on them.
TEST(Pluck, PassesWithOtherPayloadAndFrictionThanConfigured) {
  const auto real = [](double payload_kg, double friction) {
    return Miswiring{.real = [=](RigConfig& c) {
      c.arm.payload_mass_kg = payload_kg;
      for (JointParameters& joint : c.arm.joint) joint.coulomb_friction_nm *= friction;
    }};
  };
  for (const auto& [payload_kg, friction] :
       {std::pair{0.1, 0.5}, {0.1, 1.5}, {0.09, 1.0}, {0.115, 1.0}}) {
    const PluckVerdict verdict = Judged(real(payload_kg, friction));
    EXPECT_TRUE(verdict.passed()) << payload_kg << " kg, friction x " << friction << '\n'
                                  << Text(verdict);
  }
}

TEST(Pluck, ManySeedsOfNoisePass) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const PluckVerdict verdict = Judged({.real = [=](RigConfig& c) { c.sim.seed = seed; }});
    EXPECT_TRUE(verdict.passed()) << seed << '\n' << Text(verdict);
  }
}

struct WrongWire {
  const char* name;
  Miswiring wrong;
  const char* channel;  // that must be named
  const char* problem;
};

std::uint32_t Negated(std::uint32_t count, int bits) {
  return (~count + 1u) & ((std::uint32_t{1} << bits) - 1u);
}

Miswiring Sensors(std::function<void(SensorConfig&)> change) {
  return {.real = [change = std::move(change)](RigConfig& c) { change(c.sensors); }};
}

Miswiring Exchanged(std::size_t a, std::size_t b) {
  return {.frame = [=](SensorFrame& f) { std::swap(f.strain[a], f.strain[b]); }};
}

Miswiring Torque(std::function<std::array<double, 2>(const std::array<double, 2>&)> torque) {
  return {.torque = std::move(torque)};
}

void PrintTo(const WrongWire& wire, std::ostream* out) { *out << wire.name; }

class WrongWireTest : public testing::TestWithParam<WrongWire> {};

TEST_P(WrongWireTest, IsNamed) {
  const PluckVerdict verdict = Judged(GetParam().wrong);
  EXPECT_FALSE(verdict.passed());
  EXPECT_THAT(Text(verdict),
              HasSubstr(std::string(GetParam().channel) + ": " + GetParam().problem));
  // No other channel is named: one line, or one for each of two exchanged channels.
  EXPECT_LE(verdict.finding.size(), 2u) << Text(verdict);
}

INSTANTIATE_TEST_SUITE_P(
    Pluck, WrongWireTest,
    testing::Values(
        WrongWire{"GaugeInverted", Sensors([](SensorConfig& s) { s.strain[3].face = -1; }),
                  "strain_1_04", "is inverted"},
        WrongWire{"GaugeOfLink2Inverted", Sensors([](SensorConfig& s) { s.strain[12].face = -1; }),
                  "strain_2_03", "is inverted"},
        WrongWire{"GaugesExchanged", Exchanged(1, 5), "strain_1_02, strain_1_06", "are exchanged"},
        WrongWire{"NeighboursExchanged", Exchanged(12, 13), "strain_2_03, strain_2_04",
                  "are exchanged"},
        WrongWire{"GaugesOfBothLinksExchanged", Exchanged(0, 10), "strain_1_01",
                  "bends with link 2"},
        WrongWire{"GaugeDead",
                  {.frame = [](SensorFrame& f) { f.strain[6] = 3; }},
                  "strain_1_07",
                  "does not move with its link"},
        WrongWire{"GaugeGainWrong",
                  Sensors([](SensorConfig& s) { s.strain[2].gain_v_per_unit *= 1.3; }),
                  "strain_1_03", "reads 1.30 times"},
        WrongWire{"AmplifierGainWrong", Sensors([](SensorConfig& s) {
                    for (std::size_t i = 10; i < 20; ++i) s.strain[i].gain_v_per_unit *= 2.0;
                  }),
                  "strain_2_*", "all read 1.99 times"},
        WrongWire{"HubCountsWrong",
                  Sensors([](SensorConfig& s) { s.encoder[0].counts_per_turn *= 2.0; }), "hub1",
                  "turns 2.00 times"},
        WrongWire{"RotorCountsWrong",
                  Sensors([](SensorConfig& s) { s.encoder[3].counts_per_turn *= 0.5; }), "rotor2",
                  "turns 0.50 times"},
        WrongWire{"RotorCountsSlightlyWrong",
                  Sensors([](SensorConfig& s) { s.encoder[3].counts_per_turn *= 1.1; }), "rotor2",
                  "turns 1.101 times"},
        WrongWire{"HubInverted",
                  {.frame = [](SensorFrame& f) { f.counter[1] = Negated(f.counter[1], 8); }},
                  "hub2",
                  "counts in the wrong direction"},
        WrongWire{"RotorInverted",
                  {.frame = [](SensorFrame& f) { f.counter[2] = Negated(f.counter[2], 8); }},
                  "rotor1",
                  "counts in the wrong direction"},
        WrongWire{"HubsExchanged",
                  {.frame = [](SensorFrame& f) { std::swap(f.counter[0], f.counter[1]); }},
                  "hub1",
                  "reads what hub2 should"},
        WrongWire{"EncoderDead",
                  {.frame = [](SensorFrame& f) { f.counter[0] = 0; }},
                  "hub1",
                  "does not move"},
        WrongWire{"DriveInverted", Torque([](const std::array<double, 2>& u) {
                    return std::array<double, 2>{u[0], -u[1]};
                  }),
                  "drive2", "moves the joint in the wrong direction"},
        WrongWire{"DriveWithoutPower", Torque([](const std::array<double, 2>& u) {
                    return std::array<double, 2>{0.0, u[1]};
                  }),
                  "drive1", "does not move the joint"},
        WrongWire{"DriveTooStrong", Torque([](const std::array<double, 2>& u) {
                    return std::array<double, 2>{2.0 * u[0], u[1]};
                  }),
                  "drive1", "moves the arm"},
        WrongWire{"DrivesExchanged", Torque([](const std::array<double, 2>& u) {
                    return std::array<double, 2>{u[1], u[0]};
                  }),
                  "drive1, drive2", "are exchanged"}),
    [](const auto& param) { return param.param.name; });

// A fault of the loop ends the test early: an untested drive is reported, and the test has failed.
TEST(Pluck, ATestThatEndsEarlyIsNotPassed) {
  const RigConfig config = ShippedRig();
  std::vector<TickRecord> run = PluckedRun({}, config);
  run.resize(40);
  const PluckVerdict verdict = JudgePluck(config, run);
  EXPECT_THAT(Text(verdict), HasSubstr("drive2: was not tested"));
  EXPECT_FALSE(JudgePluck(config, {}).passed());
}

// The test also works with one strain channel per link and without rotor encoders.
TEST(Pluck, ARigWithFewSensorsPassesAndItsFaultsAreFound) {
  RigConfig config = ShippedRig();
  config.sensors.encoder.resize(2);
  config.sensors.strain = {config.sensors.strain[0], config.sensors.strain[10]};
  config.estimator.modes_per_link = 1;
  const std::vector<TickRecord> run = PluckedRun({}, ShippedRig());
  std::vector<TickRecord> thin = run;
  for (std::size_t k = 0; k < run.size(); ++k) {
    thin[k].input.frame.strain[1] = run[k].input.frame.strain[10];
  }
  EXPECT_TRUE(JudgePluck(config, thin).passed()) << Text(JudgePluck(config, thin));
  for (TickRecord& tick : thin) tick.input.frame.strain[1] *= -1;
  EXPECT_THAT(Text(JudgePluck(config, thin)), HasSubstr("hub2, strain_2_*: contradict"));
}

}  // namespace
}  // namespace flexarm
