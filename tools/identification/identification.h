#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/identification/run_comparison.h"

namespace flexarm {

/// A parameter of the config that the search may change.
struct FreeParameter {
  std::string key;   ///< dotted, as in --set
  double start;      ///< value of the config, in the unit of the key
  double low, high;  ///< bounds of the search
  bool logarithmic;  ///< the search uses its logarithm: both bounds are positive
};

/// Reads "KEY" (searched from a tenth to ten times the config's value, logarithmically) or
/// "KEY=LOW:HIGH" (between these bounds, linearly).
/// @throws InputError  also if a bound breaks a rule of the config
FreeParameter ParseFreeParameter(const RigConfig& config, const std::string& text);

/// Result for one parameter.
struct FoundParameter {
  FreeParameter free;
  double found;           ///< in the unit of its key, like start and bounds
  double standard_error;  ///< infinite if the run does not determine it
  bool at_bound;          ///< the search ended at a bound of the range
};

struct Identification {
  std::vector<FoundParameter> parameter;
  RigConfig config;             ///< with the identified values
  double start_misfit, misfit;  ///< Misfit() before and after, dimensionless
  int predictions;              ///< number of predictions of the whole run in the search
  bool converged;               ///< else the search stopped at its limit of predictions
};

/// Mean over the signals of the mean square error relative to the signal's variance: 0 is a perfect
/// prediction, 1 is no better than the mean of the signal.
double Misfit(const RunComparison& run, const Eigen::MatrixXd& predicted);

/// Identifies parameters by the output-error method: those that predict the run best (NLopt's
/// BOBYQA).
///
/// BOBYQA needs no derivatives: with dry friction the prediction is not smooth. Friction also makes
/// false minima, so the search starts again where it ended, with a wide step, until that finds
/// nothing better. Standard errors come from central differences at the end, J, and the residuals
/// r, whose correlation in time is taken into account up to 1 s (Newey and West):
///   cov = (J'J)^-1 (sum over lags of weighted J' r r' J) (J'J)^-1
/// They do not include errors of the model structure.
/// @param progress  called with the number of predictions so far; may be empty
/// @throws InputError if the simulated arm diverges at the start values
Identification Identify(const RigConfig& config, const RunComparison& run,
                        const std::vector<FreeParameter>& free,
                        const std::function<void(std::size_t)>& progress = {});

/// Limit on the number of predictions of the search.
std::size_t MostPredictions(std::size_t free_parameters);

}  // namespace flexarm
