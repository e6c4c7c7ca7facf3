#include "estimator/gauge_model.h"

#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kNoFilterHz = 1600.0;

}  // namespace

double LagCorner_hz(const StrainInputConfig& input) {
  if (!(input.filter_hz > 0.0)) return kNoFilterHz;
  return input.filter_damping > 0.0 ? input.filter_hz / (2.0 * input.filter_damping)
                                    : input.filter_hz;
}

LinearModel WithGaugeFilter(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::Index first,
                            Eigen::Index count, const StrainInputConfig& input) {
  const bool second_order = input.filter_hz > 0.0 && input.filter_damping > 0.0;
  const Eigen::Index n = A.rows(), states = n + (second_order ? 2 : 1) * count;
  const double w_f = kTwoPi * (input.filter_hz > 0.0 ? input.filter_hz : kNoFilterHz);
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(count, count);
  LinearModel out{.A = Eigen::MatrixXd::Zero(states, states),
                  .B = Eigen::MatrixXd::Zero(states, 2)};
  out.A.topLeftCorner(n, n) = A;
  out.B.topRows(n) = B;
  if (second_order) {  // phi_f'' = w_f^2 (phi - phi_f) - 2 zeta w_f phi_f'
    const Eigen::Index rate = n + count;
    out.A.block(n, rate, count, count) = I;
    out.A.block(rate, first, count, count) = w_f * w_f * I;
    out.A.block(rate, n, count, count) = -w_f * w_f * I;
    out.A.block(rate, rate, count, count) = -2.0 * input.filter_damping * w_f * I;
  } else {  // phi_f' = w_f (phi - phi_f)
    out.A.block(n, first, count, count) = w_f * I;
    out.A.bottomRightCorner(count, count) = -w_f * I;
  }
  return out;
}

}  // namespace flexarm
