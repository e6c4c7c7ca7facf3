// The filters on rigs with one gauge a link, with other gauge filters and without rotor encoders.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "estimator/gauge_model.h"
#include "estimator/kalman_design.h"
#include "estimator/payload_filter.h"
#include "estimator/state_estimator.h"
#include "estimator/strain_fit.h"
#include "estimator/unfitted_mode.h"
#include "model/arm/arm_model.h"
#include "model/units.h"
#include "tests/estimator/quantised_arm.h"

namespace flexarm {
namespace {

// One gauge a link, near the clamp, fine enough for rounding to be negligible; no rotor encoders.
SensorConfig FewSensors() {
  SensorConfig sensors = ThesisSensors();
  std::erase_if(sensors.encoder, [](const EncoderConfig& e) { return e.counter >= 2; });
  std::erase_if(sensors.strain, [](const StrainChannelConfig& s) { return s.position_m > 0.05; });
  sensors.strain_input.converter_bits = 24;
  return sensors;
}

EstimatorConfig OneMode() {
  EstimatorConfig config = StudyEstimator();
  config.modes_per_link = 1;
  return config;
}

// The fit of one mode to the strain of a second mode alone, against the closed weights.
TEST(UnfittedMode, AddsToTheFirstAsTheFitDoes) {
  for (const SensorConfig& sensors : {FewSensors(), [] {
                                        SensorConfig many = ThesisSensors();
                                        many.strain_input.converter_bits = 24;
                                        return many;
                                      }()}) {
    const std::array<double, 2> share = SecondModeInFirst(ThesisRig(), sensors);
    StrainFit fit(ThesisRig(), sensors, OneMode());
    const ArmModel arm(ThesisRig(), {2, 2});
    for (int link = 1; link <= 2; ++link) {
      Eigen::VectorXd q = Eigen::VectorXd::Zero(arm.dof());
      constexpr double kSecond_m = 1e-5;  // no channel is far from the fit
      q(4 + 2 * (link - 1) + 1) = kSecond_m;
      SensorFrame frame{};
      for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
        const StrainChannelConfig& gauge = sensors.strain[i];
        const double volts = gauge.gain_v_per_unit * arm.Strain(gauge.link, gauge.position_m, q);
        frame.strain[i] =
            static_cast<std::int32_t>(std::lround(volts / sensors.strain_input.volts_per_count()));
        frame.strain_valid |= 1u << i;
      }
      const auto first = static_cast<std::size_t>(2 * (link - 1));
      // Rounding of half a count of 24 bits: 1e-7 m at most, as in strain_fit_test, of one channel;
      // with ten a third of it
      EXPECT_NEAR(fit.Fit(frame, 0, {}).modal_m[first],
                  share[static_cast<std::size_t>(link - 1)] * kSecond_m, 3e-8)
          << "link " << link;
      fit.Reset({});
    }
  }
}

TEST(UnfittedMode, HasNoGainOfItsOwnInTheKalmanFilter) {
  const KalmanDesign design = DesignKalmanFilter(MakeNominalModel(ThesisRig(), kR12), ThesisRig(),
                                                 FewSensors(), OneMode(), kPeriod_s);
  for (const int unmeasured : {2, 3, 5, 7}) {
    EXPECT_TRUE(design.L.col(unmeasured).isZero(0.0)) << unmeasured;
  }
  const std::array<double, 2> share = SecondModeInFirst(ThesisRig(), FewSensors());
  EXPECT_DOUBLE_EQ(design.C(4, 13), share[0]);
  EXPECT_DOUBLE_EQ(design.C(6, 15), share[1]);
}

// Both filters: the variance of uniform rounding, and what is added to it.
TEST(HubEncoder, HasTheNoiseThatTheConfigAdds) {
  EstimatorConfig config = OneMode();
  config.hub_extra_sigma_rad = {2e-3, 3e-3};
  const double rounding = kCount_rad * kCount_rad / 12.0;
  const KalmanDesign design = DesignKalmanFilter(MakeNominalModel(ThesisRig(), kR12), ThesisRig(),
                                                 FewSensors(), config, kPeriod_s);
  EXPECT_DOUBLE_EQ(design.R(0), rounding + 4e-6);
  EXPECT_DOUBLE_EQ(design.R(1), rounding + 9e-6);
  const PayloadFilterConfig payload = PayloadFilterFor(ThesisRig(), FewSensors(), config);
  EXPECT_DOUBLE_EQ(payload.output_sigma[0], std::sqrt(rounding + 4e-6));
  EXPECT_DOUBLE_EQ(payload.output_sigma[1], std::sqrt(rounding + 9e-6));
}

// A filter of second order and the first-order one that stands for it delay slow motion equally:
// -d(arg)/dw at w = 0 by differences.
TEST(LagCorner, DelaysSlowMotionAsTheFilterDoes) {
  const StrainInputConfig second{.converter_bits = 12,
                                 .range_v = 10.0,
                                 .filter_hz = 30.0,
                                 .noise_counts = 1.0,
                                 .filter_damping = 0.7};
  const auto delay_s = [](const auto& transfer) {
    constexpr double kSlow_rad_s = 1e-3;
    return -std::arg(transfer(std::complex<double>(0.0, kSlow_rad_s))) / kSlow_rad_s;
  };
  const double w = kTwoPi * 30.0, corner = kTwoPi * LagCorner_hz(second);
  const double of_second =
      delay_s([w](std::complex<double> s) { return w * w / (s * s + 1.4 * w * s + w * w); });
  const double of_first =
      delay_s([corner](std::complex<double> s) { return corner / (s + corner); });
  EXPECT_NEAR(of_first, of_second, 1e-9);
  StrainInputConfig first = second;
  first.filter_damping = 0.0;
  EXPECT_EQ(LagCorner_hz(first), 30.0);
}

// A measured combination of states is known better after a measurement than by it alone:
// h P h' = 1 / (1 / s + 1 / r) < r, whatever the prior s.
TEST(PayloadFilter, KnowsWhatTheFitOfOneModeReadsBetterThanItsNoise) {
  PayloadFilterConfig config = PayloadFilterFor(ThesisRig(), FewSensors(), OneMode());
  config.second_in_first = {-3.0, 2.0};  // as large as at the tip of a link
  const PayloadFilter filter(RigidJointStepper(RigidJointArm(ThesisRig()), kPeriod_s, kGauge_hz),
                             config);
  const PayloadFilter::Covariance P = filter.CovarianceAfterRest();
  for (std::size_t link = 0; link < 2; ++link) {
    Eigen::VectorXd h = Eigen::VectorXd::Zero(P.rows());
    const auto first = static_cast<Eigen::Index>(12 + 2 * link);
    h(first) = 1.0;
    h(first + 1) = config.second_in_first[link];
    const double sigma = config.output_sigma[4 + 2 * link];
    EXPECT_LT(h.dot(P * h), sigma * sigma) << "link " << link + 1;
    EXPECT_GT(h.dot(P * h), 0.0);
  }
}

// Four of eight outputs: the same innovations weigh twice, so that 8 is expected again.
TEST(PayloadFilter, ScalesTheNisToEightOutputs) {
  PayloadFilterConfig few = PayloadFilterFor(ThesisRig(), FewSensors(), OneMode());
  few.second_in_first = {};
  PayloadFilterConfig all = few;
  all.outputs = PayloadFilter::kAllGood;
  const RigidJointStepper stepper(RigidJointArm(ThesisRig()), kPeriod_s, kGauge_hz);
  PayloadFilter::Reading reading{.z = PayloadFilter::Outputs::Constant(1e-3), .good = few.outputs};
  const double of_all = PayloadFilter(stepper, all).Update(PiecewiseTorque(), reading).nis;
  const double of_few = PayloadFilter(stepper, few).Update(PiecewiseTorque(), reading).nis;
  EXPECT_GT(of_all, 0.0);
  EXPECT_DOUBLE_EQ(of_few, 2.0 * of_all);
}

// The second mode is estimated but not measured: it has no innovation that a fault could be seen
// in.
TEST(StateEstimator, AnUnfittedModeHasNoInnovation) {
  const EstimatorConfig config = OneMode();
  const KalmanDesign design = DesignKalmanFilter(MakeNominalModel(ThesisRig(), kR12), ThesisRig(),
                                                 FewSensors(), config, kPeriod_s);
  EstimatorConfig kalman = config;
  kalman.kind = EstimatorKind::kKalman;
  StateEstimator estimator(kalman,
                           {.layout = kR12,
                            .A = design.A,
                            .B = design.B,
                            .C = design.C,
                            .L = design.L,
                            .A_rate = design.A_rate,
                            .B_rate = design.B_rate,
                            .W = design.W,
                            .P = design.P,
                            .R = design.R},
                           kPeriod_s, kStiffness);
  DecodedCounters counters{};
  counters.good = 0b0011;
  FittedModes modes{};
  modes.valid = {true, true};
  estimator.Update(counters, modes, {0.0, 0.0});
  StateEstimate estimate{};
  for (int k = 0; k < 5; ++k) estimate = estimator.Update(counters, modes, {3.0, 1.0});
  EXPECT_NE(estimate.innovation[4], 0.0);
  EXPECT_EQ(estimate.innovation[5], 0.0);
  EXPECT_EQ(estimate.innovation[7], 0.0);
}

// The elastic arm with 0.6 kg, measured by two hub encoders and the first mode's fit alone: the
// payload is found to 10 %, as with all sensors.
TEST(PayloadFilter, FindsThePayloadWithOneGaugeALinkAndNoRotorEncoders) {
  ArmParameters heavy = ThesisRig();
  heavy.payload_mass_kg = 0.6;
  QuantisedArm plant(heavy);
  const PayloadFilterConfig config = PayloadFilterFor(ThesisRig(), FewSensors(), OneMode());
  EXPECT_EQ(config.outputs, 0b0101'0011u);
  PayloadFilter filter(RigidJointStepper(RigidJointArm(ThesisRig()), kPeriod_s, kGauge_hz), config);
  double nis = 0.0;
  for (int k = 0; k < 140; ++k) {
    const double s = std::sin(2.0 * M_PI * k / 70.0);
    const Eigen::Vector2d torque(3.0 * s, 0.6 * s);
    PayloadFilter::Outputs z = plant.Run(torque);
    for (std::size_t link = 0; link < 2; ++link) {
      const int first = 4 + 2 * static_cast<int>(link);
      z[first] += config.second_in_first[link] * z[first + 1];
      z[first + 1] = 0.5;  // not measured: whatever it says has no effect
    }
    z[2] = z[3] = -1.0;
    const auto& estimate = filter.Update(PiecewiseTorque::WholePeriod({torque[0], torque[1]}),
                                         {.z = z, .good = PayloadFilter::kAllGood});
    nis += estimate.nis / 140.0;
  }
  EXPECT_NEAR(filter.estimate().payload_kg, 0.6, 0.06);
  EXPECT_LT(filter.estimate().payload_sigma_kg, 0.1);
  EXPECT_LT(nis, 30.0) << "8 is expected, of the outputs that there are";
}

}  // namespace
}  // namespace flexarm
