#include "model/rigid_joint/rigid_joint_step.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/math/wide_instructions.h"
#include "model/simulation/coulomb_friction_lcp.h"

namespace flexarm {
namespace {

// Accelerations of the hubs: Z a = r + friction.
template <typename Scalar>
struct HubEquation {
  Scalar Z11, Z12, Z22, r1, r2;
};

std::array<double, 2> WithFriction(const HubEquation<double>& hubs, const std::array<double, 2>& v,
                                   const std::array<double, 2>& friction_nm, double h) noexcept {
  return CoulombFrictionLcp(hubs.Z11, hubs.Z12, hubs.Z22, hubs.r1, hubs.r2)
      .Solve(v, friction_nm, h)
      .acceleration;
}

// Both hubs sliding on as they do: true if that holds in every lane, with the same bits as the
// general solution. Otherwise which of the nine cases holds differs from lane to lane.
bool SlideOn(const HubEquation<Lanes>& hubs, const std::array<Lanes, 2>& v,
             const std::array<Lanes, 2>& friction_nm, double h, std::array<Lanes, 2>* a) noexcept {
  std::array<Lanes, 2> sign{};
  for (std::size_t hub = 0; hub < 2; ++hub) {
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      if (v[hub][lane] == 0.0) return false;
      sign[hub].Set(lane, v[hub][lane] > 0.0 ? 1.0 : -1.0);
    }
  }
  const Lanes b1 = hubs.r1 + -friction_nm[0] * sign[0], b2 = hubs.r2 + -friction_nm[1] * sign[1];
  const Lanes scale = 1.0 / (hubs.Z11 * hubs.Z22 - hubs.Z12 * hubs.Z12);
  *a = {scale * (hubs.Z22 * b1 - hubs.Z12 * b2), scale * (hubs.Z11 * b2 - hubs.Z12 * b1)};
  for (std::size_t hub = 0; hub < 2; ++hub) {
    const Lanes onward = sign[hub] * (v[hub] + 0.5 * h * (*a)[hub]);
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      if (!(onward[lane] >= 0.0)) return false;
    }
  }
  return true;
}

std::array<Lanes, 2> WithFriction(const HubEquation<Lanes>& hubs, const std::array<Lanes, 2>& v,
                                  const std::array<Lanes, 2>& friction_nm, double h) noexcept {
  std::array<Lanes, 2> a;
  if (SlideOn(hubs, v, friction_nm, h, &a)) return a;
  for (std::size_t i = 0; i < Lanes::kCount; ++i) {
    const HubEquation<double> of_lane = {hubs.Z11[i], hubs.Z12[i], hubs.Z22[i], hubs.r1[i],
                                         hubs.r2[i]};
    const std::array<double, 2> found =
        WithFriction(of_lane, {v[0][i], v[1][i]}, {friction_nm[0][i], friction_nm[1][i]}, h);
    a[0].Set(i, found[0]);
    a[1].Set(i, found[1]);
  }
  return a;
}

}  // namespace

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

template <typename Scalar>
GaugedStateOf<Scalar> RigidJointStepper::AdvanceOf(const GaugedStateOf<Scalar>& start,
                                                   const SampleInputsOf<Scalar>& inputs,
                                                   int steps) const noexcept {
  using Vector = RigidJointArm::VectorOf<Scalar>;
  const OutboardBodyOf<Scalar> body = arm_.OutboardOf(inputs.payload_kg);
  const Scalar h = h_, half = 0.5 * h_, share = gauge_share_;
  GaugedStateOf<Scalar> x = start;
  for (int i = 0; i < steps; ++i) {
    Vector applied = -arm_.RestoringForce(Vector(x.q + half * x.v), x.v);
    for (int hub = 0; hub < 2; ++hub) applied[hub] += inputs.torque_nm[hub];
    const Vector a = Acceleration(body, x, applied, inputs.friction_nm);
    const Vector v_m = x.v + half * a, q_m = x.q + half * v_m;
    x.phi_f += share * (q_m.template tail<4>() - x.phi_f);
    x.q += h * v_m;
    x.v += h * a;
  }
  return x;
}

RigidJointArm::Vector RigidJointStepper::AccelerationAt(const GaugedState& x,
                                                        const SampleInputs& inputs) const noexcept {
  const RigidJointArm::Inertia at = arm_.At(arm_.Outboard(inputs.payload_kg), x.q, x.v);
  RigidJointArm::Vector r = -arm_.RestoringForce(x.q, x.v) - at.bias;
  r.head<2>() += inputs.torque_nm;
  return Solve(at.M, r, x.v, inputs.friction_nm);
}

