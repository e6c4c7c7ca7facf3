#include "tests/support/cvode_session.h"

#include <cvode/cvode_ls.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <stdexcept>

namespace flexarm {
namespace {

#ifndef SUN_COMM_NULL  // before SUNDIALS 7 (Debian 13)
constexpr void* SUN_COMM_NULL = nullptr;
#endif

void Require(int flag) {
  if (flag < 0) throw std::runtime_error("CVODE gave up");
}

}  // namespace

CvodeSession::CvodeSession(std::size_t states, CVRhsFn rate, void* user,
                           const CvodeSettings& settings) {
  Require(SUNContext_Create(SUN_COMM_NULL, &context_));
  const auto size = static_cast<sunindextype>(states);
  y_ = N_VNew_Serial(size, context_);
  N_VConst(0.0, y_);
  matrix_ = SUNDenseMatrix(size, size, context_);
  solver_ = SUNLinSol_Dense(y_, matrix_, context_);
  memory_ = CVodeCreate(settings.stiff ? CV_BDF : CV_ADAMS, context_);
  Require(CVodeInit(memory_, rate, 0.0, y_));
  Require(CVodeSStolerances(memory_, settings.relative, settings.absolute));
  Require(CVodeSetUserData(memory_, user));
  Require(CVodeSetLinearSolver(memory_, solver_, matrix_));
  Require(CVodeSetMaxNumSteps(memory_, settings.most_steps));
#if SUNDIALS_VERSION_MAJOR < 7
  Require(CVodeSetErrFile(memory_, nullptr));
#else
  Require(SUNContext_ClearErrHandlers(context_));
#endif
}

CvodeSession::~CvodeSession() {
  CVodeFree(&memory_);
  SUNLinSolFree(solver_);
  SUNMatDestroy(matrix_);
  N_VDestroy(y_);
  SUNContext_Free(&context_);
}

std::span<double> CvodeSession::y() noexcept {
  return {N_VGetArrayPointer(y_), static_cast<std::size_t>(N_VGetLength(y_))};
}

void CvodeSession::Restart(double time_s) {
  time_s_ = time_s;
  Require(CVodeReInit(memory_, time_s_, y_));
}

void CvodeSession::Advance(double until_s) {
  Require(CVodeSetStopTime(memory_, until_s));
  Require(CVode(memory_, until_s, y_, &time_s_, CV_NORMAL));
}

long CvodeSession::rate_calls() const {
  long own = 0, jacobian = 0;
  Require(CVodeGetNumRhsEvals(memory_, &own));
  Require(CVodeGetNumLinRhsEvals(memory_, &jacobian));
  return own + jacobian;
}

}  // namespace flexarm
