#include "estimator/tip_output.h"

#include <cstddef>

namespace flexarm {
namespace {

using Vector = RigidJointArm::Vector;

constexpr double kProbe = 1e-6;  // rad, m, rad/s, m/s
constexpr double kPayloadStep_kg = 1e-3;
constexpr double kTorqueProbe_nm = 1e-3;

// The state `by_s` earlier, under a nearly constant acceleration.
GaugedState Before(const GaugedState& x, const Vector& a, double by_s) noexcept {
  GaugedState out = x;
  out.q += -by_s * x.v + 0.5 * by_s * by_s * a;
  out.v -= by_s * a;
  return out;
}

}  // namespace

TipOutput TipOutputAt(const RigidJointStepper& stepper, double lag_s, const GaugedState& at,
                      const SampleInputs& inputs,
                      const std::array<double, 2>& friction_probe_nm) noexcept {
  const auto shown = [&](const GaugedState& x, const SampleInputs& with) {
    const GaugedState was = Before(x, stepper.AccelerationAt(x, with), lag_s);
    return stepper.arm().TipAcceleration(was.q, was.v, stepper.AccelerationAt(was, with));
  };

  TipOutput out;
  out.m_s2 = shown(at, inputs);
  out.by_motion[0] = 0.0;
  for (int i = 1; i < 2 * RigidJointArm::kDof; ++i) {
    GaugedState moved = at;
    (i < RigidJointArm::kDof ? moved.q[i] : moved.v[i - RigidJointArm::kDof]) += kProbe;
    out.by_motion[i] = (shown(moved, inputs) - out.m_s2) / kProbe;
  }
  SampleInputs heavier = inputs;
  heavier.payload_kg += kPayloadStep_kg;
  out.by_payload = (shown(at, heavier) - out.m_s2) / kPayloadStep_kg;
  for (std::size_t i = 0; i < 2; ++i) {
    SampleInputs rougher = inputs;
    rougher.friction_nm[i] += friction_probe_nm[i];
    out.by_friction[i] = (shown(at, rougher) - out.m_s2) / friction_probe_nm[i];
    SampleInputs stronger = inputs;
    stronger.torque_nm[static_cast<int>(i)] += kTorqueProbe_nm;
    out.by_torque[i] = (shown(at, stronger) - out.m_s2) / kTorqueProbe_nm;
  }
  return out;
}

}  // namespace flexarm
