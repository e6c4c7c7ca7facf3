#include "tools/identification/identification.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <optional>

#include "controller/runlog/errors.h"
#include "model/math/dense_decompositions.h"
#include "model/problem_list.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

constexpr double kFactor = 10.0;      // half-width factor of a range that was not given
constexpr double kTolerance = 2e-4;   // of a parameter, relative to its range
constexpr double kFirstStep = 0.03;   // relative to the range
constexpr double kNewStep = 0.2;      // of a search that starts again where one ended
constexpr double kBetter = 0.99;      // a misfit below this share of the last is worth another
constexpr double kDifference = 1e-3;  // of the central differences, relative to the range
constexpr double kCorrelation_s = 1.0;
constexpr double kLost = 1e3;  // misfit if the simulated arm diverges

double FromUnit(const FreeParameter& p, double x) {
  if (p.logarithmic) return p.low * std::pow(p.high / p.low, x);
  return p.low + x * (p.high - p.low);
}

double ToUnit(const FreeParameter& p, double value) {
  if (p.logarithmic) return std::log(value / p.low) / std::log(p.high / p.low);
  return (value - p.low) / (p.high - p.low);
}

// d value / d x
double UnitSlope(const FreeParameter& p, double x) {
  return p.logarithmic ? FromUnit(p, x) * std::log(p.high / p.low) : p.high - p.low;
}

RigConfig With(const RigConfig& config, const std::vector<FreeParameter>& free,
               const std::vector<double>& x) {
  std::vector<std::string> overrides;
  for (std::size_t i = 0; i < free.size(); ++i) {
    overrides.push_back(free[i].key + "=" + NumberText(FromUnit(free[i], x[i])));
  }
  return WithOverrides(config, overrides);
}

// Stacks the differences sample by sample. Each signal is weighted so that the squared norm is the
// sum of the signals' mean squares relative to their spreads; 0 where nothing is compared.
Eigen::VectorXd Stacked(const RunComparison& run, const Eigen::MatrixXd& difference) {
  const Eigen::ArrayXd count = run.compared().colwise().sum().transpose();
  const Eigen::VectorXd weight = (run.spread().array() * count.sqrt()).inverse();
  const Eigen::MatrixXd scaled =
      (difference.array() * run.compared().array()).matrix() * weight.asDiagonal();
  const Eigen::MatrixXd by_sample = scaled.transpose();
  return Eigen::Map<const Eigen::VectorXd>(by_sample.data(), by_sample.size());
}

Eigen::MatrixXd Jacobian(const RigConfig& config, const RunComparison& run,
                         const std::vector<FreeParameter>& free, const std::vector<double>& x) {
  Eigen::MatrixXd J(run.measured().size(), static_cast<Eigen::Index>(free.size()));
  ParallelFor(free.size(), [&](std::size_t i) {
    std::vector<double> above = x, below = x;
    above[i] = std::min(1.0, x[i] + kDifference);
    below[i] = std::max(0.0, x[i] - kDifference);
    const Eigen::MatrixXd change =
        run.Predict(With(config, free, above)) - run.Predict(With(config, free, below));
    J.col(static_cast<Eigen::Index>(i)) = Stacked(run, change) / (above[i] - below[i]);
  });
  return J;
}

// The search for NLopt: a function of parameters scaled to 0 .. 1.
struct Search {
  const RigConfig& config;
  const RunComparison& run;
  const std::vector<FreeParameter>& free;
  const std::function<void(std::size_t)>& progress;
  std::size_t predictions = 0;

  double operator()(const std::vector<double>& x) {
    ++predictions;
    if (progress) progress(predictions);
    try {
      return Misfit(run, run.Predict(With(config, free, x)));
    } catch (const ConfigError&) {  // each bound is valid by itself, but not every combination
      return kLost;
    }
  }
};

double Objective(const std::vector<double>& x, std::vector<double>&, void* search) {
  return (*static_cast<Search*>(search))(x);
}

// Minimises from *x, which it leaves at the best point. Returns the least misfit, or none if the
// limit of predictions was reached first.
std::optional<double> MinimiseOnce(Search* search, double first_step, std::vector<double>* x) {
  const std::size_t left = MostPredictions(x->size()) - 1 - search->predictions;
  nlopt::opt optimiser(nlopt::LN_BOBYQA, static_cast<unsigned>(x->size()));
  optimiser.set_min_objective(Objective, search);
  optimiser.set_lower_bounds(0.0);
  optimiser.set_upper_bounds(1.0);
  optimiser.set_initial_step(first_step);
  optimiser.set_xtol_abs(kTolerance);
  optimiser.set_maxeval(static_cast<int>(left));
  double misfit = 0.0;
  try {
    if (optimiser.optimize(*x, misfit) == nlopt::MAXEVAL_REACHED) return std::nullopt;
  } catch (const nlopt::roundoff_limited&) {
    // x and misfit are the best point
  }
  return misfit;
}

// Friction that starts a joint late or early makes false minima: a search that ended starts again
// from there with a wide step, until that finds nothing better. False: the limit of predictions was
// reached first.
bool Minimise(Search* search, std::vector<double>* x) {
  std::optional<double> least = MinimiseOnce(search, kFirstStep, x);
  while (least) {
    std::vector<double> other = *x;
    const std::optional<double> misfit = MinimiseOnce(search, kNewStep, &other);
    if (!misfit) return false;
    if (*misfit < *least) *x = other;
    if (!(*misfit < kBetter * *least)) return true;
    least = misfit;
  }
  return false;
}

