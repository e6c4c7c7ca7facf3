#include "controller/step/fault_detection.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "model/units.h"

namespace flexarm {
namespace {

constexpr int kRateTicks = 2;
constexpr int kMissingTicks = 2;  // no valid reading for two periods
constexpr double kStalePeriods = 2.0;

std::size_t FirstChannel(std::uint32_t mask) noexcept {
  return mask == 0 ? 0 : static_cast<std::size_t>(std::countr_zero(mask)) + 1;
}

constexpr TripCause PerJoint(TripCause joint1, std::size_t i) noexcept {
  return static_cast<TripCause>(static_cast<std::size_t>(joint1) + i);
}

}  // namespace

FaultDetection::FaultDetection(const SafetyConfig& safety, const EstimatorConfig& estimator,
                               double period_s, std::uint32_t counters_present,
                               const std::array<std::uint32_t, 2>& gauges,
                               const std::array<double, 2>& joint_stiffness_nm_per_rad)
    : safety_(safety),
      estimator_(estimator),
      period_s_(period_s),
      counters_present_(counters_present),
      gauges_(gauges),
      joint_stiffness_(joint_stiffness_nm_per_rad),
      // Not before the window is full.
      rest_ticks_needed_(std::max(static_cast<int>(std::ceil(safety.rest_time_s / period_s)),
                                  static_cast<int>(kRestWindow) + 1)) {}

void FaultDetection::Reset() noexcept {
  in_a_row_ = {};
  rest_ticks_ = 0;
  ring_ = 0;
  started_ = false;
}

void FaultDetection::Raise(TripCause cause, bool present, int ticks, double value, double limit,
                           std::size_t channel) noexcept {
  int& in_a_row = in_a_row_[static_cast<std::size_t>(cause)];
  in_a_row = present ? in_a_row + 1 : 0;
  if (in_a_row < ticks) return;
  if (verdict_.faults == 0 || CauseBit(cause) < (verdict_.faults & (~verdict_.faults + 1))) {
    verdict_.value = value;
    verdict_.limit = limit;
    verdict_.channel = static_cast<std::uint16_t>(channel);
  }
  verdict_.faults |= CauseBit(cause);
  in_a_row = ticks;  // saturated: cannot overflow
}

FaultDetection::Verdict FaultDetection::Judge(const LoopFacts& facts) noexcept {
  verdict_ = {};
  Raise(TripCause::kStaleFrame, facts.frame_age_s > kStalePeriods * period_s_, 1, facts.frame_age_s,
        kStalePeriods * period_s_, 0);
  JudgeJoints(facts);
  JudgeCounters(facts);
  JudgeStrain(facts);
  JudgeEstimate(facts);
  verdict_.at_rest = JudgeRest(facts);
  verdict_.may_damp = MayDamp(facts);
  return verdict_;
}

void FaultDetection::JudgeJoints(const LoopFacts& facts) noexcept {
  const Eigen::Index dof = facts.estimate->x.size() / 2;
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle = std::fabs(facts.counters->angle_rad[i]);
    const double soft = safety_.soft_angle_deg[i] * kRadPerDeg;
    Raise(PerJoint(TripCause::kSoftLimit1, i),
          !(angle <= soft) && facts.mode != LoopMode::kRegulate, 1, angle, soft, i + 1);
    const double rate = std::fabs(facts.estimate->x(dof + static_cast<Eigen::Index>(i)));
    Raise(PerJoint(TripCause::kHubRate1, i), rate > safety_.hub_rate_rad_s[i], kRateTicks, rate,
          safety_.hub_rate_rad_s[i], i + 1);
    const double strain = std::fabs(facts.modes->root_strain[i]);
    Raise(PerJoint(TripCause::kBendingStrain1, i),
          facts.modes->valid[i] && !(strain <= safety_.strain_limit[i]), 1, strain,
          safety_.strain_limit[i], i + 1);
  }
}

void FaultDetection::JudgeCounters(const LoopFacts& facts) noexcept {
  const DecodedCounters& counters = *facts.counters;
  Raise(TripCause::kEncoderJump, counters.jumped != 0, 1, 0.0, estimator_.max_joint_rate_rad_s,
        FirstChannel(counters.jumped));

  std::uint32_t silent = 0;
  int longest = 0;
  for (std::size_t i = 0; i < kCounters; ++i) {
    if ((counters_present_ >> i & 1u) == 0 || counters.missing_ticks[i] < kMissingTicks) continue;
    silent |= std::uint32_t{1} << i;
    longest = std::max(longest, counters.missing_ticks[i]);
  }
  Raise(TripCause::kNoCounterReading, silent != 0, 1, longest, kMissingTicks, FirstChannel(silent));

  double worst = 0.0;
  std::size_t joint = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint32_t both = std::uint32_t{1} << i | std::uint32_t{1} << (i + 2);
    if ((counters.good & both) != both) continue;
    const double torsion = facts.applied_torque_nm[i] / joint_stiffness_[i];
    const double apart = std::fabs(counters.angle_rad[i + 2] - counters.angle_rad[i] - torsion);
    if (apart <= worst) continue;
    worst = apart;
    joint = i + 1;
  }
  const bool judged = facts.mode != LoopMode::kOpenLoop;
  Raise(TripCause::kHubAgainstRotor, judged && worst > estimator_.hub_rotor_limit_rad,
        estimator_.fault_ticks, worst, estimator_.hub_rotor_limit_rad, joint);
}

