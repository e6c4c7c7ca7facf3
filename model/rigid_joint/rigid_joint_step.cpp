#include "model/rigid_joint/rigid_joint_step.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/math/small_cholesky.h"
#include "model/simulation/coulomb_friction_lcp.h"

namespace flexarm {

RigidJointStepper::RigidJointStepper(RigidJointArm arm, double period_s, double gauge_filter_hz,
                                     int steps)
    : arm_(std::move(arm)),
      steps_(steps),
      h_(period_s / steps),
      gauge_share_(1.0 - std::exp(-2.0 * std::numbers::pi * gauge_filter_hz * h_)),  // start-up
      implicit_(Implicit(arm_, h_)) {}

std::vector<double> RigidJointStepper::Constants() const {
  std::vector<double> constants = {static_cast<double>(steps_), h_, gauge_share_};
  const std::vector<double> of_arm = arm_.Constants();
  constants.insert(constants.end(), of_arm.begin(), of_arm.end());  // start-up
  return constants;
}

RigidJointStepper::RigidJointStepper(std::span<const double> constants)
    : arm_(constants.subspan(std::min<std::size_t>(constants.size(), 3))),
      steps_(static_cast<int>(constants[0])),
      h_(constants[1]),
      gauge_share_(constants[2]),
      implicit_(Implicit(arm_, h_)) {}

GaugedState RigidJointStepper::Advance(const GaugedState& start, const SampleInputs& inputs,
                                       int steps) const noexcept {
  const OutboardBody body = arm_.Outboard(inputs.payload_kg);
  GaugedState x = start;
  for (int i = 0; i < steps; ++i) {
    Vector applied = -arm_.damping().lazyProduct(x.v);
    applied -= arm_.stiffness().lazyProduct(x.q + 0.5 * h_ * x.v);
    applied.head<2>() += inputs.torque_nm;
    const Vector a = Acceleration(body, x, applied, inputs.friction_nm);
    const Vector v_m = x.v + 0.5 * h_ * a;
    const Vector q_m = x.q + 0.5 * h_ * v_m;
    x.phi_f += gauge_share_ * (q_m.tail<4>() - x.phi_f);
    x.q += h_ * v_m;
    x.v += h_ * a;
  }
  return x;
}

RigidJointArm::Vector RigidJointStepper::AccelerationAt(const GaugedState& x,
                                                        const SampleInputs& inputs) const noexcept {
  const RigidJointArm::Inertia at = arm_.At(arm_.Outboard(inputs.payload_kg), x.q, x.v);
  Vector r = -arm_.damping().lazyProduct(x.v);
  r -= arm_.stiffness().lazyProduct(x.q);
  r.head<2>() += inputs.torque_nm;
  r -= at.bias;
  return Solve(at.M, r, x.v, inputs.friction_nm);
}

// A a = r + friction, v the rates at the start of a step. The modal coordinates are eliminated;
// friction acts on the remaining hub equations.
inline RigidJointArm::Vector RigidJointStepper::Solve(
    const RigidJointArm::Matrix& A, const Vector& r, const Vector& v,
    const std::array<double, 2>& friction_nm) const noexcept {
  const SmallCholesky<4> flexible(A.bottomRightCorner<4, 4>());
  const Eigen::Matrix<double, 4, 2> A_fh = A.bottomLeftCorner<4, 2>(), X = flexible.Solve(A_fh);
  const Eigen::Vector4d r_f = r.tail<4>(), y = flexible.Solve(r_f);
  const Eigen::Matrix2d Z = A.topLeftCorner<2, 2>() - A.topRightCorner<2, 4>().lazyProduct(X);
  const Eigen::Vector2d r_hub = r.head<2>() - A.topRightCorner<2, 4>().lazyProduct(y);
  const FrictionSolution hubs = CoulombFrictionLcp(Z(0, 0), Z(1, 0), Z(1, 1), r_hub[0], r_hub[1])
                                    .Solve({v[0], v[1]}, friction_nm, h_);
  Vector a;
  a.head<2>() << hubs.acceleration[0], hubs.acceleration[1];
  a.tail<4>() = y - X.lazyProduct(a.head<2>());
  return a;
}

// (M + h/2 D + h^2/4 K) a = applied - bias + friction at the middle of the step.
RigidJointArm::Vector RigidJointStepper::Acceleration(
    const OutboardBody& body, const GaugedState& start, const Vector& applied,
    const std::array<double, 2>& friction_nm) const noexcept {
  Vector a = Vector::Zero();
  for (int pass = 0; pass < kPasses; ++pass) {
    const Vector v_m = start.v + 0.5 * h_ * a;
    const RigidJointArm::Inertia at = arm_.At(body, start.q + 0.5 * h_ * v_m, v_m);
    const RigidJointArm::Matrix A = at.M + implicit_;
    a = Solve(A, applied - at.bias, start.v, friction_nm);
  }
  return a;
}

}  // namespace flexarm
