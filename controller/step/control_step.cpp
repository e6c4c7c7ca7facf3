#include "controller/step/control_step.h"

#include <cmath>
#include <limits>
#include <utility>

#include "controller/law/design.h"
#include "controller/law/law_factory.h"
#include "controller/step/observer_factory.h"
#include "controller/types/control_config.h"
#include "estimator/reading_age.h"
#include "estimator/tip_reading.h"

namespace flexarm {
namespace {

constexpr TripCauses kStateLost =
    CauseBit(TripCause::kStateNotFinite) | CauseBit(TripCause::kNoCounterReading) |
    CauseBit(TripCause::kNoStrainReading1) | CauseBit(TripCause::kNoStrainReading2);

// Below this rate of the reference's hubs a sample without commanded torque belongs to a rest; a
// command of zero torque in the middle of a move does not.
constexpr double kRestRate_rad_s = 0.05;

void Store(const StateVector& x, std::array<double, kMaxNominalStates>* out) noexcept {
  for (Eigen::Index i = 0; i < x.size(); ++i) (*out)[static_cast<std::size_t>(i)] = x(i);
}

void Store(const PayloadKnowledge& payload, StepOutput* out) noexcept {
  out->payload_kg = payload.payload_kg;
  out->payload_sigma_kg = payload.payload_sigma_kg;
  out->friction_nm = payload.friction_nm;
  out->mean_nis = payload.mean_nis;
  out->payload_warnings = payload.warnings;
}

void Store(const DecodedCounters& counters, const FittedModes& modes, StepOutput* out) noexcept {
  out->angle_rad = counters.angle_rad;
  out->counts = counters.counts;
  out->counters_used = counters.good;
  out->modal_m = modes.modal_m;
  out->root_strain = modes.root_strain;
  out->fit_residual = modes.residual;
  out->strain_used = modes.used;
}

void Store(const FaultDetection::Verdict& verdict, StepOutput* out) noexcept {
  out->faults |= verdict.faults;
  out->fault_value = verdict.value;
  out->fault_limit = verdict.limit;
  out->fault_channel = verdict.channel;
  out->at_rest = verdict.at_rest ? 1 : 0;
  out->may_damp = verdict.may_damp ? 1 : 0;
}

}  // namespace

ControlStep::ControlStep(const ControlConfig& config, const Design& design)
    : ControlStep(config, design, MakeLaw(config, design)) {}

ControlStep::ControlStep(const ControlConfig& config, const Design& design,
                         std::unique_ptr<Law> law)
    : ControlStep(config, design, std::move(law), MakeObserver(config, design)) {}

ControlStep::ControlStep(const ControlConfig& config, const Design& design,
                         std::unique_ptr<Observer> observer)
    : ControlStep(config, design, MakeLaw(config, design), std::move(observer)) {}

ControlStep::ControlStep(const ControlConfig& config, const Design& design,
                         std::unique_ptr<Law> law, std::unique_ptr<Observer> observer)
    : period_s_(config.loop.period_s()),
      max_reading_age_ns_(std::llround(config.loop.period_ms * 0.5e6)),
      prediction_(config.controller.prediction),
      torque_limit_nm_(config.safety.torque_limit_nm),
      reduced_torque_nm_(WithReducedLimits(config.safety).torque_limit_nm),
      layout_(design.layout),
      tip_accelerometer_(config.sensors.tip_accelerometer),
      decoder_(config.sensors, period_s_, config.estimator.max_joint_rate_rad_s),
      fit_(config.arm, config.sensors, config.estimator),
      observer_(std::move(observer)),
      fault_detection_(config.safety, config.estimator, period_s_, config.sensors,
                       fit_.gauges_needed(), config.arm.joint_stiffness_nm_per_rad()),
      delay_(config.loop.period_ns(), config.loop.actuation_delay_ms >= config.loop.period_ms),
      law_(std::move(law)),
      stop_(design.K_stop, design.layout, period_s_) {}

void ControlStep::Reset(const StepInput& input) noexcept {
  decoder_.Reset(input.counts_before, input.calibration.counter_zero);
  fit_.Reset(input.calibration);
  observer_->Reset();
  fault_detection_.Reset();
  delay_.Reset();
  law_->Reset();
  motion_.Reset();
  torque_nm_ = {};
  saturated_s_ = {};
  phase_ = Phase::kNoTorque;
}

FittedModes ControlStep::Fit(const SensorFrame& frame, std::int64_t instant_ns,
                             const PiecewiseTorque& applied) noexcept {
  if (StrainsAreOf(frame, instant_ns)) return fit_.Fit(frame, instant_ns, {});
  return fit_.Fit(frame, instant_ns, observer_->ModalRates(applied));
}

void ControlStep::FollowPath(const StepInput& input) noexcept {
  if (input.mode != LoopMode::kFollow) return;
  const bool begins = motion_.Take(input.path[1], period_s_);
  observer_->FollowPath({.begins = begins,
                         .moves = motion_.moving(),
                         .rested_s = motion_.rested_s(),
                         .same_load = input.same_load != 0,
                         .load_changes = input.load_changes != 0});
}

void ControlStep::FollowReference(const StepInput& input) noexcept {
  if (input.mode != LoopMode::kFollow) return;
  const ReferenceSample& next = input.reference_next;
  const auto rate = static_cast<std::size_t>(layout_.rate(layout_.hub(0)));
  observer_->FollowReference(next.u_m_nm[0] == 0.0 && next.u_m_nm[1] == 0.0 &&
                             std::fabs(next.x_m[rate]) < kRestRate_rad_s &&
                             std::fabs(next.x_m[rate + 1]) < kRestRate_rad_s);
}

StateEstimate ControlStep::Observe(const StepInput& input, const SensorFrame& frame,
                                   const DecodedCounters& counters, const FittedModes& modes,
                                   const PiecewiseTorque& applied) noexcept {
  TorqueByDelay by_delay;
  if (observer_->wants_torque_by_delay()) by_delay = delay_.AppliedByDelay(input);
  return observer_->Update(
      {.counters = &counters,
       .modes = &modes,
       .applied = &applied,
       .applied_by_delay = observer_->wants_torque_by_delay() ? &by_delay : nullptr,
       .tip_m_s2 = tip_accelerometer_ ? TipReading(frame, *tip_accelerometer_) : std::nullopt});
}

std::array<double, 2> ControlStep::RootStrain(const double* modal_m) const noexcept {
  std::array<double, 4> all_m{};
  const auto modes = static_cast<std::size_t>(layout_.modes_per_link);
  for (std::size_t mode = 0; mode < modes; ++mode) {
    all_m[mode] = modal_m[mode];
    all_m[2 + mode] = modal_m[modes + mode];
  }
  return {fit_.RootStrain(0, all_m), fit_.RootStrain(1, all_m)};
}

LawOutput ControlStep::Decide(const StepInput& input, const StateVector& x,
                              bool sensors_good) noexcept {
  if (input.mode == LoopMode::kOpenLoop) return OpenLoop(input);
  if (input.safety_state != SafetyState::kRunning) return Stop(input, x);
  // The gains adapted in an earlier run are for the payload of that run: for an arm at rest away
  // from zero, S21 x_m would start with a step.
  if (phase_ != Phase::kRunning) law_->Reset();
  phase_ = Phase::kRunning;
  if (input.mode == LoopMode::kFollow) return Follow(input, x, sensors_good);
  const Eigen::Vector2d goal_rad(input.reference_next.x_m[0], input.reference_next.x_m[1]);
  return SaturateWithoutAdaptation(stop_.Regulate(x, goal_rad), torque_limit_nm_);
}

LawOutput ControlStep::Follow(const StepInput& input, const StateVector& x,
                              bool sensors_good) noexcept {
  return law_->Compute({.x = &x,
                        .reference = &input.reference_next,
                        .path = &input.path,
                        .plan = input.planned != 0 ? &input.plan : nullptr,
                        .payload = observer_->payload(),
                        .rested_s = motion_.rested_s(),
                        .settling_share = observer_->settling_share(),
                        .may_adapt = sensors_good});
}

// The first goal is the end of the reference, or the hub angles if the stop interrupts a run.
LawOutput ControlStep::Stop(const StepInput& input, const StateVector& x) noexcept {
  if (phase_ != Phase::kStopping) {
    Eigen::Vector2d hub_rad;
    for (int i = 0; i < 2; ++i) {
      const int hub = layout_.hub(i);
      hub_rad(i) = input.reference_ended != 0
                       ? input.reference_next.x_m[static_cast<std::size_t>(hub)]
                       : x(hub);
    }
    stop_.Begin(hub_rad, Eigen::Vector2d(torque_nm_[0], torque_nm_[1]));
  }
  phase_ = Phase::kStopping;
  return SaturateWithoutAdaptation(stop_.Stop(x), torque_limit_nm_);
}

// Of the next sample; the reference of one period later is hardly elsewhere.
std::array<double, 2> ControlStep::ReferenceHubs(const StepInput& input) const noexcept {
  if (input.mode != LoopMode::kFollow || input.safety_state != SafetyState::kRunning) {
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  }
  const std::array<double, kMaxNominalStates>& x_m = input.reference_next.x_m;
  return {x_m[static_cast<std::size_t>(layout_.hub(0))],
          x_m[static_cast<std::size_t>(layout_.hub(1))]};
}

LawOutput ControlStep::OpenLoop(const StepInput& input) const noexcept {
  Eigen::Vector2d u = Eigen::Vector2d::Zero();
  if (input.safety_state == SafetyState::kRunning) {
    u << input.reference_next.u_m_nm[0], input.reference_next.u_m_nm[1];
  }
  return SaturateWithoutAdaptation(u, torque_limit_nm_);
}

// As the gate will, so that the prediction is of the torque that acts.
void ControlStep::Reduce(LawOutput* decision) const noexcept {
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit = reduced_torque_nm_[i];
    double& torque_nm = decision->torque_nm[i];
    if (std::fabs(torque_nm) <= limit) continue;
    torque_nm = torque_nm > 0.0 ? limit : -limit;
    decision->limits |= i == 0 ? kLimitTorque1 : kLimitTorque2;
  }
}

