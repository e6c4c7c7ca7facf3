#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/identification/run_comparison.h"

namespace flexarm {

/// A number of the config that the search may change.
struct FreeParameter {
  std::string key;   ///< dotted, as in --set
  double start;      ///< what the config says, in the unit of the key
  double low, high;  ///< searched between these
  bool logarithmic;  ///< its logarithm is searched: both bounds are positive
};

/// Reads "KEY" (a factor of 10 to both sides of what the config says, by its logarithm) or
/// "KEY=LOW:HIGH" (between these, evenly).
/// @throws InputError  also if a bound breaks a rule of the config
FreeParameter ParseFreeParameter(const RigConfig& config, const std::string& text);

/// What was found for one of them.
struct FoundParameter {
  FreeParameter free;
  double found;           ///< in the unit of its key, like start and bounds
  double standard_error;  ///< infinite if the run says nothing about it
  bool at_bound;          ///< the run asks for more than was allowed
};

struct Identification {
  std::vector<FoundParameter> parameter;
  RigConfig config;             ///< with what was found
  double start_misfit, misfit;  ///< Misfit() before and after, dimensionless
  int predictions;              ///< of the whole run, that the search took
  bool converged;               ///< else it stopped at its limit of predictions
};

/// Mean over the signals of the mean square error, each in its own spread: 0 is perfect, 1 no
/// better than the means.
double Misfit(const RunComparison& run, const Eigen::MatrixXd& predicted);

/// Finds the parameters that let the model predict the run best (output error, NLopt's BOBYQA).
///
/// BOBYQA asks for no derivatives: with dry friction the prediction has kinks. Standard errors come
/// from central differences at the end, J, and the residuals r, whose correlation in time is taken
/// into account up to 1 s (Newey and West):
///   cov = (J'J)^-1 (sum over lags of weighted J' r r' J) (J'J)^-1
/// They know nothing of what the model lacks.
/// @param progress  called with the number of predictions so far; may be empty
/// @throws InputError if the arm of the start does not survive its own prediction
Identification Identify(const RigConfig& config, const RunComparison& run,
                        const std::vector<FreeParameter>& free,
                        const std::function<void(std::size_t)>& progress = {});

/// The most predictions that the search may take.
std::size_t MostPredictions(std::size_t free_parameters);

}  // namespace flexarm
