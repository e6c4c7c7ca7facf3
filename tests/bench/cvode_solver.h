#pragma once

#include "tests/support/cvode_session.h"
#include "tools/bench_host/solver_problem.h"

namespace flexarm {

/// CVODE (SUNDIALS) on the problem's right-hand side.
class CvodeSolver {
 public:
  CvodeSolver(const SolverProblem& problem, const CvodeSettings& settings);

  /// The whole motion from rest. Starts CVODE again where the push changes, and only there.
  /// @throws std::runtime_error if CVODE gives up
  SolverProblem::Motion Solve();
  /// Evaluations of the right-hand side by the last Solve, those of the Jacobian included.
  long rate_calls() const noexcept { return rate_calls_; }

 private:
  const SolverProblem* problem_;
  PlantRate rate_;
  CvodeSession session_;
  long rate_calls_ = 0;
};

}  // namespace flexarm
