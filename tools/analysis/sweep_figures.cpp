#include "tools/analysis/sweep_figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flexarm {
namespace {

double ParameterAt(const ParametricSweep& sweep, std::ptrdiff_t place) {
  return sweep.point[static_cast<std::size_t>(place)].value;
}

}  // namespace

std::vector<double> Values(const ParametricSweep& sweep, Signal signal,
                           double SignalMeasures::* measure) {
  std::vector<double> values;
  for (const ParametricPoint& point : sweep.point) values.push_back(point.signal[signal].*measure);
  return values;
}

std::vector<double> FreeFrequenciesHz(const ParametricSweep& sweep, std::size_t mode) {
  std::vector<double> values;
  for (const ParametricPoint& point : sweep.point) values.push_back(point.free_hz[mode]);
  return values;
}

std::vector<double> HeldFrequenciesHz(const ParametricSweep& sweep) {
  std::vector<double> values;
  for (const ParametricPoint& point : sweep.point) values.push_back(point.held_hz);
  return values;
}

std::vector<double> LeftInPercent(const ParametricSweep& sweep, Signal signal) {
  std::vector<double> left = Values(sweep, signal, &SignalMeasures::free_rms);
  const double first = left.front();
  for (double& value : left) value *= 100.0 / first;
  return left;
}

std::vector<double> From(double least, const ParametricSweep& sweep,
                         const std::vector<double>& values) {
  std::vector<double> rest;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (sweep.point[i].value >= least) rest.push_back(values[i]);
  }
  return rest;
}

bool Rises(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] < values[i - 1] * (1.0 - kScatter)) return false;
  }
  return values.back() > values.front() * (1.0 + kScatter);
}

bool Falls(std::vector<double> values) {
  std::reverse(values.begin(), values.end());
  return Rises(values);
}

double ParameterOfLargest(const ParametricSweep& sweep, const std::vector<double>& values) {
  return ParameterAt(sweep, std::max_element(values.begin(), values.end()) - values.begin());
}

double ParameterOfLeast(const ParametricSweep& sweep, const std::vector<double>& values) {
  return ParameterAt(sweep, std::min_element(values.begin(), values.end()) - values.begin());
}

double SpreadInPercent(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return 200.0 * (*high - *low) / (*high + *low);
}

double DropInPercent(const std::vector<double>& values) {
  return 100.0 * (values.front() - values.back()) / values.front();
}

double BowInPercent(const ParametricSweep& sweep, const std::vector<double>& values) {
  const double from = sweep.point.front().value, span = sweep.point.back().value - from;
  const double rise = values.back() - values.front();
  double worst = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double line = values.front() + rise * (sweep.point[i].value - from) / span;
    worst = std::max(worst, std::abs(values[i] - line));
  }
  return 100.0 * worst / std::abs(rise);
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

double Exponent(const ParametricSweep& sweep, const std::vector<double>& values) {
  return std::log(values.back() / values.front()) /
         std::log(sweep.point.back().value / sweep.point.front().value);
}

}  // namespace flexarm
