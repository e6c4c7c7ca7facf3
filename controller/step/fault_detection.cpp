#include "controller/step/fault_detection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/units.h"

namespace flexarm {
namespace {

constexpr int kRateTicks = 2;
constexpr int kMissingTicks = 2;  // samples in a row that lack a reading
constexpr double kStalePeriods = 2.0;

// Rates at rest are taken over these times, so that counts and noise look no faster at a higher
// sampling rate.
constexpr double kHubRestWindow_s = 0.1;
constexpr double kStrainRestWindow_s = 0.02;

// A hub that springs back for a moment is no arm out of control.
constexpr double kHubRateWindow_s = 0.02;

std::size_t SamplesIn(double window_s, double period_s, std::size_t most) noexcept {
  const auto samples = static_cast<std::size_t>(std::lround(window_s / period_s));
  return std::clamp<std::size_t>(samples, 1, most);
}

std::size_t FirstChannel(std::uint32_t mask) noexcept {
  return mask == 0 ? 0 : static_cast<std::size_t>(std::countr_zero(mask)) + 1;
}

constexpr TripCause PerJoint(TripCause joint1, std::size_t i) noexcept {
  return static_cast<TripCause>(static_cast<std::size_t>(joint1) + i);
}

std::array<double, 2> HubCountsRad(const SensorConfig& sensors) noexcept {
  std::array<double, 2> count_rad{};
  for (const EncoderConfig& encoder : sensors.encoder) {
    if (encoder.counter > 1) continue;
    count_rad[static_cast<std::size_t>(encoder.counter)] =
        2.0 * std::numbers::pi / encoder.counts_per_turn;
  }
  return count_rad;
}

}  // namespace

FaultDetection::FaultDetection(const SafetyConfig& safety, const EstimatorConfig& estimator,
                               double period_s, const SensorConfig& sensors,
                               const std::array<int, 2>& gauges_needed,
                               const std::array<double, 2>& joint_stiffness_nm_per_rad)
    : safety_(safety),
      reduced_(WithReducedLimits(safety)),
      estimator_(estimator),
      period_s_(period_s),
      counters_present_(sensors.counters_present()),
      gauges_needed_(gauges_needed),
      joint_stiffness_(joint_stiffness_nm_per_rad),
      hub_count_rad_(HubCountsRad(sensors)),
      hub_window_(SamplesIn(kHubRestWindow_s, period_s, kMostRestWindow)),
      strain_window_(SamplesIn(kStrainRestWindow_s, period_s, kMostRestWindow)),
      rate_window_(SamplesIn(kHubRateWindow_s, period_s, kMostRestWindow)),
      stands_window_(
          std::max(static_cast<int>(SamplesIn(kStandsWithin_s, period_s, kMostRestWindow)),
                   estimator.fault_ticks)),
      // Not before the window is full.
      rest_ticks_needed_(std::max(static_cast<int>(std::ceil(safety.rest_time_s / period_s)),
                                  static_cast<int>(hub_window_) + 1)) {}

void FaultDetection::Reset() noexcept {
  in_a_row_ = {};
  strain_off_model_ = {};
  repeated_ = {};
  live_innovation_ = {};
  rest_ticks_ = 0;
  incomplete_ticks_ = 0;
  ring_ = 0;
  ticks_ = 0;
  started_ = false;
}

void FaultDetection::Raise(TripCause cause, bool present, int ticks, double value, double limit,
                           std::size_t channel, bool known) noexcept {
  std::uint8_t& in_a_row = in_a_row_[static_cast<std::size_t>(cause)];
  if (present || known) in_a_row = static_cast<std::uint8_t>(present ? in_a_row + 1 : 0);
  if (in_a_row < ticks) return;
  if (verdict_.faults == 0 || CauseBit(cause) < (verdict_.faults & (~verdict_.faults + 1))) {
    verdict_.value = value;
    verdict_.limit = limit;
    verdict_.channel = static_cast<std::uint16_t>(channel);
  }
  verdict_.faults |= CauseBit(cause);
  in_a_row = static_cast<std::uint8_t>(ticks);  // saturated: cannot wrap
}

// The cause of an unknown value is raised where the sensor is judged as well, with its evidence;
// here it keeps a NaN from passing.
void FaultDetection::RaiseUnlessWithin(TripCause beyond, TripCause unknown, int ticks, double value,
                                       double limit, std::size_t joint) noexcept {
  const bool known = !std::isnan(value);
  Raise(beyond, known && !(value <= limit), ticks, value, limit, joint);
  if (!known) Raise(unknown, true, 1, value, limit, joint);
}

FaultDetection::Verdict FaultDetection::Judge(const LoopFacts& facts) noexcept {
  verdict_ = {};
  const double stale_s = kStalePeriods * period_s_;
  Raise(TripCause::kStaleFrame, !(facts.frame_age_s <= stale_s), 1, facts.frame_age_s, stale_s, 0);
  const Monitored monitored = Monitor(facts);
  JudgeCounters(facts);
  JudgeStrain(facts);
  JudgeJoints(facts, monitored);
  JudgeEstimate(facts);
  verdict_.at_rest = JudgeRest(facts);
  verdict_.may_damp = MayDamp(facts, monitored);
  return verdict_;
}

double FaultDetection::Bridged(bool read, double reading, double model) const noexcept {
  if (read) return reading;
  return incomplete_ticks_ < kMissingTicks ? model : std::numeric_limits<double>::quiet_NaN();
}

// Two sensors that fail in turn leave no complete sample either: the count is of samples, not of
// readings of one sensor.
FaultDetection::Monitored FaultDetection::Monitor(const LoopFacts& facts) noexcept {
  const DecodedCounters& counters = *facts.counters;
  const FittedModes& modes = *facts.modes;
  const bool complete =
      (counters.good & counters_present_) == counters_present_ && modes.valid[0] && modes.valid[1];
  incomplete_ticks_ = complete ? 0 : std::min(incomplete_ticks_ + 1, kMissingTicks);
  Monitored monitored{};
  for (std::size_t i = 0; i < 2; ++i) {
    monitored.hub_rad[i] = Bridged((counters.good >> i & 1U) != 0, counters.angle_rad[i],
                                   facts.estimate->x(static_cast<Eigen::Index>(i)));
    monitored.hub_rate_rad_s[i] = HubRate(facts, i);
    // Gauges that end before the limit tell nothing about it.
    monitored.root_strain[i] = modes.beyond_range[i] > safety_.strain_limit[i]
                                   ? modes.beyond_range[i]
                                   : Bridged(modes.valid[i], modes.root_strain[i],
                                             facts.model_root_strain[i] + strain_off_model_[i]);
    if (modes.valid[i]) {
      strain_off_model_[i] = modes.root_strain[i] - facts.model_root_strain[i];
    }
  }
  return monitored;
}

void FaultDetection::JudgeJoints(const LoopFacts& facts, const Monitored& monitored) noexcept {
  using enum TripCause;
  const SafetyConfig& limits = facts.reduced ? reduced_ : safety_;
  for (std::size_t i = 0; i < 2; ++i) {
    if (facts.mode != LoopMode::kRegulate) {
      RaiseUnlessWithin(PerJoint(kSoftLimit1, i), kNoCounterReading, 1,
                        std::fabs(monitored.hub_rad[i]), limits.soft_angle_deg[i] * kRadPerDeg,
                        i + 1);
    }
    RaiseUnlessWithin(PerJoint(kHubRate1, i), kStateNotFinite, kRateTicks,
                      monitored.hub_rate_rad_s[i], limits.hub_rate_rad_s[i], i + 1);
    RaiseUnlessWithin(PerJoint(kBendingStrain1, i), PerJoint(kNoStrainReading1, i), 1,
                      std::fabs(monitored.root_strain[i]), safety_.strain_limit[i], i + 1);
    if (!limits.following_error_deg) continue;
    const double error_rad = std::fabs(monitored.hub_rad[i] - facts.reference_hub_rad[i]);
    const double limit_rad = (*limits.following_error_deg)[i] * kRadPerDeg;
    Raise(PerJoint(kFollowingError1, i), error_rad > limit_rad, estimator_.fault_ticks, error_rad,
          limit_rad, i + 1);
  }
}

void FaultDetection::JudgeCounters(const LoopFacts& facts) noexcept {
  const DecodedCounters& counters = *facts.counters;
  Raise(TripCause::kEncoderJump, counters.jumped != 0, 1, 0.0, estimator_.max_joint_rate_rad_s,
        FirstChannel(counters.jumped));

  const std::uint32_t silent = counters_present_ & ~counters.good;
  Raise(TripCause::kNoCounterReading, silent != 0 && incomplete_ticks_ >= kMissingTicks, 1,
        incomplete_ticks_, kMissingTicks, FirstChannel(silent));

  double worst = 0.0;
  std::size_t joint = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::uint32_t both = std::uint32_t{1} << i | std::uint32_t{1} << (i + 2);
    if ((counters.good & both) != both) continue;
    const double torsion = facts.applied_torque_nm[i] / joint_stiffness_[i];
    const double apart = std::fabs(counters.angle_rad[i + 2] - counters.angle_rad[i] - torsion);
    if (apart <= worst || std::isnan(worst)) continue;
    worst = apart;
    joint = i + 1;
  }
  const bool judged = facts.mode != LoopMode::kOpenLoop;
  Raise(TripCause::kHubAgainstRotor, judged && !(worst <= estimator_.hub_rotor_limit_rad),
        estimator_.fault_ticks, worst, estimator_.hub_rotor_limit_rad, joint, IsComplete());
}

