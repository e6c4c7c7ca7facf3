// Whole trajectories against CVODE (SUNDIALS), an independent variable-order solver.

#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>

#include <cmath>

#include "model/simulation/arm_simulator.h"
#include "tests/model/simulation/reference_integrator.h"
#include "tests/support/cvode_session.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

struct Problem {
  const ArmModel* model;
  VectorXd force;
};

int Rate(sunrealtype, N_Vector y, N_Vector y_dot, void* user) {
  const auto& problem = *static_cast<const Problem*>(user);
  const Eigen::Index n = problem.model->dof();
  const Eigen::Map<const VectorXd> in(N_VGetArrayPointer(y), 2 * n);
  Eigen::Map<VectorXd> out(N_VGetArrayPointer(y_dot), 2 * n);
  out.head(n) = in.tail(n);
  out.tail(n) = problem.model->Acceleration(in.head(n), in.tail(n), problem.force);
  return 0;
}

// Stiff solver (BDF, dense Newton) restarted at every edge of the torque.
class Cvode {
 public:
  Cvode(const ArmModel& model, double relative)
      : problem_{&model, VectorXd::Zero(model.dof())},
        session_(2 * static_cast<std::size_t>(model.dof()), Rate, &problem_,
                 {.stiff = true,
                  .relative = relative,
                  .absolute = 1e-3 * relative,
                  .most_steps = 10'000'000}) {}

  void Run(double until_s, const Vector2d& torque_nm) {
    problem_.force = problem_.model->InputMatrix() * torque_nm;
    session_.Restart(time_s_);
    session_.Advance(until_s);
    time_s_ = until_s;
  }
  VectorXd q() { return Eigen::Map<const VectorXd>(session_.y().data(), problem_.model->dof()); }

 private:
  Problem problem_;
  CvodeSession session_;
  double time_s_ = 0.0;
};

ArmParameters Frictionless(DampingReading damping) {
  ArmParameters p = ThesisRig();
  p.joint[0].coulomb_friction_nm = p.joint[1].coulomb_friction_nm = 0.0;
  p.damping = damping;
  return p;
}

// Chapter 4's square wave to 1.5 s, undamped, two modes: the two must agree to their tolerances.
// CVODE at 1e-10 a step accumulates 5e-10 over 300 periods of the fastest mode (measured).
TEST(Cvode, AgreesWithTheReferenceIntegrator) {
  const ArmModel arm(Frictionless(DampingReading::kNone), {2, 2});
  const Vector2d push(0.4, 0.1);
  Cvode cvode(arm, 1e-10);
  cvode.Run(0.5, push);
  cvode.Run(1.0, -push);
  cvode.Run(1.5, Vector2d::Zero());
  const ReferenceIntegrator reference(arm);
  VectorXd q = VectorXd::Zero(arm.dof()), v = q;
  for (int i = 0; i < 3000; ++i) {
    reference.Step(&q, &v, i < 1000 ? push : i < 2000 ? Vector2d(-push) : Vector2d::Zero(), 5e-4);
  }
  EXPECT_LT((arm.TipPosition(cvode.q()) - arm.TipPosition(q)).norm(), 1e-8);
  EXPECT_LT((cvode.q() - q).cwiseAbs().maxCoeff(), 1e-8);
}

// The default integrator on the rig's own arm: four modes, structural damping (stiff: 1e4 1/s), a
// move of 15 degrees. Second order at 0.5 ms: 3e-5 rad and 9e-6 m measured.
TEST(Cvode, DefaultIntegratorFollowsADampedMove) {
  for (const bool foreshortening : {false, true}) {
    ArmParameters p = Frictionless(DampingReading::kCurvatureRho);
    p.foreshortening = foreshortening;
    const ArmModel arm(p, {4, 4});
    const Vector2d push(6.645, 0.966);
    Cvode cvode(arm, 1e-8);
    cvode.Run(0.5, push);
    cvode.Run(1.0, -push);
    ArmSimulator simulator(arm);
    ArmState x(arm.dof());
    for (int i = 0; i < 2000; ++i) simulator.Step(x, i < 1000 ? push : Vector2d(-push), 5e-4);
    EXPECT_GT(std::fabs(x.q[kTheta1]), 0.3);
    EXPECT_LT((cvode.q() - x.q).head<4>().cwiseAbs().maxCoeff(), 1e-4) << foreshortening;
    EXPECT_LT((arm.TipPosition(cvode.q()) - arm.TipPosition(x.q)).norm(), 3e-5) << foreshortening;
  }
}

}  // namespace
}  // namespace flexarm
