#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "model/arm/backlash.h"
#include "model/math/wide_instructions.h"
#include "model/simulation/coulomb_friction_lcp.h"
#include "model/simulation/fixed_constants.h"
#include "model/simulation/step_kernel.h"

namespace flexarm {

/// One implicit midpoint step for links of Arm::kModes modes, padded if they have fewer.
///
/// Arm solves its linear system: ArticulatedArm, or ForeshortenedArm with the same interface.
/// Used by step_kernel.cpp and foreshortened_kernel.cpp only. Real-time: Step is safe.
template <typename Arm>
class FixedKernel final : public StepKernel {
  static constexpr int kModes = Arm::kModes;

 public:
  FixedKernel(const ArmConstants& c, bool coulomb_friction)
      : m1_(c.m1),
        m2_(c.m2),
        friction_{coulomb_friction ? c.friction_nm[0] : 0.0,
                  coulomb_friction ? c.friction_nm[1] : 0.0},
        has_friction_(friction_[0] > 0.0 || friction_[1] > 0.0),
        backlash_(c.backlash),
        c_(c),
        mass_(c_, 0.0),
        k_(c_, ArmSimulator::kDefaultStep_s) {}

  void Step(ArmState* state, const Eigen::Vector2d& torque_nm, double h,
            const Passes& passes) noexcept override {
    StepOrHalves(state, torque_nm, h, passes, passes.halvings);
  }

  void CarryPayload(const ArmConstants& c) noexcept override {
    backlash_ = c.backlash;
    c_ = typename Arm::Constants(c);
    mass_ = StepConstantsOfArm(c_, 0.0);
    k_ = StepConstantsOfArm(c_, k_.h);
  }

 private:
  using Coordinates = ArmCoordinates<typename Arm::Vec>;
  using Forces = AppliedForces<typename Arm::Vec>;
  using StepConstantsOfArm = typename Arm::Step;

  void StepOrHalves(ArmState* state, const Eigen::Vector2d& torque_nm, double h,
                    const Passes& passes, int halvings) noexcept {
    if (h != k_.h) k_ = StepConstantsOfArm(c_, h);
    bool advanced = false;
    if constexpr (Arm::kWide) {
      advanced = AdvanceWide(state, torque_nm, passes, halvings == 0);
    } else {
      advanced = Advance(state, torque_nm, passes, halvings == 0);
    }
    if (advanced) return;
    for (int half = 0; half < 2; ++half) {
      StepOrHalves(state, torque_nm, 0.5 * h, passes, halvings - 1);
    }
  }

  FLEXARM_WIDE_INSTRUCTIONS
  bool AdvanceWide(ArmState* state, const Eigen::Vector2d& torque_nm, const Passes& passes,
                   bool in_any_case) const noexcept {
    return Advance(state, torque_nm, passes, in_any_case);
  }

  // False, with the state unchanged, if the passes do not converge.
  bool Advance(ArmState* state, const Eigen::Vector2d& torque_nm, const Passes& passes,
               bool in_any_case) const noexcept {
    const double h = k_.h;
    const Coordinates q = Load(state->q), v = Load(state->v);
    const Coordinates last = Load(state->a);
    Coordinates a = Advanced(last, Difference(last, Load(state->a_before)), 1.0);
    const double spring1 = c_.K1 * (q.th[2] - q.th[0] + 0.5 * h * (v.th[2] - v.th[0]));
    Forces r = Applied(q, v, torque_nm, spring1);
    Arm arm(c_, k_, r, q.th[1] + 0.5 * h * (v.th[1] + 0.5 * h * a.th[1]));
    FrictionSolution hubs{};
    double s_ddot = 0.0;
    for (int pass = 1;; ++pass) {
      const Coordinates v_m = Advanced(v, a, 0.5 * h);
      const Coordinates q_m = Advanced(q, v_m, 0.5 * h);
      if (backlash_.active()) ApplyJoint2(q_m, v_m, a, torque_nm[1], &r);
      arm.Reduce(q_m, v_m, r);
      hubs = has_friction_ ? arm.hubs().Solve({v.th[0], v.th[1]}, friction_, h)
                           : arm.hubs().SolveFree();
      const double th1_before = a.th[0], th2_before = a.th[1], s_before = s_ddot;
      s_ddot = arm.Expand(hubs.acceleration, &a);
      if (pass < passes.least) continue;
      const double change_rad_s =
          0.5 * h *
          std::fmax(std::fmax(std::fabs(a.th[0] - th1_before), std::fabs(a.th[1] - th2_before)),
                    std::fabs(s_ddot - s_before));
      if (change_rad_s < passes.agreement_rad_s) break;
      if (pass < passes.most) continue;
      if (change_rad_s <= passes.tolerated_rad_s) break;
      if (pass < passes.longest) continue;
      if (in_any_case) break;
      return false;
    }
    a.th[2] = (torque_nm[0] - spring1 + k_.K1h * a.th[0]) / (c_.J1 + k_.K1h);
    const Coordinates v_m = Advanced(v, a, 0.5 * h);
    const Coordinates q_end = Advanced(q, v_m, h);
    Coordinates v_end = Advanced(v, a, h);
    Settle(hubs, q_end, &v_end);
    Store(q_end, &state->q);
    Store(v_end, &state->v);
    state->a_before = state->a;
    Store(a, &state->a);
    return true;
  }

  static Coordinates Advanced(const Coordinates& x, const Coordinates& rate, double t) noexcept {
    Coordinates y;
    for (std::size_t i = 0; i < 4; ++i) y.th[i] = x.th[i] + t * rate.th[i];
    y.f1 = x.f1 + t * rate.f1;
    y.f2 = x.f2 + t * rate.f2;
    return y;
  }