void FaultDetection::JudgeStrain(const LoopFacts& facts) noexcept {
  const FittedModes& modes = *facts.modes;
  const int ticks = estimator_.fault_ticks;
  const bool judged = facts.mode != LoopMode::kOpenLoop;
  // A link whose gauges all repeat themselves has no other gauge to compare with: the model is, by
  // how far it has left them since. It is off all the time while friction holds a hub.
  std::uint32_t stuck = modes.stuck;
  double left = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (modes.repeated[i] == 0) {
      live_innovation_[i] = facts.root_innovation[i];
      continue;
    }
    const double apart = std::fabs(facts.root_innovation[i] - live_innovation_[i]);
    if (apart <= estimator_.strain_stuck_limit) continue;
    stuck |= modes.repeated[i];
    left = apart;
  }
  Raise(TripCause::kStrainStuck, judged && stuck != 0, ticks, left, estimator_.strain_stuck_limit,
        FirstChannel(stuck), IsComplete());
  Raise(TripCause::kStrainSaturated, modes.saturated != 0, ticks, 0.0, 0.0,
        FirstChannel(modes.saturated), IsComplete());
  // A reading at the end of its range is out of family too: garbage is now one, now the other.
  const std::uint32_t alien = modes.outlier | modes.saturated;
  Raise(TripCause::kStrainOutOfFamily, judged && alien != 0, ticks, modes.worst_outlier,
        estimator_.strain_family_limit, FirstChannel(alien), IsComplete());
  for (std::size_t i = 0; i < 2; ++i) {
    Raise(PerJoint(TripCause::kNoStrainReading1, i),
          !modes.valid[i] && incomplete_ticks_ >= kMissingTicks, 1, modes.gauges[i],
          gauges_needed_[i], i + 1);
  }
}

