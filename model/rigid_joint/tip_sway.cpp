#include "model/rigid_joint/tip_sway.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace flexarm {
namespace {

using Vector = RigidJointArm::Vector;
using Matrix = RigidJointArm::Matrix;

// Displacement of the tip per coordinate, at q = 0: its acceleration is linear in q'' there.
Eigen::Matrix<double, 1, 6> TipRow(const RigidJointArm& arm) {
  Eigen::Matrix<double, 1, 6> row;
  for (int i = 0; i < RigidJointArm::kDof; ++i) {
    row(i) = arm.TipAcceleration(Vector::Zero(), Vector::Zero(), Vector::Unit(i));
  }
  return row;
}

// Twice the energy of the slowest vibration with both hubs locked, per squared amplitude of the
// tip. Inverse iteration.
double Stiffness_n_per_m(const RigidJointArm& arm, const Matrix& mass) {
  const Eigen::Matrix4d M = mass.bottomRightCorner<4, 4>();
  const Eigen::Matrix4d K = arm.stiffness().bottomRightCorner<4, 4>();
  const Eigen::LLT<Eigen::Matrix4d> K_llt(K);
  Eigen::Vector4d f(1.0, 0.0, 1.0, 0.0);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector4d next = K_llt.solve(M * f);
    f = next / next.norm();
  }
  const double tip_m = TipRow(arm).tail<4>().dot(f);
  return f.dot(K * f) / (tip_m * tip_m);
}

}  // namespace

TipSway::TipSway(const RigidJointArm& arm, double payload_kg)
    : mass_(arm.At(arm.Outboard(payload_kg), Vector::Zero(), Vector::Zero()).M),
      stiffness_(arm.stiffness()),
      stiffness_n_per_m_(Stiffness_n_per_m(arm, mass_)) {}

double TipSway::Amplitude_m(const Vector& q, const Vector& v) const noexcept {
  const Vector bent = stiffness_.lazyProduct(q);
  const Vector swing = mass_.lazyProduct(v);
  const double twice_energy_j = bent.dot(q) + swing.dot(v);
  return std::sqrt(std::max(0.0, twice_energy_j) / stiffness_n_per_m_);
}

}  // namespace flexarm
