// The accelerometer of the simulated rig: against the motion of the tip, and by itself.

#include "hal/sim/simulated_accelerometer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sim/simulated_rig.h"
#include "tests/hal/ideal_sim.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr TipAccelerometerConfig kFine{
    .range_m_s2 = 50.0, .converter_bits = 24, .noise_counts = 0.0, .filter_hz = 200.0};

SensorConfig SensorsWith(const TipAccelerometerConfig& config) {
  SensorConfig sensors = ThesisSensors();
  sensors.tip_accelerometer = config;
  return sensors;
}

constexpr SimConfig kFineSim = IdealSim(4, 0.1);

// Direction of the tip's normal, by the slopes of the rig's modes.
class Tip {
 public:
  explicit Tip(const ArmParameters& arm) : link1_(Link1Modes(arm, 4)), link2_(Link2Modes(arm, 4)) {}

  Eigen::Vector2d Normal(const SimulatedRig& rig) const {
    const ArmVector& q = rig.state().q;
    const double angle = q(kTheta1) + std::atan(link1_.slope_tip.dot(q.segment(kPhi1, 4))) +
                         q(kTheta2) + std::atan(link2_.slope_tip.dot(q.tail(4)));
    return {-std::sin(angle), std::cos(angle)};
  }

 private:
  LinkModes link1_, link2_;
};

// Second differences of the tip's position through an independent filter, the exact response to a
// linear input in every step. They smooth over two steps of 0.1 ms, a quarter of (w h)^2 of a
// signal of w: 2e-4 of the joints' 40 Hz. The elbow turns fast enough for every term to matter.
TEST(SimulatedAccelerometer, ReadsTheSecondDifferenceOfTheTipsPosition) {
  const ArmParameters arm = ThesisRig();
  const Tip tip(arm);
  SimulatedRig rig(arm, SensorsWith(kFine), kFineSim);
  const double h = 1e-4, T = 1.0 / (2.0 * std::numbers::pi * 200.0);
  const double e = std::exp(-h / T), b = (1.0 - e) * T / h;
  const auto position = [&rig] { return Eigen::Vector2d(rig.truth().tip_m.data()); };
  Eigen::Vector2d p0 = position(), p1 = p0;
  double filtered = 0.0, before = 0.0, worst = 0.0, peak = 0.0, fastest = 0.0;
  for (int k = 0; k < 4000; ++k) {
    rig.SetTorque({5.0 * std::cos(0.002 * k), -1.5 * std::cos(0.0015 * k)});
    const double read = rig.Sample(0).accelerometer[0] * kFine.m_s2_per_count();
    const Eigen::Vector2d normal = tip.Normal(rig);
    rig.Step();
    const Eigen::Vector2d p2 = position();
    if (k > 0) {
      const double a = normal.dot(p2 - 2.0 * p1 + p0) / (h * h);
      filtered = e * filtered + (b - e) * before + (1.0 - b) * a;
      before = a;
      worst = std::max(worst, std::fabs(read - filtered));
      peak = std::max(peak, std::fabs(filtered));
    }
    fastest = std::max(fastest, std::fabs(rig.state().v(kTheta2)));
    p0 = p1;
    p1 = p2;
  }
  EXPECT_GT(peak, 5.0);
  EXPECT_GT(fastest, 2.0);
  EXPECT_LT(worst, 2e-3 * peak);
}

SensorFrame Reading(SimulatedAccelerometer* sensor, double acceleration_m_s2) {
  for (int i = 0; i < 1000; ++i) sensor->Step(acceleration_m_s2);  // its filter settles
  SensorFrame frame{};
  sensor->Sample(&frame);
  return frame;
}

TEST(SimulatedAccelerometer, RoundsAndSaturatesAtItsRange) {
  TipAccelerometerConfig config = kFine;
  config.converter_bits = 12;  // 100 / 4096 m/s^2 a count
  SimulatedAccelerometer sensor(config, 5e-4, 1);
  const SensorFrame frame = Reading(&sensor, 10.0);
  EXPECT_EQ(frame.accelerometer[0], 410);  // 409.6
  EXPECT_EQ(frame.accelerometer_valid, 1u);
  EXPECT_EQ(Reading(&sensor, -10.0).accelerometer[0], -410);
  EXPECT_EQ(Reading(&sensor, 51.0).accelerometer[0], 2047);
  EXPECT_EQ(Reading(&sensor, -51.0).accelerometer[0], -2048);
}

// One time constant after a step: 1 - 1/e of it. 1 / (2 pi 200 Hz) is 0.796 ms.
TEST(SimulatedAccelerometer, ItsFilterIsFirstOrderAtItsCorner) {
  SimulatedAccelerometer sensor(kFine, 0.796e-3 / 8.0, 1);
  for (int i = 0; i < 8; ++i) sensor.Step(20.0);
  SensorFrame frame{};
  sensor.Sample(&frame);
  EXPECT_NEAR(frame.accelerometer[0] * kFine.m_s2_per_count(), 20.0 * (1.0 - std::exp(-1.0)), 0.01);
}

// 4000 readings: the standard deviation is known to 1.1 %, four times that is allowed.
TEST(SimulatedAccelerometer, ItsNoiseHasTheSizeOfTheConfig) {
  TipAccelerometerConfig config = kFine;
  config.noise_counts = 20.0;
  SimulatedAccelerometer sensor(config, 5e-4, 1);
  double sum = 0.0, squares = 0.0;
  constexpr int kReadings = 4000;
  for (int i = 0; i < kReadings; ++i) {
    SensorFrame frame{};
    sensor.Sample(&frame);
    sum += frame.accelerometer[0];
    squares += std::pow(frame.accelerometer[0], 2);
  }
  EXPECT_NEAR(sum / kReadings, 0.0, 1.3);
  EXPECT_NEAR(std::sqrt(squares / kReadings), 20.0, 0.9);
}

TEST(SimulatedAccelerometer, DoesNotChangeTheOtherSensors) {
  TipAccelerometerConfig noisy = kFine;
  noisy.noise_counts = 100.0;
  SimulatedRig with(ThesisRig(), SensorsWith(noisy), kFineSim);
  SimulatedRig without(ThesisRig(), ThesisSensors(), kFineSim);
  for (int k = 0; k < 200; ++k) {
    for (SimulatedRig* rig : {&with, &without}) {
      rig->SetTorque({3.0, 0.3});
      rig->Step();
    }
    SensorFrame frame = with.Sample(k);
    const SensorFrame bare = without.Sample(k);
    ASSERT_EQ(frame.strain, bare.strain);
    ASSERT_EQ(frame.counter, bare.counter);
    ASSERT_EQ(bare.accelerometer_valid, 0u);
    with.StartFrame(k);
    without.StartFrame(k);
    const std::optional<SensorFrame> begun = with.TakeFrame();
    ASSERT_TRUE(begun.has_value());
    ASSERT_EQ(begun->accelerometer_valid, 1u);
    ASSERT_EQ(begun->strain, without.TakeFrame()->strain);
  }
}

}  // namespace
}  // namespace flexarm