void FaultDetection::JudgeEstimate(const LoopFacts& facts) noexcept {
  const StateEstimator::Estimate& estimate = *facts.estimate;
  Raise(TripCause::kStateNotFinite, !estimate.x.allFinite(), 1, 0.0, 0.0, 0);
  const double limit_rad = estimator_.innovation_limit_rad;
  const double hub1 = std::fabs(estimate.innovation[0]), hub2 = std::fabs(estimate.innovation[1]);
  const double worst = hub1 > hub2 || std::isnan(hub1) ? hub1 : hub2;  // NaN if one is
  // The estimate follows a reading that jumps: without another encoder only the jump itself tells.
  const bool jumped = (IsAlone(0) && hub1 > limit_rad) || (IsAlone(1) && hub2 > limit_rad);
  const bool judged = facts.mode != LoopMode::kOpenLoop;
  Raise(TripCause::kEstimatorResidual, judged && !(worst <= limit_rad),
        jumped ? 1 : estimator_.fault_ticks, worst, limit_rad, hub1 >= hub2 ? 1 : 2, IsComplete());
  for (std::size_t i = 0; i < 2; ++i) {
    if (!IsAlone(i)) continue;
    const double off_rad = FollowRepeated(facts, i);
    if (!judged || !(off_rad > estimator_.hub_rotor_limit_rad)) continue;
    Raise(TripCause::kEstimatorResidual, true, 1, off_rad, estimator_.hub_rotor_limit_rad, i + 1);
  }
}