void FaultDetection::JudgeStrain(const LoopFacts& facts) noexcept {
  const FittedModes& modes = *facts.modes;
  for (std::size_t i = 0; i < 2; ++i) {
    Raise(PerJoint(TripCause::kNoStrainReading1, i), gauges_[i] != 0 && !modes.valid[i],
          kMissingTicks, std::popcount(modes.used & gauges_[i]), estimator_.modes_per_link, i + 1);
  }
  const int ticks = estimator_.fault_ticks;
  const bool judged = facts.mode != LoopMode::kOpenLoop;
  Raise(TripCause::kStrainStuck, judged && modes.stuck != 0, ticks, 0.0,
        estimator_.strain_stuck_limit, FirstChannel(modes.stuck));
  Raise(TripCause::kStrainSaturated, modes.saturated != 0, ticks, 0.0, 0.0,
        FirstChannel(modes.saturated));
  Raise(TripCause::kStrainOutOfFamily, judged && modes.outlier != 0, ticks, modes.worst_outlier,
        estimator_.strain_family_limit, FirstChannel(modes.outlier));
}

void FaultDetection::JudgeEstimate(const LoopFacts& facts) noexcept {
  const StateEstimator::Estimate& estimate = *facts.estimate;
  Raise(TripCause::kStateNotFinite, !estimate.x.allFinite(), 1, 0.0, 0.0, 0);
  const double hub1 = std::fabs(estimate.innovation[0]), hub2 = std::fabs(estimate.innovation[1]);
  const double worst = std::fmax(hub1, hub2);
  const bool judged = facts.mode != LoopMode::kOpenLoop;
  Raise(TripCause::kEstimatorResidual, judged && worst > estimator_.innovation_limit_rad,
        estimator_.fault_ticks, worst, estimator_.innovation_limit_rad, hub1 >= hub2 ? 1 : 2);
}

// Each comparison is false for NaN. The pluck test (kOpenLoop) has no torque but its own.
bool FaultDetection::MayDamp(const LoopFacts& facts) const noexcept {
  if (facts.mode == LoopMode::kOpenLoop || !facts.estimate->x.allFinite()) return false;
  const Eigen::Index dof = facts.estimate->x.size() / 2;
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = std::fabs(facts.estimate->x(dof + static_cast<Eigen::Index>(i)));
    const double strain = std::fabs(facts.modes->root_strain[i]);
    const bool measured = facts.modes->valid[i] && (facts.counters->good >> i & 1U) != 0;
    if (!measured || !(rate < kDampedTo * safety_.hub_rate_rad_s[i]) ||
        !(strain < kDampedTo * safety_.strain_limit[i])) {
      return false;
    }
  }
  return true;
}

bool FaultDetection::JudgeRest(const LoopFacts& facts) noexcept {
  if (!started_) {  // as if the arm had been at rest here before
    started_ = true;
    hub_before_.fill({facts.counters->angle_rad[0], facts.counters->angle_rad[1]});
    root_strain_before_ = facts.modes->root_strain;
  }
  bool slow = true, complete = true;
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle = facts.counters->angle_rad[i];
    const double hub_rate =
        (angle - hub_before_[ring_][i]) / (static_cast<double>(kRestWindow) * period_s_);
    hub_before_[ring_][i] = angle;
    slow = slow && std::fabs(hub_rate) < safety_.rest_hub_rate_rad_s;
    if (!facts.modes->valid[i]) {  // unknown: this sample is no evidence of rest
      complete = complete && gauges_[i] == 0;
      continue;
    }
    const double strain_rate = (facts.modes->root_strain[i] - root_strain_before_[i]) / period_s_;
    slow = slow && std::fabs(strain_rate) < safety_.rest_strain_rate_per_s;
    root_strain_before_[i] = facts.modes->root_strain[i];
  }
  ring_ = (ring_ + 1) % kRestWindow;
  rest_ticks_ = slow ? std::min(rest_ticks_ + (complete ? 1 : 0), rest_ticks_needed_) : 0;
  return rest_ticks_ == rest_ticks_needed_;
}

}  // namespace flexarm
