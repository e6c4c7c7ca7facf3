#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace flexarm {

/// How long something takes: the median of repetitions, and how far they differ.
struct Timing {
  double least_s = 0.0;
  double median_s = 0.0;
  double lower_quartile_s = 0.0;
  double upper_quartile_s = 0.0;
  std::size_t repetitions = 0;
};

/// The value below which a share of the samples lies, between two of them linearly.
/// @param samples  not empty
/// @param share    0..1
double Quantile(std::vector<double> samples, double share);

/// @param samples_s  not empty
Timing TimingOf(const std::vector<double>& samples_s);

/// How often and how long a timing is repeated.
struct Repetitions {
  std::size_t count;  ///< samples
  double each_s;      ///< at least this long for one sample: calls are repeated within it
};

/// Processor time of this thread, s: what other programs take of the processor is not in it.
double ThreadTime_s();
/// Time since some instant, s.
double WallTime_s();

/// Processor time of one call of `work`.
///
/// One call first, for what only a first call does. The overhead of a call through std::function,
/// some 2 ns, is in the result.
Timing TimeWork(const std::function<void()>& work, const Repetitions& repetitions);

}  // namespace flexarm