  static Coordinates Difference(const Coordinates& x, const Coordinates& y) noexcept {
    return Advanced(x, y, -1.0);
  }

  Coordinates Load(const ArmVector& x) const noexcept {
    Coordinates y;
    for (std::size_t i = 0; i < 4; ++i) y.th[i] = x.data()[i];
    y.f1 = Modes(x.data() + kPhi1, m1_);
    y.f2 = Modes(x.data() + kPhi1 + m1_, m2_);
    return y;
  }

  void Store(const Coordinates& y, ArmVector* x) const noexcept {
    for (std::size_t i = 0; i < 4; ++i) x->data()[i] = y.th[i];
    StoreModes(y.f1, m1_, x->data() + kPhi1);
    StoreModes(y.f2, m2_, x->data() + kPhi1 + m1_);
  }

  // Without a test of each entry if the link is not padded.
  static typename Arm::Vec Modes(const double* x, int count) noexcept {
    if (count == kModes) return Arm::MakeVec([x](int i) { return x[i]; });
    return Arm::MakeVec([x, count](int i) { return i < count ? x[i] : 0.0; });
  }

  static void StoreModes(const typename Arm::Vec& f, int count, double* x) noexcept {
    if (count == kModes) {
      for (int i = 0; i < kModes; ++i) x[i] = f[i];
    } else {
      for (int i = 0; i < count; ++i) x[i] = f[i];
    }
  }

  // Forces that do not change between passes: torques, springs at q + h/2 v, damping at v. th3 is
  // eliminated: J1 th3'' + K1h (th3'' - th1'') = tau1 - spring1.
  Forces Applied(const Coordinates& q, const Coordinates& v, const Eigen::Vector2d& torque,
                 double spring1) const noexcept {
    const double h = k_.h;
    const double spring2 = c_.K2 * (q.th[3] - q.th[1] + 0.5 * h * (v.th[3] - v.th[1]));
    Forces r;
    r.th1 = spring1 + k_.rotor1 * (torque[0] - spring1) - c_.b1 * v.th[0];
    r.th2 = spring2 - c_.b2 * v.th[1];
    r.th4 = torque[1] - spring2;
    Arm::Bend(c_, k_, q, v, &r);
    r.K2h = k_.K2h;
    r.drag4 = 0.0;
    return r;
  }

  // Backlash of joint 2, linearised (Newton) about the middle of the step that accelerations `a`
  // give: its slopes go to the left side. A drag that falls with speed stays on the right.
  void ApplyJoint2(const Coordinates& q_m, const Coordinates& v_m, const Coordinates& a,
                   double torque2, Forces* r) const noexcept {
    const double h = k_.h;
    const Joint2Torque joint =
        backlash_.At(q_m.th[3] - q_m.th[1], v_m.th[3] - v_m.th[1], v_m.th[3]);
    r->K2h = 0.25 * h * h * joint.stiffness_nm_per_rad + 0.5 * h * joint.damping_nms_per_rad;
    r->drag4 = joint.drag_slope_nms > 0.0 ? 0.5 * h * joint.drag_slope_nms : 0.0;
    const double spring = joint.spring_nm - r->K2h * (a.th[3] - a.th[1]);
    r->th2 = spring - c_.b2 * (v_m.th[1] - 0.5 * h * a.th[1]);
    r->th4 = torque2 - spring - joint.drag_nm + r->drag4 * a.th[3];
  }

  // A hub that stuck in this step is at rest at its end. If it moved at the start, midpoint alone
  // would leave it with the opposite velocity; an impulse at the hub removes that.
  void Settle(const FrictionSolution& hubs, const Coordinates& q, Coordinates* v) const noexcept {
    const bool stop1 = has_friction_ && hubs.contact[0] == Contact::kStuck;
    const bool stop2 = has_friction_ && hubs.contact[1] == Contact::kStuck;
    if ((stop1 && v->th[0] != 0.0) || (stop2 && v->th[1] != 0.0)) Stop(stop1, stop2, q, v);
  }

  // Rare: apart from the step, which is compiled for speed.
  [[gnu::noinline]] void Stop(bool stop1, bool stop2, const Coordinates& q,
                              Coordinates* v) const noexcept {
    const typename Arm::Vec zero = Arm::MakeVec([](int /*i*/) { return 0.0; });
    const Forces none{
        .th1 = 0.0, .th2 = 0.0, .th4 = 0.0, .f1 = zero, .f2 = zero, .K2h = 0.0, .drag4 = 0.0};
    const Coordinates rest{.th = {}, .f1 = zero, .f2 = zero};
    Arm arm(c_, mass_, none, q.th[1]);
    arm.Reduce(q, rest, none);
    double jump1 = stop1 ? -v->th[0] : 0.0, jump2 = stop2 ? -v->th[1] : 0.0;
    if (!stop1) jump1 = -arm.z12() * jump2 / arm.z11();
    if (!stop2) jump2 = -arm.z12() * jump1 / arm.z22();
    Coordinates jump = rest;
    arm.Expand({jump1, jump2}, &jump);
    *v = Advanced(*v, jump, 1.0);
    if (stop1) v->th[0] = 0.0;
    if (stop2) v->th[1] = 0.0;
  }

  int m1_, m2_;
  std::array<double, 2> friction_;
  bool has_friction_;
  Backlash backlash_;
  typename Arm::Constants c_;
  StepConstantsOfArm mass_;
  StepConstantsOfArm k_;
};

}  // namespace flexarm
