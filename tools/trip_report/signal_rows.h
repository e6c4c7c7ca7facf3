#pragma once

#include <cstddef>
#include <vector>

namespace flexarm {

/// Values of several signals over a span of time, in a limited number of rows, whatever the
/// duration: filled sample by sample, so that a long log is never in memory.
///
/// More than `most` samples become at most `most` rows: the time is divided into parts, and two
/// rows hold the least and the greatest value of each signal in a part. No peak is lost. Where
/// samples are missing, a row of NaN stands between, so that no curve crosses the gap.
class SignalRows {
 public:
  /// @param from_s, until_s  samples outside are left out
  /// @param period_s         of the samples
  SignalRows(std::size_t signals, double from_s, double until_s, double period_s, std::size_t most);

  /// In order of time. @param value  one a signal
  void Add(double time_s, const std::vector<double>& value);
  /// After the last sample.
  void Finish();

  const std::vector<double>& time_s() const { return time_s_; }
  const std::vector<double>& value(std::size_t signal) const { return value_[signal]; }
  bool empty() const { return time_s_.empty(); }

 private:
  void Append(double time_s, const std::vector<double>& value);
  void FlushPart();

  double from_s_, until_s_, period_s_;
  std::size_t parts_ = 0;  // 0: every sample is a row
  std::vector<double> time_s_;
  std::vector<std::vector<double>> value_;  // by signal
  double last_s_ = 0.0;                     // of the sample before
  bool any_ = false;
  std::size_t part_ = 0;                 // that is being filled
  std::vector<double> least_, most_of_;  // of it, by signal; empty: nothing yet
};

}  // namespace flexarm