// A hub that friction stops, or its drive, slows down first, and the model knows the drive's
// torque. Without a torque a brake may hold it.
double FaultDetection::FollowRepeated(const LoopFacts& facts, std::size_t i) noexcept {
  Repeated& hub = repeated_[i];
  if ((facts.counters->good >> i & 1U) == 0) return 0.0;
  const double reading_rad = facts.counters->angle_rad[i];
  if (reading_rad != hub.reading_rad) {
    hub = {.reading_rad = reading_rad,
           .turned_rad = std::fabs(reading_rad - hub.reading_rad),
           .samples = 0};
    return 0.0;
  }
  if (hub.samples == 0) {
    hub.turned_rad = std::min(hub.turned_rad, std::fabs(facts.estimate->innovation[i]));
  }
  if (facts.applied_torque_nm[i] == 0.0) hub.turned_rad = 0.0;
  hub.samples = std::min(hub.samples + 1, stands_window_);
  return hub.samples < estimator_.fault_ticks ? 0.0 : hub.samples * hub.turned_rad;
}

// What the encoder has turned at least: a count less than it says, since the begin of the window
// or, soon after a reset, since that.
double FaultDetection::HubRate(const LoopFacts& facts, std::size_t i) const noexcept {
  const Eigen::Index dof = facts.estimate->x.size() / 2;
  const double estimated = std::fabs(facts.estimate->x(dof + static_cast<Eigen::Index>(i)));
  if (!started_ || (facts.counters->good >> i & 1U) == 0) return estimated;
  const Posture& before = Before(rate_window_);
  const std::int64_t samples =
      std::max(ticks_ + 1 - before.tick, static_cast<std::int64_t>(rate_window_));
  const double turned_rad = std::fabs(facts.counters->angle_rad[i] - before.hub_rad[i]);
  const double measured =
      (turned_rad - hub_count_rad_[i]) / (static_cast<double>(samples) * period_s_);
  return measured > estimated ? measured : estimated;  // an estimate that is NaN is returned
}

// Each comparison is false for NaN. The pluck test (kOpenLoop) has no torque but its own.
bool FaultDetection::MayDamp(const LoopFacts& facts, const Monitored& monitored) const noexcept {
  if (facts.mode == LoopMode::kOpenLoop || !facts.estimate->x.allFinite()) return false;
  const bool homing = facts.mode == LoopMode::kRegulate;
  const auto& soft_deg = (facts.reduced ? reduced_ : safety_).soft_angle_deg;
  for (std::size_t i = 0; i < 2; ++i) {
    const double most_rad = (soft_deg[i] + kDampedBeyond_deg) * kRadPerDeg;
    const bool near = homing || std::fabs(monitored.hub_rad[i]) < most_rad;
    const double rate = monitored.hub_rate_rad_s[i];
    const double strain = std::fabs(facts.modes->root_strain[i]);
    const bool measured = facts.modes->valid[i] && (facts.counters->good >> i & 1U) != 0;
    if (!measured || !near || !(rate < kDampedTo * safety_.hub_rate_rad_s[i]) ||
        !(strain < kDampedTo * safety_.strain_limit[i])) {
      return false;
    }
  }
  return true;
}

// A sample that lacks a reading is no evidence of rest, nor of motion: its rates would be those of
// the model. Two in a row end the rest.
bool FaultDetection::JudgeRest(const LoopFacts& facts) noexcept {
  ++ticks_;
  if (incomplete_ticks_ > 0) {
    if (incomplete_ticks_ >= kMissingTicks) rest_ticks_ = 0;
    return rest_ticks_ == rest_ticks_needed_;
  }
  const Posture now{.hub_rad = {facts.counters->angle_rad[0], facts.counters->angle_rad[1]},
                    .root_strain = facts.modes->root_strain,
                    .tick = ticks_};
  if (!started_) {  // as if the arm had been at rest here before
    started_ = true;
    before_.fill(now);
    for (Posture& posture : before_) --posture.tick;
  }
  const Posture& hub_before = Before(hub_window_);
  const Posture& strain_before = Before(strain_window_);
  const auto rate = [this](double change, std::int64_t ticks) {
    return std::fabs(change) / (static_cast<double>(ticks) * period_s_);
  };
  bool slow = true;
  for (std::size_t i = 0; i < 2; ++i) {
    slow = slow &&
           rate(now.hub_rad[i] - hub_before.hub_rad[i], now.tick - hub_before.tick) <
               safety_.rest_hub_rate_rad_s &&
           rate(now.root_strain[i] - strain_before.root_strain[i], now.tick - strain_before.tick) <
               safety_.rest_strain_rate_per_s;
  }
  before_[ring_] = now;
  ring_ = (ring_ + 1) % kMostRestWindow;
  rest_ticks_ = slow ? std::min(rest_ticks_ + 1, rest_ticks_needed_) : 0;
  return rest_ticks_ == rest_ticks_needed_;
}

}  // namespace flexarm