// Newey and West: sum of g_k g_(k-l)' over the lags, with weights that fall to zero.
Eigen::MatrixXd ScoreCovariance(const Eigen::MatrixXd& J, const Eigen::VectorXd& residual,
                                Eigen::Index signals, Eigen::Index lags) {
  const Eigen::Index samples = residual.size() / signals;
  Eigen::MatrixXd score(samples, J.cols());
  for (Eigen::Index k = 0; k < samples; ++k) {
    score.row(k) =
        residual.segment(k * signals, signals).transpose() * J.middleRows(k * signals, signals);
  }
  Eigen::MatrixXd sum = score.transpose() * score;
  for (Eigen::Index lag = 1; lag <= std::min(lags, samples - 1); ++lag) {
    const Eigen::Index rows = samples - lag;
    const Eigen::MatrixXd product = score.bottomRows(rows).transpose() * score.topRows(rows);
    const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    sum += weight * (product + product.transpose());
  }
  return sum;
}

Eigen::VectorXd StandardErrors(const RigConfig& config, const RunComparison& run,
                               const std::vector<FreeParameter>& free,
                               const std::vector<double>& x) {
  const Eigen::MatrixXd J = Jacobian(config, run, free, x);
  const Eigen::VectorXd residual =
      Stacked(run, run.measured() - run.Predict(With(config, free, x)));
  const auto lags = static_cast<Eigen::Index>(std::ceil(kCorrelation_s / config.loop.period_s()));
  const Eigen::MatrixXd S = ScoreCovariance(J, residual, run.measured().cols(), lags);
  const Eigen::MatrixXd normal = J.transpose() * J;
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(normal);
  const auto n = static_cast<Eigen::Index>(free.size());
  if (solver.rank() < n) {
    return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  }
  const Eigen::MatrixXd half = solver.solve(S);
  const Eigen::MatrixXd covariance = solver.solve(half.transpose());
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

// Both ends of a range must be valid with the rest of the config.
void CheckBound(const RigConfig& config, const std::string& key, double bound) {
  try {
    WithOverrides(config, {key + "=" + NumberText(bound)});
  } catch (const ConfigError& error) {
    throw InputError("--free " + key + ": the bound " + NumberText(bound) +
                     " is not allowed; give another as " + key + "=LOW:HIGH\n" + error.what());
  }
}

double ParsedNumber(const std::string& text, const std::string& whole) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    throw InputError("--free " + whole + ": found \"" + text +
                     "\", expected KEY or KEY=LOW:HIGH with two numbers");
  }
  return value;
}

}  // namespace

FreeParameter ParseFreeParameter(const RigConfig& config, const std::string& text) {
  const std::size_t equals = text.find('=');
  FreeParameter free{};
  free.key = text.substr(0, equals);
  const std::optional<double> start = NumberAt(config, free.key);
  if (!start) {
    throw InputError("--free " + text + ": the config has no number at " + free.key +
                     "; expected a key as in --set");
  }
  free.start = *start;
  if (equals == std::string::npos) {
    if (!(free.start > 0.0)) {
      throw InputError("--free " + text + ": starts from " + NumberText(free.start) +
                       ", which gives no range; expected " + free.key + "=LOW:HIGH");
    }
    free.low = free.start / kFactor;
    free.high = free.start * kFactor;
    free.logarithmic = true;
  } else {
    const std::string range = text.substr(equals + 1);
    const std::size_t colon = range.find(':');
    free.low = ParsedNumber(range.substr(0, colon), text);
    free.high = ParsedNumber(colon == std::string::npos ? "" : range.substr(colon + 1), text);
    if (!(free.low < free.start && free.start < free.high)) {
      throw InputError("--free " + text + ": starts from " + NumberText(free.start) +
                       "; expected LOW below and HIGH above this value");
    }
  }
  CheckBound(config, free.key, free.low);
  CheckBound(config, free.key, free.high);
  return free;
}

double Misfit(const RunComparison& run, const Eigen::MatrixXd& predicted) {
  const double misfit = Stacked(run, run.measured() - predicted).squaredNorm() /
                        static_cast<double>(run.measured().cols());
  return std::isfinite(misfit) ? std::min(misfit, kLost) : kLost;
}

std::size_t MostPredictions(std::size_t free_parameters) { return 300 * (free_parameters + 1); }

Identification Identify(const RigConfig& config, const RunComparison& run,
                        const std::vector<FreeParameter>& free,
                        const std::function<void(std::size_t)>& progress) {
  std::vector<double> x;
  x.reserve(free.size());
  for (const FreeParameter& p : free) x.push_back(ToUnit(p, p.start));
  Identification out{};
  out.start_misfit = Misfit(run, run.Predict(config));
  if (out.start_misfit >= kLost) {
    throw InputError(run.file().string() +
                     ": the simulated arm diverges under the run's torques; expected start values "
                     "nearer to the rig's");
  }
  Search search{.config = config, .run = run, .free = free, .progress = progress};
  out.converged = Minimise(&search, &x);
  out.predictions = static_cast<int>(search.predictions);
  out.config = With(config, free, x);
  out.misfit = Misfit(run, run.Predict(out.config));
  const Eigen::VectorXd error = StandardErrors(config, run, free, x);
  out.parameter.reserve(free.size());
  for (std::size_t i = 0; i < free.size(); ++i) {
    const double sigma = error(static_cast<Eigen::Index>(i)) * UnitSlope(free[i], x[i]);
    out.parameter.push_back({.free = free[i],
                             .found = FromUnit(free[i], x[i]),
                             .standard_error = sigma,
                             .at_bound = x[i] < kTolerance || x[i] > 1.0 - kTolerance});
  }
  return out;
}

}  // namespace flexarm
