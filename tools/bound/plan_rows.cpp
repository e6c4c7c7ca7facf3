#include "tools/bound/plan_rows.h"

#include <algorithm>

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDiverged = 1e9;

VectorXd DeviationOf(const ArmMotion& arm, const MatrixXd& x) {
  return (x.rightCols<1>() - arm.goal()).cwiseQuotient(arm.goal_scale());
}

// Moves the slopes of the state by the plan on by one period, the k-th.
void Advance(const ArmMotion::Slopes& slopes, const ArmMotion& arm, double period_s, Index k,
             MatrixXd* by_plan) {
  by_plan->leftCols(2 * k) = (slopes.by_state * by_plan->leftCols(2 * k)).eval();
  by_plan->middleCols<2>(2 * k) = slopes.by_torque * arm.torque_limit_nm().asDiagonal();
  by_plan->rightCols<1>() =
      (slopes.by_state * by_plan->rightCols<1>() + period_s * slopes.by_period).eval();
}

}  // namespace

PlanRows::PlanRows(const ArmMotion& arm, const TorquePlan& plan, const MatrixXd& x) {
  const Index n = x.rows(), periods = plan.periods(), shares = arm.shares().rows();
  MatrixXd slope = MatrixXd::Zero(n, 2 * periods + 1);
  by_plan.resize(periods * shares + n, slope.cols());
  for (Index k = 0; k < periods; ++k) {
    Advance(arm.SlopesAt(x.col(k), x.col(k + 1), plan.torque_nm.col(k), plan.period_s), arm,
            plan.period_s, k, &slope);
    by_plan.middleRows(k * shares, shares) = arm.shares() * slope;
  }
  by_plan.bottomRows(n) = arm.goal_scale().cwiseInverse().asDiagonal() * slope;
  value = ValuesOf(arm, x);
  bound = VectorXd::Ones(by_plan.rows());
  bound.tail(n).setZero();
}

VectorXd PlanRows::ValuesOf(const ArmMotion& arm, const MatrixXd& x) {
  const MatrixXd share = arm.shares() * x.rightCols(x.cols() - 1);
  return (VectorXd(share.size() + x.rows()) << share.reshaped(), DeviationOf(arm, x)).finished();
}

double ViolationOf(const ArmMotion& arm, const MatrixXd& x) {
  const double excess = (arm.shares() * x).cwiseAbs().maxCoeff() - 1.0;
  const double violation = std::max({0.0, excess, DeviationOf(arm, x).cwiseAbs().maxCoeff()});
  return x.allFinite() && violation < kDiverged ? violation : kDiverged;
}

}  // namespace flexarm
