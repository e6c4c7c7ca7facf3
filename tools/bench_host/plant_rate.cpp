#include "tools/bench_host/plant_rate.h"

#include <algorithm>
#include <stdexcept>

namespace flexarm {
namespace {

// A step in which nothing moves: q + h q' = q for doubles, and h times damping or stiffness
// vanishes beside the masses.
constexpr double kNoTime_s = 1e-20;

}  // namespace

PlantRate::PlantRate(const ArmModel& model)
    : simulator_(model, {.passes = 1, .coulomb_friction = false}), state_(model.dof()) {
  if (model.mode_count().link1 != kModes || model.mode_count().link2 != kModes) {
    throw std::invalid_argument("PlantRate: found another number of modes than 4 on each link");
  }
}

void PlantRate::operator()(const double* y, double* y_dot) noexcept {
  std::copy_n(y, kDof, state_.q.data());
  std::copy_n(y + kDof, kDof, state_.v.data());
  state_.a.setZero();  // a start value that is not finite, of a solver's wild trial, would stay
  simulator_.Step(state_, torque_nm_, kNoTime_s);
  std::copy_n(y + kDof, kDof, y_dot);
  std::copy_n(state_.a.data(), kDof, y_dot + kDof);
}

ArmParameters SmoothArm(const ArmParameters& arm) {
  ArmParameters smooth = arm;
  for (auto& joint : smooth.joint) joint.coulomb_friction_nm = 0.0;
  smooth.foreshortening = false;
  smooth.joint2_backlash.clearance_rad = 0.0;
  return smooth;
}

}  // namespace flexarm
