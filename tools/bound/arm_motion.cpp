#include "tools/bound/arm_motion.h"

namespace flexarm {
namespace {

constexpr double kDifference = 1e-6;        // rad, m, rad/s, m/s, N m
constexpr double kPeriodDifference = 1e-4;  // of the period

}  // namespace

ArmMotion::Slopes ArmMotion::SlopesAt(const Eigen::VectorXd& x, const Eigen::VectorXd& next,
                                      const Eigen::Vector2d& torque_nm, double period_s) const {
  const Eigen::Index n = x.size();
  Slopes slopes{
      .by_state = Eigen::MatrixXd(n, n), .by_torque = Eigen::MatrixX2d(n, 2), .by_period = {}};
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::VectorXd near = x;
    near[i] += kDifference;
    slopes.by_state.col(i) = (Next(near, torque_nm, period_s) - next) / kDifference;
  }
  for (Eigen::Index i = 0; i < 2; ++i) {
    Eigen::Vector2d near_nm = torque_nm;
    near_nm[i] += kDifference;
    slopes.by_torque.col(i) = (Next(x, near_nm, period_s) - next) / kDifference;
  }
  const double difference_s = kPeriodDifference * period_s;
  slopes.by_period = (Next(x, torque_nm, period_s + difference_s) - next) / difference_s;
  return slopes;
}

Eigen::MatrixXd StatesOf(const ArmMotion& arm, const TorquePlan& plan) {
  Eigen::MatrixXd x(arm.start().size(), plan.periods() + 1);
  x.col(0) = arm.start();
  for (Eigen::Index k = 0; k < plan.periods(); ++k) {
    x.col(k + 1) = arm.Next(x.col(k), plan.torque_nm.col(k), plan.period_s);
  }
  return x;
}

}  // namespace flexarm
