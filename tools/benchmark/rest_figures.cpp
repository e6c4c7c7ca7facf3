#include "tools/benchmark/rest_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flexarm {
namespace {

constexpr double kInTime_s = 0.3;

// Mean and largest value of measure `i` over the completed runs.
struct Spread {
  double mean, largest;
};

Spread SpreadOf(const std::vector<SweepRow>& completed, std::size_t i) {
  double sum = 0.0, largest = -std::numeric_limits<double>::infinity();
  for (const SweepRow& row : completed) {
    sum += row.measure[i];
    largest = std::max(largest, row.measure[i]);
  }
  return {.mean = sum / static_cast<double>(completed.size()), .largest = largest};
}

// The mean over the runs that have the measure; NaN: none has.
double MeanOfThoseWith(const std::vector<SweepRow>& completed, std::size_t i) {
  double sum = 0.0;
  int count = 0;
  for (const SweepRow& row : completed) {
    if (std::isnan(row.measure[i])) continue;
    sum += row.measure[i];
    ++count;
  }
  return sum / count;
}

std::size_t HaveBoth(const std::vector<SweepRow>& completed, std::size_t i, std::size_t j) {
  return static_cast<std::size_t>(
      std::count_if(completed.begin(), completed.end(), [=](const SweepRow& row) {
        return !std::isnan(row.measure[i]) && !std::isnan(row.measure[j]);
      }));
}

}  // namespace

RestFigures RestFiguresOf(const std::vector<SweepRow>& rows) {
  std::vector<SweepRow> completed;
  for (SweepRow row : rows) {
    if (!row.completed) continue;
    double& settling_s = row.measure[kSettling];
    if (std::isnan(settling_s)) settling_s = std::numeric_limits<double>::infinity();
    completed.push_back(row);
  }
  if (completed.empty()) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {.latest_settling_s = kNone,
            .target_error_max_mm = kNone,
            .residual_mean_mm = kNone,
            .residual_max_mm = kNone,
            .motion_mean_mm = kNone,
            .motion_max_mm = kNone,
            .rms_mean_deg = {kNone, kNone},
            .at_rest_over_bound = {kNone, kNone},
            .on_target_over_bound = {kNone, kNone}};
  }
  const Spread residual = SpreadOf(completed, kResidual), motion = SpreadOf(completed, kMotion);
  return {.settled_in_time = static_cast<std::size_t>(std::count_if(
              completed.begin(), completed.end(),
              [](const SweepRow& row) { return row.measure[kSettling] <= kInTime_s; })),
          .latest_settling_s = SpreadOf(completed, kSettling).largest,
          .target_error_max_mm = SpreadOf(completed, kTargetError).largest,
          .residual_mean_mm = residual.mean,
          .residual_max_mm = residual.largest,
          .motion_mean_mm = motion.mean,
          .motion_max_mm = motion.largest,
          .rms_mean_deg = {SpreadOf(completed, kRms1).mean, SpreadOf(completed, kRms2).mean},
          .at_rest_over_bound = {MeanOfThoseWith(completed, kFirstAtRest),
                                 MeanOfThoseWith(completed, kLaterAtRest)},
          .on_target_over_bound = {MeanOfThoseWith(completed, kFirstOnTarget),
                                   MeanOfThoseWith(completed, kLaterOnTarget)},
          .at_rest = HaveBoth(completed, kFirstAtRest, kLaterAtRest),
          .on_target = HaveBoth(completed, kFirstOnTarget, kLaterOnTarget)};
}

}  // namespace flexarm
