#include "tests/bench/cvode_solver.h"

#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <stdexcept>

namespace flexarm {
namespace {

#ifndef SUN_COMM_NULL  // before SUNDIALS 7 (Debian 13)
constexpr void* SUN_COMM_NULL = nullptr;
#endif

int Rate(sunrealtype, N_Vector y, N_Vector y_dot, void* user) {
  (*static_cast<PlantRate*>(user))(N_VGetArrayPointer(y), N_VGetArrayPointer(y_dot));
  return 0;
}

void Require(int flag) {
  if (flag < 0) throw std::runtime_error("CVODE gave up");
}

}  // namespace

CvodeSolver::CvodeSolver(const SolverProblem& problem, const CvodeSettings& settings)
    : problem_(&problem), rate_(problem.model()) {
  Require(SUNContext_Create(SUN_COMM_NULL, &context_));
  const auto states = static_cast<sunindextype>(SolverProblem::kStates);
  y_ = N_VNew_Serial(states, context_);
  matrix_ = SUNDenseMatrix(states, states, context_);
  solver_ = SUNLinSol_Dense(y_, matrix_, context_);
  memory_ = CVodeCreate(settings.stiff ? CV_BDF : CV_ADAMS, context_);
  Require(CVodeInit(memory_, Rate, 0.0, y_));
  Require(
      CVodeSStolerances(memory_, settings.relative, settings.absolute_share * settings.relative));
  Require(CVodeSetUserData(memory_, &rate_));
  Require(CVodeSetLinearSolver(memory_, solver_, matrix_));
  Require(CVodeSetMaxNumSteps(memory_, 1'000'000));
  // A tolerance at which it gives up is told by an exception, not by its own lines.
#if SUNDIALS_VERSION_MAJOR < 7
  Require(CVodeSetErrFile(memory_, nullptr));
#else
  Require(SUNContext_ClearErrHandlers(context_));
#endif
}

CvodeSolver::~CvodeSolver() {
  CVodeFree(&memory_);
  SUNLinSolFree(solver_);
  SUNMatDestroy(matrix_);
  N_VDestroy(y_);
  SUNContext_Free(&context_);
}

SolverProblem::Motion CvodeSolver::Solve() {
  N_VConst(0.0, y_);
  rate_calls_ = 0;
  SolverProblem::Motion motion(SolverProblem::kInstants);
  sunrealtype time_s = 0.0;
  for (std::size_t instant = 0; instant < SolverProblem::kInstants; ++instant) {
    const Eigen::Vector2d push = problem_->PushBefore(instant);
    const bool changes = instant == 0 || push != problem_->PushBefore(instant - 1);
    rate_.Push(push);
    if (changes) Restart(time_s);
    const double until_s = static_cast<double>(instant + 1) * SolverProblem::kInterval_s;
    // Not beyond an instant at which the push may change.
    Require(CVodeSetStopTime(memory_, until_s));
    Require(CVode(memory_, until_s, y_, &time_s, CV_NORMAL));
    std::copy_n(N_VGetArrayPointer(y_), motion[instant].size(), motion[instant].begin());
  }
  CountCalls();
  return motion;
}

void CvodeSolver::Restart(double time_s) {
  if (time_s > 0.0) CountCalls();
  Require(CVodeReInit(memory_, time_s, y_));
}

// CVODE counts from each start on.
void CvodeSolver::CountCalls() {
  long own = 0, jacobian = 0;
  Require(CVodeGetNumRhsEvals(memory_, &own));
  Require(CVodeGetNumLinRhsEvals(memory_, &jacobian));
  rate_calls_ += own + jacobian;
}

}  // namespace flexarm
