#include "estimator/motion_prediction.h"

#include <cstddef>
#include <cstdint>

namespace flexarm {
namespace {

constexpr int kDof = RigidJointArm::kDof, kFilters = 4;

// Calls advance(torque, steps) for each piece.
template <typename Advance>
void ForEachPiece(const RigidJointStepper& stepper, const PiecewiseTorque& torque,
                  Advance advance) noexcept {
  const std::int64_t step_ticks = kPeriodTicks / stepper.steps();
  std::int64_t ticks = 0, steps_done = 0;
  for (const TorquePiece& piece : torque.all()) {
    ticks += piece.ticks;
    const std::int64_t steps = (ticks + step_ticks / 2) / step_ticks;
    advance(Eigen::Vector2d(piece.torque_nm[0], piece.torque_nm[1]),
            static_cast<int>(steps - steps_done));
    steps_done = steps;
  }
}

GaugedStateOf<Lanes> InAllLanes(const GaugedState& x) noexcept {
  GaugedStateOf<Lanes> four;
  for (int i = 0; i < kDof; ++i) {
    four.q[i] = x.q[i];
    four.v[i] = x.v[i];
  }
  for (int i = 0; i < kFilters; ++i) four.phi_f[i] = x.phi_f[i];
  return four;
}

GaugedState OfLane(const GaugedStateOf<Lanes>& four, std::size_t lane) noexcept {
  GaugedState x;
  for (int i = 0; i < kDof; ++i) {
    x.q[i] = four.q[i][lane];
    x.v[i] = four.v[i][lane];
  }
  for (int i = 0; i < kFilters; ++i) x.phi_f[i] = four.phi_f[i][lane];
  return x;
}

}  // namespace

Eigen::Matrix<double, 16, 1> Stacked(const GaugedState& x) noexcept {
  Eigen::Matrix<double, 16, 1> out;
  out << x.q, x.v, x.phi_f;
  return out;
}

GaugedState MotionAfter(const RigidJointStepper& stepper, const MotionStart& start,
                        const PiecewiseTorque& torque) noexcept {
  GaugedState x = start.state;
  ForEachPiece(stepper, torque, [&](const Eigen::Vector2d& torque_nm, int steps) {
    x = stepper.Advance(
        x,
        {.torque_nm = torque_nm, .payload_kg = start.payload_kg, .friction_nm = start.friction_nm},
        steps);
  });
  return x;
}

MotionWithSlopes MotionAfterWithSlopes(const RigidJointStepper& stepper, const MotionStart& start,
                                       const PiecewiseTorque& torque, double payload_probe_kg,
                                       const std::array<double, 2>& friction_probe_nm) noexcept {
  // Lane 0 is the start; the others have more payload, friction of hub 1, friction of hub 2.
  GaugedStateOf<Lanes> x = InAllLanes(start.state);
  Lanes payload_kg = start.payload_kg;
  std::array<Lanes, 2> friction_nm = {start.friction_nm[0], start.friction_nm[1]};
  payload_kg.Set(1, start.payload_kg + payload_probe_kg);
  for (std::size_t hub = 0; hub < 2; ++hub) {
    friction_nm[hub].Set(2 + hub, start.friction_nm[hub] + friction_probe_nm[hub]);
  }
  ForEachPiece(stepper, torque, [&](const Eigen::Vector2d& torque_nm, int steps) {
    x = stepper.AdvanceFour(
        x, {.torque_nm = torque_nm, .payload_kg = payload_kg, .friction_nm = friction_nm}, steps);
  });

  MotionWithSlopes out;
  out.state = OfLane(x, 0);
  const std::array<double, 3> probe = {payload_probe_kg, friction_probe_nm[0],
                                       friction_probe_nm[1]};
  for (std::size_t i = 0; i < probe.size(); ++i) {
    out.by_parameter.col(static_cast<int>(i)) =
        (Stacked(OfLane(x, 1 + i)) - Stacked(out.state)) / probe[i];
  }
  return out;
}

}  // namespace flexarm
