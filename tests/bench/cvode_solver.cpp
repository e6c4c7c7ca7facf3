#include "tests/bench/cvode_solver.h"

#include <nvector/nvector_serial.h>

#include <algorithm>

namespace flexarm {
namespace {

int Rate(sunrealtype, N_Vector y, N_Vector y_dot, void* user) {
  (*static_cast<PlantRate*>(user))(N_VGetArrayPointer(y), N_VGetArrayPointer(y_dot));
  return 0;
}

}  // namespace

CvodeSolver::CvodeSolver(const SolverProblem& problem, const CvodeSettings& settings)
    : problem_(&problem),
      rate_(problem.model()),
      session_(SolverProblem::kStates, Rate, &rate_, settings) {}

SolverProblem::Motion CvodeSolver::Solve() {
  std::ranges::fill(session_.y(), 0.0);
  rate_calls_ = 0;
  SolverProblem::Motion motion(SolverProblem::kInstants);
  for (std::size_t instant = 0; instant < SolverProblem::kInstants; ++instant) {
    const Eigen::Vector2d push = problem_->PushBefore(instant);
    rate_.Push(push);
    if (instant == 0 || push != problem_->PushBefore(instant - 1)) {
      if (instant > 0) rate_calls_ += session_.rate_calls();
      session_.Restart(static_cast<double>(instant) * SolverProblem::kInterval_s);
    }
    session_.Advance(static_cast<double>(instant + 1) * SolverProblem::kInterval_s);
    std::ranges::copy(session_.y(), motion[instant].begin());
  }
  rate_calls_ += session_.rate_calls();
  return motion;
}

}  // namespace flexarm
