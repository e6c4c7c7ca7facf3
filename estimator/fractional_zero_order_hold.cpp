#include "estimator/fractional_zero_order_hold.h"

#include <cmath>
#include <stdexcept>

#include "model/math/column_sum.h"
#include "model/math/wide_instructions.h"

namespace flexarm {
namespace {

constexpr int kDigitBits = 4, kLastDigit = 15;
constexpr int kPlaces = kPeriodDigits / kDigitBits;  // of a fraction to base 16

Eigen::MatrixXd SideBySide(const DiscreteModel& hold) {
  const Eigen::Index n = hold.A.rows();
  Eigen::MatrixXd AB = Eigen::MatrixXd::Zero((n + 3) / 4 * 4, n + 2);
  AB.topLeftCorner(n, n) = hold.A;
  AB.topRightCorner(n, 2) = hold.B;
  return AB;
}

// x <- A x + B u
template <int kRows>
void Hold(const Eigen::MatrixXd& AB, const std::array<double, 2>& torque_nm, double* x) noexcept {
  const Eigen::Index n = AB.cols() - 2;
  ColumnSum<kRows> next;
  for (Eigen::Index k = 0; k < n; ++k) next.Add(x[k], AB.col(k).data());
  for (Eigen::Index i = 0; i < 2; ++i) {
    next.Add(torque_nm[static_cast<std::size_t>(i)], AB.col(n + i).data());
  }
  next.WriteTo(x);
}

template <int kRows>
void HoldAll(const std::vector<Eigen::MatrixXd>& holds, const PiecewiseTorque& torque,
             double* x) noexcept {
  for (const TorquePiece& piece : torque.all()) {
    for (std::int64_t period = 0; period < piece.ticks / kPeriodTicks; ++period) {
      Hold<kRows>(holds[0], piece.torque_nm, x);
    }
    for (int place = 1; place <= kPlaces; ++place) {
      const std::int64_t digit = piece.ticks >> kDigitBits * (kPlaces - place) & kLastDigit;
      if (digit == 0) continue;
      const std::int64_t first = std::int64_t{kLastDigit} * (place - 1);
      Hold<kRows>(holds[static_cast<std::size_t>(first + digit)], piece.torque_nm, x);
    }
  }
}

}  // namespace

FractionalZeroOrderHold::FractionalZeroOrderHold(const DiscreteModel& whole_period,
                                                 const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                                 double period_s)
    : hold_{SideBySide(whole_period)} {
  if (A.rows() > kMostStates) {
    throw std::invalid_argument("FractionalZeroOrderHold: at most 24 states");
  }
  for (int place = 1; place <= kPlaces; ++place) {
    const DiscreteModel unit = ZeroOrderHold(A, B, std::ldexp(period_s, -kDigitBits * place));
    DiscreteModel hold = unit;
    for (int digit = 1; digit <= kLastDigit; ++digit) {
      if (digit > 1) hold = {.A = unit.A * hold.A, .B = unit.A * hold.B + unit.B};
      hold_.push_back(SideBySide(hold));  // start-up
    }
  }
}

FLEXARM_WIDE_INSTRUCTIONS
void FractionalZeroOrderHold::AdvancePadded(const PiecewiseTorque& torque,
                                            Padded* x) const noexcept {
  switch (hold_[0].rows() / 4) {
    case 1:
      return HoldAll<4>(hold_, torque, x->data());
    case 2:
      return HoldAll<8>(hold_, torque, x->data());
    case 3:
      return HoldAll<12>(hold_, torque, x->data());
    case 4:
      return HoldAll<16>(hold_, torque, x->data());
    case 5:
      return HoldAll<20>(hold_, torque, x->data());
    default:
      return HoldAll<24>(hold_, torque, x->data());
  }
}

}  // namespace flexarm