void ControlStep::CountSaturation(std::uint32_t limits) noexcept {
  if ((limits & kLimitTorque1) != 0) saturated_s_[0] += period_s_;
  if ((limits & kLimitTorque2) != 0) saturated_s_[1] += period_s_;
}

StepOutput ControlStep::Step(const StepInput& input) noexcept {
  if (input.reset != 0) Reset(input);

  // Readings of this sample.
  const double frame_age_s =
      static_cast<double>(input.sampling_instant_ns - input.frame.sampled_at_ns) * 1e-9;
  const SensorFrame frame =
      WithoutStaleReadings(input.frame, input.sampling_instant_ns, max_reading_age_ns_);
  const DecodedCounters counters = decoder_.Decode(frame);
  delay_.TakeReport(input);
  const PiecewiseTorque applied = delay_.Applied(input, observer_->delay_found());
  const FittedModes modes = Fit(frame, input.sampling_instant_ns, applied);
  FollowPath(input);
  FollowReference(input);
  const StateEstimate estimate = Observe(input, frame, counters, modes, applied);

  const FaultDetection::Verdict verdict = fault_detection_.Judge(
      {.counters = &counters,
       .modes = &modes,
       .estimate = &estimate,
       .model_root_strain = RootStrain(estimate.x.data() + layout_.mode(0, 0)),
       .root_innovation =
           RootStrain(estimate.innovation.data() + layout_.output(layout_.mode(0, 0))),
       .applied_torque_nm = input.applied_torque_nm,
       .reference_hub_rad = ReferenceHubs(input),
       .frame_age_s = frame_age_s,
       .mode = input.mode,
       .reduced = input.reduced != 0});
  const StateVector x_next =
      prediction_ ? observer_->Predict(estimate.x, delay_.Pending(input, observer_->delay_found()))
                  : estimate.x;
  // A reset needs the cause of the trip to be gone: a state that stayed not finite would prevent it
  // for ever, and so would one that drifted while the arm was not measured.
  if ((verdict.faults & kStateLost) != 0) observer_->Restart();

  StepOutput out{};
  out.tick = input.tick;
  out.lyapunov_nm2 = std::numeric_limits<double>::quiet_NaN();
  Store(verdict, &out);
  // Stop category 1: damped from the sample on in which the cause is seen.
  const bool damps = Damped(verdict.faults, verdict.may_damp);
  if (TorqueAllowed(input.safety_state) && (verdict.faults == 0 || damps)) {
    const bool sensors_good = modes.valid[0] && modes.valid[1] && (counters.good & 3u) == 3u;
    LawOutput decision = damps ? Stop(input, x_next) : Decide(input, x_next, sensors_good);
    if (input.reduced != 0) Reduce(&decision);
    out.torque_nm = decision.torque_nm;
    out.limits = decision.limits;
    out.lyapunov_nm2 = decision.lyapunov_nm2;
    CountSaturation(decision.limits);
    if (!decision.finite) out.faults |= CauseBit(TripCause::kStateNotFinite);
  } else {
    out.limits = kAdaptationHeld;
    phase_ = Phase::kNoTorque;
  }
  if (!prediction_) out.limits |= kPredictionOff;
  torque_nm_ = out.torque_nm;
  delay_.Push(input, torque_nm_);

  Store(counters, modes, &out);
  Store(estimate.x, &out.x_hat);
  Store(x_next, &out.x_next);
  Store(observer_->payload(), &out);
  out.innovation = estimate.innovation;
  out.adaptive_gain_change = law_->adaptive_gain_change();
  out.saturated_s = saturated_s_;
  out.delay_found = static_cast<std::int8_t>(observer_->delay_found());
  out.experiment_done = input.reference_ended;
  return out;
}

}  // namespace flexarm
