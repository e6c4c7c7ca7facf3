#include <gtest/gtest.h>

#include "model/math/discretize.h"
#include "tests/estimator/estimator_inputs.h"

namespace flexarm {
namespace {

// Predicted rates of the gauges: the derivative of the prediction's own outputs, by a central
// difference over +-0.1 ms around the sample. Its error is (w h)^2 / 6, 1e-4 at 300 rad/s.
TEST(KalmanFilter, PredictsTheRatesOfTheModes) {
  const KalmanDesign design = ThesisFilter();
  StateEstimator estimator = Kalman(design);
  EXPECT_EQ(estimator.ModalRates(PiecewiseTorque()), (std::array<double, 4>{}));
  estimator.Update(Angles(0.1, 0.2, 0.1, 0.2), Bend({0.03, 1e-3, 0.01, 1e-3}), {0.0, 0.0});
  const std::array<double, 2> torque = {2.0, -0.3};
  const std::array<double, 4> rates = estimator.ModalRates(PiecewiseTorque::WholePeriod(torque));
  Eigen::VectorXd x(16);
  x << 0.1, 0.2, 0.03, 1e-3, 0.01, 1e-3, 0, 0, 0, 0, 0, 0, 0.03, 1e-3, 0.01, 1e-3;
  const auto modes_at = [&](double t_s) -> Eigen::VectorXd {
    const DiscreteModel hold = ZeroOrderHold(design.A_rate, design.B_rate, t_s);
    return (design.C * (hold.A * x + hold.B * Eigen::Vector2d(torque[0], torque[1]))).tail(4);
  };
  const Eigen::VectorXd slope = (modes_at(kPeriod_s + 1e-4) - modes_at(kPeriod_s - 1e-4)) / 2e-4;
  EXPECT_GT(slope.cwiseAbs().maxCoeff(), 0.1);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(rates[static_cast<std::size_t>(i)], slope(i), 1e-3 * slope.cwiseAbs().maxCoeff());
  }
}

// The prediction is kept for the update, and only for the same torque from the same state.
TEST(KalmanFilter, RatesThatWereAskedForDoNotChangeTheEstimate) {
  const KalmanDesign design = ThesisFilter();
  StateEstimator asked = Kalman(design), other = Kalman(design);
  const PiecewiseTorque torque = PiecewiseTorque::WholePeriod({2.0, -0.3});
  for (int k = 0; k < 6; ++k) {
    const double turned = 0.01 * k * k;
    const DecodedCounters counters = Angles(turned, -turned, turned, -turned);
    if (k == 4) {
      asked.ModalRates(torque);
      asked.Reset();
      other.Reset();
    }
    if (k % 2 == 0) asked.ModalRates(PiecewiseTorque::WholePeriod({-5.0, 1.0}));
    asked.ModalRates(torque);
    const auto a = asked.Update(counters, Bend({0.0, 0.0, 0.0, 0.0}), torque);
    const auto b = other.Update(counters, Bend({0.0, 0.0, 0.0, 0.0}), torque);
    EXPECT_EQ(a.x, b.x) << k;
    EXPECT_EQ(a.innovation, b.innovation) << k;
  }
}

}  // namespace
}  // namespace flexarm