// A a = r + friction, v the rates at the start of a step. The modal coordinates are eliminated by
// A_ff = L D L', D and the diagonal of L in place of the other; friction acts on the remaining hub
// equations.
template <typename Scalar>
RigidJointArm::VectorOf<Scalar> RigidJointStepper::Solve(
    const RigidJointArm::MatrixOf<Scalar>& A, const RigidJointArm::VectorOf<Scalar>& r,
    const RigidJointArm::VectorOf<Scalar>& v,
    const std::array<Scalar, 2>& friction_nm) const noexcept {
  constexpr int n = 4;                // modal coordinates
  Eigen::Matrix<Scalar, n, n> L, LD;  // below the diagonal
  Eigen::Matrix<Scalar, n, 1> by_D;
  for (int k = 0; k < n; ++k) {
    Scalar d = A(2 + k, 2 + k);
    for (int j = 0; j < k; ++j) d -= LD(k, j) * L(k, j);
    by_D[k] = 1.0 / d;
    for (int i = k + 1; i < n; ++i) {
      Scalar rest = A(2 + i, 2 + k);
      for (int j = 0; j < k; ++j) rest -= LD(i, j) * L(k, j);
      LD(i, k) = rest;
      L(i, k) = rest * by_D[k];
    }
  }
  Eigen::Matrix<Scalar, n, 3> y, by_D_y;  // L^-1 of the columns of both hubs and of r
  for (int i = 0; i < n; ++i) {
    y(i, 0) = A(2 + i, 0);
    y(i, 1) = A(2 + i, 1);
    y(i, 2) = r[2 + i];
    for (int c = 0; c < 3; ++c) {
      for (int j = 0; j < i; ++j) y(i, c) -= L(i, j) * y(j, c);
      by_D_y(i, c) = by_D[i] * y(i, c);
    }
  }
  const auto less = [&](Scalar x, int row, int column) {
    for (int i = 0; i < n; ++i) x -= y(i, row) * by_D_y(i, column);
    return x;
  };
  const HubEquation<Scalar> hubs = {less(A(0, 0), 0, 0), less(A(1, 0), 1, 0), less(A(1, 1), 1, 1),
                                    less(r[0], 0, 2), less(r[1], 1, 2)};
  const std::array<Scalar, 2> a_hub = WithFriction(hubs, {v[0], v[1]}, friction_nm, h_);
  RigidJointArm::VectorOf<Scalar> a;
  a[0] = a_hub[0];
  a[1] = a_hub[1];
  for (int i = n - 1; i >= 0; --i) {
    Scalar x = by_D_y(i, 2) - by_D_y(i, 0) * a_hub[0] - by_D_y(i, 1) * a_hub[1];
    for (int j = i + 1; j < n; ++j) x -= L(j, i) * a[2 + j];
    a[2 + i] = x;
  }
  return a;
}

// (M + h/2 D + h^2/4 K) a = applied - bias + friction at the middle of the step.
template <typename Scalar>
RigidJointArm::VectorOf<Scalar> RigidJointStepper::Acceleration(
    const OutboardBodyOf<Scalar>& body, const GaugedStateOf<Scalar>& start,
    const RigidJointArm::VectorOf<Scalar>& applied,
    const std::array<Scalar, 2>& friction_nm) const noexcept {
  using Vector = RigidJointArm::VectorOf<Scalar>;
  const Scalar half = 0.5 * h_;
  Vector a = Vector::Constant(0.0);
  for (int pass = 0; pass < kPasses; ++pass) {
    const Vector v_m = start.v + half * a, q_m = start.q + half * v_m;
    RigidJointArm::InertiaOf<Scalar> at = arm_.At(body, q_m, v_m);
    for (int column = 0; column < RigidJointArm::kDof; ++column) {
      for (int row = column; row < RigidJointArm::kDof; ++row) {
        at.M(row, column) += implicit_(row, column);
      }
    }
    a = Solve(at.M, Vector(applied - at.bias), start.v, friction_nm);
  }
  return a;
}

FLEXARM_WIDE_INSTRUCTIONS
GaugedState RigidJointStepper::Advance(const GaugedState& start, const SampleInputs& inputs,
                                       int steps) const noexcept {
  return AdvanceOf(start, inputs, steps);
}

FLEXARM_WIDE_INSTRUCTIONS
GaugedStateOf<Lanes> RigidJointStepper::AdvanceFour(const GaugedStateOf<Lanes>& start,
                                                    const SampleInputsOf<Lanes>& inputs,
                                                    int steps) const noexcept {
  return AdvanceOf(start, inputs, steps);
}

}  // namespace flexarm
