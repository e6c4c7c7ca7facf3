#pragma once

#include <cvode/cvode.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>
#include <sundials/sundials_nvector.h>

#include <cstddef>
#include <span>

namespace flexarm {

/// What CVODE is asked for.
struct CvodeSettings {
  bool stiff;       ///< backward differences (BDF); else Adams' method; Newton with both
  double relative;  ///< tolerance
  double absolute;  ///< tolerance, in the units of the states
  long most_steps;  ///< of one Advance
};

/// CVODE (SUNDIALS) on y' = f(t, y), with a dense Jacobian by differences. Prints nothing: what
/// fails is an exception, std::runtime_error.
class CvodeSession {
 public:
  /// From y = 0 at time 0. @param user  is given to `rate`
  CvodeSession(std::size_t states, CVRhsFn rate, void* user, const CvodeSettings& settings);
  ~CvodeSession();
  CvodeSession(const CvodeSession&) = delete;
  CvodeSession& operator=(const CvodeSession&) = delete;

  std::span<double> y() noexcept;
  /// Starts again from `y`, for instance where the right-hand side jumps.
  void Restart(double time_s);
  /// To `until_s` and not beyond.
  void Advance(double until_s);
  /// Evaluations of the right-hand side since the last start, those of the Jacobian included.
  long rate_calls() const;

 private:
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* memory_ = nullptr;
  sunrealtype time_s_ = 0.0;
};

}  // namespace flexarm
