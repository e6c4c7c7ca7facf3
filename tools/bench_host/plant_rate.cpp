#include "tools/bench_host/plant_rate.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "model/simulation/articulated_arm.h"

namespace flexarm {

struct PlantRate::Constants {
  explicit Constants(const ArmConstants& arm) : fixed(arm), masses(fixed, 0.0) {}

  FixedConstants<kModes> fixed;
  StepConstants<kModes> masses;
};

namespace {

using Coordinates = ArmCoordinates<PlantRate::kModes>;

Coordinates Load(const double* x) noexcept {
  Coordinates out;
  std::copy_n(x, out.th.size(), out.th.begin());
  out.f1 = Coordinates::Vec::Map(x + kPhi1);
  out.f2 = Coordinates::Vec::Map(x + kPhi1 + PlantRate::kModes);
  return out;
}

}  // namespace

PlantRate::PlantRate(const ArmModel& model) {
  if (model.mode_count().link1 != kModes || model.mode_count().link2 != kModes) {
    throw std::invalid_argument("PlantRate: found another number of modes than 4 on each link");
  }
  constants_ = std::make_unique<const Constants>(model.constants());
}

PlantRate::~PlantRate() = default;

void PlantRate::operator()(const double* y, double* y_dot) const noexcept {
  const FixedConstants<kModes>& c = constants_->fixed;
  const Coordinates q = Load(y), v = Load(y + kDof);
  const double spring1 = c.K1 * (q.th[2] - q.th[0]), spring2 = c.K2 * (q.th[3] - q.th[1]);
  AppliedForces<kModes> r;
  r.th1 = spring1 - c.b1 * v.th[0];
  r.th2 = spring2 - c.b2 * v.th[1];
  r.th4 = torque_nm_[1] - spring2;
  r.f1.noalias() = -(c.G1 * q.f1);
  r.f1.noalias() -= c.D1 * v.f1;
  r.f2.noalias() = -(c.G2 * q.f2);
  r.f2.noalias() -= c.D2 * v.f2;
  r.K2h = r.drag4 = 0.0;
  ArticulatedArm<kModes> arm(c, constants_->masses);
  arm.Reduce(q, v, r);
  Coordinates a;
  arm.Expand(arm.hubs().SolveFree().acceleration, &a);
  a.th[2] = (torque_nm_[0] - spring1) / c.J1;
  std::copy_n(y + kDof, kDof, y_dot);
  std::copy_n(a.th.begin(), a.th.size(), y_dot + kDof);
  Coordinates::Vec::Map(y_dot + kDof + kPhi1) = a.f1;
  Coordinates::Vec::Map(y_dot + kDof + kPhi1 + kModes) = a.f2;
}

ArmParameters SmoothArm(const ArmParameters& arm) {
  ArmParameters smooth = arm;
  for (auto& joint : smooth.joint) joint.coulomb_friction_nm = 0.0;
  smooth.foreshortening = false;
  smooth.joint2_backlash.clearance_rad = 0.0;
  return smooth;
}

}  // namespace flexarm
