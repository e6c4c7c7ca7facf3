#pragma once

#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

#include "tools/bench_host/solver_problem.h"

namespace flexarm {

/// Settings of CVODE for one solution.
struct CvodeSettings {
  bool stiff;             ///< backward differences (BDF); else Adams' method; Newton with both
  double relative;        ///< tolerance
  double absolute_share;  ///< the absolute tolerance as a share of `relative`, rad, m, rad/s, m/s
};

/// CVODE (SUNDIALS) on the problem's right-hand side, with a dense Jacobian by differences.
class CvodeSolver {
 public:
  CvodeSolver(const SolverProblem& problem, const CvodeSettings& settings);
  ~CvodeSolver();
  CvodeSolver(const CvodeSolver&) = delete;
  CvodeSolver& operator=(const CvodeSolver&) = delete;

  /// The whole motion from rest. Starts CVODE again where the push changes, and only there.
  /// @throws std::runtime_error if CVODE gives up
  SolverProblem::Motion Solve();
  /// Evaluations of the right-hand side by the last Solve, those of the Jacobian included.
  long rate_calls() const noexcept { return rate_calls_; }

 private:
  void Restart(double time_s);
  void CountCalls();

  const SolverProblem* problem_;
  PlantRate rate_;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
  long rate_calls_ = 0;
};

}  // namespace flexarm
