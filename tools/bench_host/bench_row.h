#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench_host/flop_counter.h"
#include "tools/bench_host/timing.h"

namespace flexarm {

/// A figure of one thing over that of another, of the same run.
struct BenchRatio {
  std::string name;  ///< key: "speed_over_cvode"
  std::string unit;  ///< for people: "times CVODE's speed"
  double value;
  std::optional<double> bar;  ///< that it should reach
};

/// A row of the table: what was measured, or why it was not.
struct BenchRow {
  std::string name;  ///< key: "step-sobel"
  std::string what;  ///< for people, in Markdown
  std::optional<Timing> time{};
  std::optional<WorkCount> work{};  ///< of what `time` is the time of
  std::string counted{};            ///< where the count comes from, or why there is none
  std::optional<BenchRatio> ratio{};
  std::string result{};        ///< further figures, for people
  std::string not_measured{};  ///< why, and what to do; empty: measured
  bool check_failed = false;   ///< what was to be compared differs
};

/// `counted` of a row whose count is that of CountWork.
inline constexpr const char* kSingleStepped = "single-stepped";

/// A row that could not be measured.
BenchRow NotMeasured(std::string name, std::string what, std::string why);

/// Floating-point operations a second, over those of a bound; nothing without a count or time.
std::optional<double> BoundShare(const BenchRow& row, double bound_flops_per_s);

/// Adds the count of `work`, or why there is none.
void AddCount(BenchRow* row, const CountResult& counted);

}  // namespace flexarm
