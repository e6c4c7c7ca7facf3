#include "hal/sim/simulated_sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "model/units.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr ModeCount kModes{.link1 = 4, .link2 = 4};

class SimulatedSensorsTest : public testing::Test {
 protected:
  ArmVector Angles(double th1, double th2, double th3, double th4) const {
    ArmVector q = ArmVector::Zero(arm_.dof());
    q.head<4>() << th1, th2, th3, th4;
    return q;
  }
  ArmVector Unbent() const { return ArmVector::Zero(arm_.dof() - kRigidCoordinates); }
  SensorFrame Take(SimulatedSensors* sensors, const ArmVector& q, const ArmVector& filtered) const {
    return sensors->Sample(0, q, filtered, kHealthyLevels);
  }

  const ArmModel arm_{ThesisRig(), kModes};
};

TEST_F(SimulatedSensorsTest, CountersRoundToTheNearestCount) {
  SimulatedSensors sensors(arm_, ThesisSensors(), 1);
  const double count = kTwoPi / 2540.0;
  EXPECT_EQ(Take(&sensors, Angles(0.49 * count, 0, 0, 0), Unbent()).counter[0], 0u);
  EXPECT_EQ(Take(&sensors, Angles(0.51 * count, 0, 0, 0), Unbent()).counter[0], 1u);
  EXPECT_EQ(Take(&sensors, Angles(7.4 * count, 0, 0, 0), Unbent()).counter[0], 7u);
  EXPECT_EQ(Take(&sensors, Angles(-0.49 * count, 0, 0, 0), Unbent()).counter[0], 0u);
}

// 8 bits wrap at 256, 16 at 65536; below zero they read the two's complement.
TEST_F(SimulatedSensorsTest, CountersWrapAtTheirWidthInBothDirections) {
  SimulatedSensors sensors(arm_, ThesisSensors(), 1);
  const double coarse = kTwoPi / 2540.0, fine = kTwoPi / 24480.0;
  const SensorFrame up =
      Take(&sensors, Angles(255 * coarse, 256 * coarse, 515 * coarse, 65537 * fine), Unbent());
  EXPECT_EQ(up.counter[0], 255u);
  EXPECT_EQ(up.counter[1], 0u);
  EXPECT_EQ(up.counter[2], 3u);
  EXPECT_EQ(up.counter[3], 1u);
  const SensorFrame down =
      Take(&sensors, Angles(-1 * coarse, -256 * coarse, -257 * coarse, -2 * fine), Unbent());
  EXPECT_EQ(down.counter[0], 255u);
  EXPECT_EQ(down.counter[1], 0u);
  EXPECT_EQ(down.counter[2], 255u);
  EXPECT_EQ(down.counter[3], 65534u);
}

TEST_F(SimulatedSensorsTest, AnEncoderOfNegativeSignCountsClockwise) {
  SensorConfig config = ThesisSensors();
  config.encoder[0].sign = -1;
  SimulatedSensors sensors(arm_, config, 1);
  EXPECT_EQ(Take(&sensors, Angles(3.0 * kTwoPi / 2540.0, 0, 0, 0), Unbent()).counter[0], 253u);
}

TEST_F(SimulatedSensorsTest, ARigWithoutRotorEncodersReadsOnlyTheHubs) {
  SensorConfig config = ThesisSensors();
  config.encoder.resize(2);
  SimulatedSensors sensors(arm_, config, 1);
  const SensorFrame frame = Take(&sensors, Angles(0.1, 0.2, 0.3, 0.4), Unbent());
  EXPECT_EQ(frame.counter_valid, 0b0011u);
  EXPECT_EQ(frame.counter[2], 0u);
}

