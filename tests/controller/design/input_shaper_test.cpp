#include "controller/design/input_shaper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

struct Pole {
  double frequency_hz, damping_ratio;
};

std::complex<double> Discrete(const Pole& pole) {
  const double w = 2.0 * std::numbers::pi * pole.frequency_hz;
  const double zeta = pole.damping_ratio;
  return std::exp(kPeriod_s * w * std::complex<double>(-zeta, std::sqrt(1.0 - zeta * zeta)));
}

// A loop with these oscillatory poles and one real pole.
Eigen::MatrixXd Loop(const std::vector<Pole>& poles) {
  const auto size = static_cast<Eigen::Index>(2 * poles.size() + 1);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const std::complex<double> z = Discrete(poles[i]);
    A.block<2, 2>(static_cast<Eigen::Index>(2 * i), static_cast<Eigen::Index>(2 * i)) << z.real(),
        z.imag(), -z.imag(), z.real();
  }
  A(size - 1, size - 1) = 0.9;
  return A;
}

// Residual vibration of an oscillation that all weights excite, relative to that of one unit
// impulse: |W(z)| with W(z) = sum w_i z^-i, at the instant of the last weight.
double Residual(const Eigen::RowVectorXd& weights, const Pole& pole) {
  const std::complex<double> z = Discrete(pole);
  std::complex<double> sum = 0.0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    sum += weights(i) * std::pow(z, static_cast<double>(weights.size() - 1 - i));
  }
  return std::abs(sum) / std::pow(std::abs(z), static_cast<double>(weights.size() - 1));
}

const std::vector<Pole> kPoles = {{.frequency_hz = 0.69, .damping_ratio = 0.03},
                                  {.frequency_hz = 2.06, .damping_ratio = 0.1},
                                  {.frequency_hz = 10.0, .damping_ratio = 0.05}};

// An impulse between two samples is divided between them: an error of (w Ts)^2 / 8 of it at most, w
// the frequency; 0.9e-3 and 8.4e-3 here, of impulses of half the command.
TEST(InputShaper, CancelsTheTwoSlowestOscillations) {
  for (const int derivatives : {1, 2}) {
    const Eigen::RowVectorXd weights = DesignInputShaper(Loop(kPoles), derivatives);
    EXPECT_NEAR(weights.sum(), 1.0, 1e-14);
    EXPECT_GE(weights.minCoeff(), 0.0);
    EXPECT_LT(Residual(weights, kPoles[0]), 1e-3);
    EXPECT_LT(Residual(weights, kPoles[1]), 5e-3);
  }
}

// Textbook residual of a ZV shaper at a frequency error of 10 %: cos(pi/2 1.1) = 0.156 without
// damping; that of a ZVD shaper is its square.
TEST(InputShaper, ZvdIsMoreRobustToFrequencyErrorsThanZv) {
  const std::vector<Pole> free = {{.frequency_hz = 0.5, .damping_ratio = 0.0},
                                  {.frequency_hz = 5.0, .damping_ratio = 0.0}};
  const Pole other = {.frequency_hz = 0.55, .damping_ratio = 0.0};
  // The impulses for 5 Hz, whole samples apart, leave cos(pi/2 0.55/5) of 0.55 Hz.
  const double second = std::cos(0.5 * std::numbers::pi * 0.55 / 5.0);
  const double expected = std::abs(std::cos(0.5 * std::numbers::pi * 1.1)) * second;
  EXPECT_NEAR(Residual(DesignInputShaper(Loop(free), 1), other), expected, 1e-9);
  EXPECT_NEAR(Residual(DesignInputShaper(Loop(free), 2), other), expected * expected, 1e-9);
}

// Half a period of each oscillation, rounded up; twice that with the derivative.
TEST(InputShaper, LastsHalfAPeriodOfEachOscillation) {
  const double samples = 0.5 / 0.69 / kPeriod_s + 0.5 / 2.06 / kPeriod_s;
  EXPECT_NEAR(static_cast<double>(DesignInputShaper(Loop(kPoles), 1).size()), samples, 4.0);
  EXPECT_NEAR(static_cast<double>(DesignInputShaper(Loop(kPoles), 2).size()), 2 * samples, 8.0);
}

TEST(InputShaper, ALoopThatDoesNotOscillateTwiceIsRefused) {
  EXPECT_THROW(DesignInputShaper(Loop({kPoles[0]}), 1), std::runtime_error);
}

}  // namespace
}  // namespace flexarm
