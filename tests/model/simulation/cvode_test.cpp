// Whole trajectories against CVODE (SUNDIALS), an independent variable-order solver.

#include <cvode/cvode.h>
#include <gtest/gtest.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "model/simulation/arm_simulator.h"
#include "tests/model/simulation/reference_integrator.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

#ifndef SUN_COMM_NULL  // before SUNDIALS 7 (Debian 13)
constexpr void* SUN_COMM_NULL = nullptr;
#endif

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

void Require(int flag) {
  if (flag < 0) throw std::runtime_error("CVODE failed");
}

// Stiff solver (BDF, dense Newton) restarted at every edge of the torque.
class Cvode {
 public:
  Cvode(const ArmModel& model, double relative)
      : problem_{&model, VectorXd::Zero(model.dof())}, n_(model.dof()) {
    Require(SUNContext_Create(SUN_COMM_NULL, &context_));
    const auto states = static_cast<sunindextype>(2 * n_);
    y_ = N_VNew_Serial(states, context_);
    N_VConst(0.0, y_);
    matrix_ = SUNDenseMatrix(states, states, context_);
    solver_ = SUNLinSol_Dense(y_, matrix_, context_);
    memory_ = CVodeCreate(CV_BDF, context_);
    Require(CVodeInit(memory_, Rate, 0.0, y_));
    Require(CVodeSStolerances(memory_, relative, 1e-3 * relative));
    Require(CVodeSetUserData(memory_, &problem_));
    Require(CVodeSetLinearSolver(memory_, solver_, matrix_));
    Require(CVodeSetMaxNumSteps(memory_, 10'000'000));
  }
  ~Cvode() {
    CVodeFree(&memory_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  Cvode(const Cvode&) = delete;
  Cvode& operator=(const Cvode&) = delete;

  void Run(double until_s, const Vector2d& torque_nm) {
    problem_.force = problem_.model->InputMatrix() * torque_nm;
    Require(CVodeReInit(memory_, time_, y_));
    Require(CVodeSetStopTime(memory_, until_s));
    Require(CVode(memory_, until_s, y_, &time_, CV_NORMAL));
  }
  VectorXd q() const { return Eigen::Map<const VectorXd>(N_VGetArrayPointer(y_), n_); }

 private:
  Problem problem_;
  Eigen::Index n_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
  sunrealtype time_ = 0.0;
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
