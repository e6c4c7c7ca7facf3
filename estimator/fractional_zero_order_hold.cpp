#include "estimator/fractional_zero_order_hold.h"

#include <cmath>

namespace flexarm {

FractionalZeroOrderHold::FractionalZeroOrderHold(const DiscreteModel& whole_period,
                                                 const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                                 double period_s)
    : hold_{whole_period} {
  for (int digit = 1; digit <= kPeriodDigits; ++digit) {
    hold_.push_back(ZeroOrderHold(A, B, std::ldexp(period_s, -digit)));  // start-up
  }
}

}  // namespace flexarm
