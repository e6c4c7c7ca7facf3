#include "tools/analysis/arm_zeros.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "model/math/invariant_zeros.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kStraight_rad = 1e-3;   // the tip moves on a line only
constexpr double kRightHalf_rel = 1e-6;  // of the zero's distance from 0: round-off

// Coordinates to outputs: y = C q.
MatrixXd Angles(const ArmModel& model, int first) {
  MatrixXd C = MatrixXd::Zero(2, model.dof());
  C(0, first) = C(1, first + 1) = 1.0;
  return C;
}

MatrixXd LinkEnds(const ArmModel& model) {
  const ArmConstants& c = model.constants();
  MatrixXd C = Angles(model, kTheta1);
  C.block(0, kPhi1, 1, c.m1) = c.link1.psi_tip.transpose() / c.L1;
  C.block(1, c.phi2(), 1, c.m2) = c.link2.psi_tip.transpose() / c.L2;
  return C;
}

MatrixXd Tip(const ArmModel& model, const Eigen::VectorXd& q) {
  MatrixXd C(2, model.dof());
  for (Index i = 0; i < model.dof(); ++i) {
    C.col(i) = model.TipVelocity(q, Eigen::VectorXd::Unit(model.dof(), i));
  }
  return C;
}

Eigen::VectorXcd SortedZeros(const LinearModel& linear, const MatrixXd& C_q) {
  MatrixXd C = MatrixXd::Zero(2, linear.A.rows());
  C.leftCols(C_q.cols()) = C_q;
  Eigen::VectorXcd zeros = InvariantZeros(linear.A, linear.B, C);
  std::sort(zeros.begin(), zeros.end(), [](const auto& a, const auto& b) {
    return std::abs(a) != std::abs(b) ? std::abs(a) < std::abs(b) : a.imag() < b.imag();
  });
  return zeros;
}

}  // namespace

int OutputZeros::unstable() const {
  return static_cast<int>(
      std::count_if(zeros.begin(), zeros.end(), [](const std::complex<double>& zero) {
        return zero.real() > kRightHalf_rel * std::abs(zero);
      }));
}

std::vector<OutputZeros> ArmZeros(const ArmModel& model, const LinearModel& linear,
                                  const Eigen::VectorXd& q) {
  std::vector<OutputZeros> all;
  all.push_back({"rotors", true, SortedZeros(linear, Angles(model, kTheta3))});
  all.push_back({"hubs", true, SortedZeros(linear, Angles(model, kTheta1))});
  all.push_back({"link_ends", true, SortedZeros(linear, LinkEnds(model))});
  if (std::abs(std::sin(q[kTheta2])) < kStraight_rad) {
    all.push_back({"tip", false, {}});
  } else {
    all.push_back({"tip", true, SortedZeros(linear, Tip(model, q))});
  }
  return all;
}

}  // namespace flexarm
