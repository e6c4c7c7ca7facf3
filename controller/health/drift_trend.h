#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "controller/health/drift_channel.h"
#include "controller/health/drift_scale.h"
#include "controller/health/health_history.h"

namespace flexarm {

/// Of the first runs with a plant and a calibration, at most so many are the reference.
inline constexpr std::size_t kReferenceRuns = 10;
/// A change of so many standard errors is an alarm. See DriftTrends.
inline constexpr double kAlarmSigmas = 4.0;

enum class DriftVerdict : std::uint8_t {
  kUnknown,  ///< fewer than two runs tell of the channel
  kSteady,
  kDrifts,  ///< an alarm
};

/// A channel over the runs, in its unit.
struct DriftTrend {
  DriftVerdict verdict = DriftVerdict::kUnknown;
  std::size_t runs = 0;       ///< that tell of it
  DriftFigure newest{};       ///< of the newest run
  DriftFigure reference{};    ///< mean of the reference runs
  std::string reference_utc;  ///< start of the last of them
  DriftFigure change{};       ///< of the newest three against the reference, with the floor
  DriftFigure per_run{};      ///< slope over the last runs
  double sigmas = 0.0;        ///< of the clearest of the three tests, with the floor; signed
  double clarity = 0.0;       ///< the same without the floor, unsigned: standard errors
};

/// The trend of each channel of the newest run.
///
/// A run tells of a channel if its standard error is below a fixed share of the prior. Compared are
/// only runs with the newest one's plant and, for a gauge, its calibration; the first half of them,
/// at most kReferenceRuns, is the reference. Three tests, each against its standard error with the
/// channel's floor (drift_scale.h) added in quadrature: the newest run, the mean of the newest
/// three, and the slope over the last ten. Means and slopes are weighted by 1 / se^2. The largest
/// beyond kAlarmSigmas is an alarm.
///
/// An alarm of less than 10 standard errors beside one of more than 50 is left out: it may be the
/// effect of the other, by what the linearised model misses.
/// @param channels  of the config, with their scales
std::vector<DriftTrend> DriftTrends(const std::vector<DriftChannel>& channels,
                                    const std::vector<DriftScale>& scales,
                                    const HealthHistory& history);

/// "gauge 7 of link 1: gain 4.1 % (+-0.3 %) lower than in the runs to 2026-10-01; check .."
std::string AlarmText(const DriftChannel& channel, const DriftTrend& trend);

/// "4.1 %"
std::string FigureText(DriftKind kind, double value);

}  // namespace flexarm
