#include "tools/sweep/sweep_row.h"

#include <cmath>
#include <limits>

#include "tools/sweep/fast_moves.h"

namespace flexarm {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

SweepRow RowOf(std::size_t point, const SimulationRequest& request,
               const SimulationResult& result) {
  const RunMetrics& m = result.metrics;
  const BoundRatios ratios = RatiosOf(request, m);
  return {.point = point,
          .completed = result.completed,
          .trip = result.trip == TripCause::kNone ? "" : ToString(result.trip),
          .refused = {},
          .ticks = result.ticks,
          .measure = {
              m.joint_rms_error_deg[0], m.joint_rms_error_deg[1], m.joint_final_error_deg[0],
              m.joint_final_error_deg[1], m.tip_settling_time_s.value_or(kNone),
              m.tip_residual_rms_mm, m.peak_torque_nm[0], m.peak_torque_nm[1], m.torque_rms_nm[0],
              m.torque_rms_nm[1], m.tip_motion_rms_mm, m.tip_target_error_mm, ratios.first_at_rest,
              ratios.later_at_rest, ratios.first_on_target, ratios.later_on_target}};
}

SweepRow RefusedRow(std::size_t point, const std::string& why) {
  SweepRow row{.point = point, .trip = {}, .refused = why};
  row.measure.fill(kNone);
  return row;
}

bool SameOutcome(const SweepRow& a, const SweepRow& b) {
  for (std::size_t i = 0; i < a.measure.size(); ++i) {
    const bool both_none = std::isnan(a.measure[i]) && std::isnan(b.measure[i]);
    if (!both_none && a.measure[i] != b.measure[i]) return false;
  }
  return a.point == b.point && a.completed == b.completed && a.trip == b.trip &&
         a.refused == b.refused && a.ticks == b.ticks;
}

}  // namespace flexarm