// Strain by ArmModel::Strain, then 5000 V per unit over 20 V / 4096 counts, by hand. Without noise
// the reading may differ from it by the rounding of half a count.
TEST_F(SimulatedSensorsTest, StrainChannelsReadGainFaceAndOffset) {
  SensorConfig config = ThesisSensors(0.0);
  config.strain[3].face = -1;
  config.strain[4].gain_v_per_unit = 2500.0;
  config.strain[5].offset_counts = 100.25;
  SimulatedSensors sensors(arm_, config, 1);
  ArmVector filtered = Unbent();
  filtered << 0.05, 2e-4, -3e-5, 1e-5, -0.03, 1e-3, 1e-4, -2e-5;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(arm_.dof());
  q.tail(8) = filtered;
  const SensorFrame frame = Take(&sensors, Angles(0, 0, 0, 0), filtered);
  for (std::size_t i = 0; i < config.strain.size(); ++i) {
    const StrainChannelConfig& row = config.strain[i];
    const double volts = arm_.Strain(row.link, row.position_m, q) * row.gain_v_per_unit * row.face;
    EXPECT_NEAR(frame.strain[i], volts * 4096.0 / 20.0 + row.offset_counts, 0.5 + 1e-9) << i;
  }
  EXPECT_EQ(frame.strain_valid, (1u << 20) - 1u);
  EXPECT_GT(std::abs(frame.strain[0]), 50) << "deflection too small for this test";
}

TEST_F(SimulatedSensorsTest, StrainSaturatesAtTheRangeOfTheConverter) {
  SimulatedSensors sensors(arm_, ThesisSensors(0.0), 1);
  ArmVector filtered = Unbent();
  filtered(0) = 2.0;  // metres: far beyond 2000 microstrain at the root
  EXPECT_EQ(Take(&sensors, Angles(0, 0, 0, 0), filtered).strain[0], 2047);
  filtered(0) = -2.0;
  EXPECT_EQ(Take(&sensors, Angles(0, 0, 0, 0), filtered).strain[0], -2048);
}

// 4000 frames of 20 channels with one count of noise and the rounding's own 1/12. Mean: standard
// error 1.04 / sqrt(4000) = 0.016 counts per channel, five of them 0.082; truncation instead of
// rounding would give 0.5. Deviation: its standard error is 1.04 / sqrt(8000) = 0.012.
TEST_F(SimulatedSensorsTest, NoiseHasZeroMeanAndTheStatedDeviation) {
  SimulatedSensors sensors(arm_, ThesisSensors(1.0), 7);
  constexpr int kFrames = 4000;
  std::array<double, 20> sum{}, squares{};
  double product = 0.0, successive = 0.0, before = 0.0;
  for (int k = 0; k < kFrames; ++k) {
    const SensorFrame frame = Take(&sensors, Angles(0, 0, 0, 0), Unbent());
    for (std::size_t i = 0; i < 20; ++i) {
      sum[i] += frame.strain[i];
      squares[i] += std::pow(frame.strain[i], 2);
    }
    product += static_cast<double>(frame.strain[0]) * frame.strain[1];
    successive += before * frame.strain[0];
    before = frame.strain[0];
  }
  const double deviation = std::sqrt(1.0 + 1.0 / 12.0);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_NEAR(sum[i] / kFrames, 0.0, 0.082) << i;
    EXPECT_NEAR(std::sqrt(squares[i] / kFrames), deviation, 0.06) << i;
  }
  // Uncorrelated between channels and in time: standard error 1.08 / sqrt(4000) = 0.017.
  EXPECT_NEAR(product / kFrames, 0.0, 0.085);
  EXPECT_NEAR(successive / kFrames, 0.0, 0.085);
}

TEST_F(SimulatedSensorsTest, TheSameSeedGivesTheSameFramesAndAnotherDoesNot) {
  SimulatedSensors one(arm_, ThesisSensors(), 3), same(arm_, ThesisSensors(), 3),
      other(arm_, ThesisSensors(), 4);
  int different = 0;
  for (int k = 0; k < 50; ++k) {
    const SensorFrame a = Take(&one, Angles(0, 0, 0, 0), Unbent());
    const SensorFrame b = Take(&same, Angles(0, 0, 0, 0), Unbent());
    const SensorFrame c = Take(&other, Angles(0, 0, 0, 0), Unbent());
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
    if (std::memcmp(&a, &c, sizeof a) != 0) ++different;
  }
  EXPECT_EQ(different, 50);  // 20 channels agree by chance once in 4e10 frames
}

}  // namespace
}  // namespace flexarm
