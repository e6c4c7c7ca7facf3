#include "controller/health/quantised_residual.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flexarm {
namespace {

// log P of the interval of one count, for a prediction that is off by `shift`.
double LogLikelihood(double away, double count, double sigma, double shift) {
  const double low = (away - 0.5 * count - shift) / sigma,
               high = (away + 0.5 * count - shift) / sigma;
  return std::log(0.5 * (std::erfc(low / std::sqrt(2.0)) - std::erfc(high / std::sqrt(2.0))));
}

// Score and information are the derivatives of the likelihood, here by differences of 1e-3 sigma:
// their error is of its square, 1e-6.
TEST(QuantisedResidual, IsTheScoreOfTheIntervalOfOneCount) {
  const double count = 2.0, sigma = 0.5, h = 1e-3 * sigma;
  for (const double away : {-1.4, -1.0, -0.7, 0.3, 0.9, 1.6}) {
    const auto value = [&](double shift) { return LogLikelihood(away, count, sigma, shift); };
    const QuantisedResidual row = Quantised(away, count, sigma);
    EXPECT_NEAR(row.residual * row.weight, (value(h) - value(-h)) / (2.0 * h), 1e-4) << away;
    EXPECT_NEAR(row.weight * row.weight, -(value(h) - 2.0 * value(0.0) + value(-h)) / (h * h), 1e-4)
        << away;
  }
}

// A count that is fine against the error of the prediction: sigma^2 + count^2 / 12.
TEST(QuantisedResidual, OfAFineCountIsTheResidualItself) {
  const QuantisedResidual row = Quantised(0.7, 0.2, 1.0);
  const double expected = 1.0 / (1.0 + 0.2 * 0.2 / 12.0);
  EXPECT_NEAR(row.weight * row.weight, expected, 1e-4);
  EXPECT_NEAR(row.residual * row.weight, 0.7 * expected, 1e-4);
}

TEST(QuantisedResidual, InTheMiddleOfACoarseCountTellsNothing) {
  const QuantisedResidual row = Quantised(0.0, 20.0, 1.0);
  EXPECT_NEAR(row.residual, 0.0, 1e-9);
  EXPECT_LT(row.weight, 2e-3);
}

TEST(QuantisedResidual, FarBeyondTheCountIsFinite) {
  for (const double away : {-1e6, -30.0, 30.0, 1e6}) {
    const QuantisedResidual row = Quantised(away, 2.0, 1.0);
    EXPECT_NEAR(row.residual, away - std::copysign(1.0, away), 0.2);
    EXPECT_NEAR(row.weight, 1.0, 1e-2);
  }
}

}  // namespace
}  // namespace flexarm
