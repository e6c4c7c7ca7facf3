#include "controller/step/control_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "controller/law/design.h"
#include "controller/law/payload_monitor.h"
#include "controller/law/scheduled_law.h"
#include "controller/law/tracking_law.h"
#include "controller/reference/path_reference.h"
#include "controller/step/actuation_queue.h"
#include "controller/step/fault_detection.h"
#include "controller/step/motion_state.h"
#include "controller/types/control_config.h"
#include "estimator/counter_decoder.h"
#include "estimator/fractional_zero_order_hold.h"
#include "estimator/payload_estimator.h"
#include "estimator/reading_age.h"
#include "estimator/state_estimator.h"
#include "estimator/strain_fit.h"
#include "estimator/tip_reading.h"

namespace flexarm {
namespace {

// While Stopping the goal follows the hubs with this time constant: slower than the arm's vibration
// (below 0.2 s with free joints), faster than the stop's time-out of 3 s.
constexpr double kStopGoalFollow_s = 0.5;

// The torque of Stopping starts where that of Running was, and forgets it with this time constant:
// a step would ring the links, whose vibrations with free joints take 0.15 s.
constexpr double kHandOver_s = 0.1;

// An arm that is not at rest by then has been let go, over the last 0.4 s of it: with play in its
// gears it rattles under any feedback, and friction brings it to rest.
constexpr double kLetGoBy_s = 2.2, kLetGoIn_s = 0.4;

// After a move's end the arm shows its payload for as long as it still vibrates.
constexpr double kComesToRest_s = 2.0;

// Of an estimator that looks for no payload.
constexpr double kNotSought = std::numeric_limits<double>::quiet_NaN();
constexpr PayloadKnowledge kNoPayloadSought = {.payload_kg = kNotSought,
                                               .payload_sigma_kg = kNotSought,
                                               .friction_nm = {kNotSought, kNotSought},
                                               .mean_nis = kNotSought,
                                               .warnings = 0};

std::array<double, 2> JointStiffness(const ArmParameters& arm) {
  return {arm.joint[0].stiffness_nm_per_rad, arm.joint[1].stiffness_nm_per_rad};
}

void Store(const StateVector& x, std::array<double, kMaxNominalStates>* out) noexcept {
  for (Eigen::Index i = 0; i < x.size(); ++i) (*out)[static_cast<std::size_t>(i)] = x(i);
}

void Store(const PayloadKnowledge& known, StepOutput* out) noexcept {
  out->payload_kg = known.payload_kg;
  out->payload_sigma_kg = known.payload_sigma_kg;
  out->friction_nm = known.friction_nm;
  out->mean_nis = known.mean_nis;
  out->payload_warnings = known.warnings;
}

}  // namespace

struct ControlStep::Stages {
  enum class Phase : std::uint8_t { kNoTorque, kRunning, kStopping };

  Stages(const ControlConfig& config, const Design& design)
      : period_s(config.loop.period_ms * 1e-3),
        period_ns(std::llround(config.loop.period_ms * 1e6)),
        max_reading_age_ns(std::llround(config.loop.period_ms * 0.5e6)),
        prediction(config.controller.prediction),
        decoder(config.sensors, period_s, config.estimator.max_joint_rate_rad_s),
        fit(config.arm, config.sensors, config.estimator),
        estimator(config.estimator,
                  {.layout = design.layout,
                   .A = design.filter_A,
                   .B = design.filter_B,
                   .C = design.filter_C,
                   .L = design.filter_L,
                   .A_rate = design.filter_A_rate,
                   .B_rate = design.filter_B_rate},
                  period_s, JointStiffness(config.arm)),
        layout(design.layout),
        supervisor(config.safety, config.estimator, period_s, config.sensors.counters_present(),
                   JointStiffness(config.arm)),
        law(design, config.controller, config.safety.torque_limit_nm),
        nominal({.A = design.A, .B = design.B}, design.A_rate, design.B_rate, period_s),
        tip_accelerometer(config.sensors.tip_accelerometer) {
    if (design.payload_model.empty()) return;
    payload.emplace(design.payload_model,  // start-up
                    PayloadFilterFor(config.arm, config.sensors, config.estimator));
    payload_monitor.emplace(*config.estimator.payload);  // start-up
    detect_delay = config.estimator.payload->detect_delay;
    // No torque acts before it is put out.
    delay_may_be_less = config.loop.actuation_delay_ms >= config.loop.period_ms;
    if (!design.scheduled) return;
    scheduled.emplace(payload->stepper().arm(), design.scheduled->gains, period_s);  // start-up
  }

  void Reset(const StepInput& input) noexcept {
    decoder.Reset(input.counts_before, input.calibration.counter_zero);
    fit.Reset(input.calibration);
    ResetEstimator();
    supervisor.Reset();
    law.Reset();
    move.Reset();
    if (payload_monitor) payload_monitor->Reset();
    asked.Clear();
    reported_nm = {};
    pending_nm = {};
    saturated_s = {};
    phase = Phase::kNoTorque;
  }

  void ResetEstimator() noexcept {
    estimator.Reset();
    if (payload) payload->Reset();
  }

  // Over [k-1, k] Ts: changes when the commands did, and has the mean that the drive side knows.
  PiecewiseTorque Applied(const StepInput& input) noexcept {
    asked.CorrectNewest(input.sampling_instant_ns + input.acted_late_ns);
    std::copy_backward(reported_nm.begin(), reported_nm.end() - 1, reported_nm.end());
    reported_nm[0] = input.applied_torque_nm;
    return AppliedWith(delay_found(), input);
  }

  // The same if torques act that many samples later than known: then what the drive side believes
  // of a sample is true of the one so much later. Of the next sample it knows nothing yet.
  PiecewiseTorque AppliedWith(int delay, const StepInput& input) const noexcept {
    const std::int64_t end_ns = input.sampling_instant_ns - delay * period_ns;
    const PiecewiseTorque pieces = asked.Between(end_ns - period_ns, end_ns, period_ns);
    return delay < 0 ? pieces : pieces.WithMean(reported_nm[static_cast<std::size_t>(delay)]);
  }

  TorqueByDelay AppliedByDelay(const StepInput& input) const noexcept {
    TorqueByDelay applied;
    if (delay_may_be_less) applied[0] = AppliedWith(-1, input);
    for (std::size_t d = kDelayAsKnown; d < kDelays; ++d) {
      applied[d] = AppliedWith(static_cast<int>(d - kDelayAsKnown), input);
    }
    return applied;
  }

  int delay_found() const noexcept { return payload ? payload->delay_found() : 0; }

  FittedModes Fit(const SensorFrame& frame, std::int64_t instant_ns,
                  const PiecewiseTorque& applied) noexcept {
    if (StrainsAreOf(frame, instant_ns)) return fit.Fit(frame, instant_ns, {});
    return fit.Fit(frame, instant_ns,
                   payload ? payload->ModalRates() : estimator.ModalRates(applied));
  }

  StateEstimator::Estimate Estimate(const DecodedCounters& counters, const FittedModes& modes,
                                    const PiecewiseTorque& applied, const SensorFrame& frame,
                                    const StepInput& input) noexcept {
    if (!payload) return estimator.Update(counters, modes, applied);
    const std::optional<double> tip_m_s2 =
        tip_accelerometer ? TipReading(frame, *tip_accelerometer) : std::nullopt;
    const PayloadFilter::Estimate& found =
        detect_delay ? payload->Update(counters, modes, AppliedByDelay(input), tip_m_s2)
                     : payload->Update(counters, modes, applied, tip_m_s2);
    const double mean_nis = payload->mean_nis();
    if (ContradictsModel(mean_nis)) payload->AssumePayloadLost();
    known = payload_monitor->Judge(found, mean_nis, move.moving());
    StateEstimator::Estimate out{.x = payload->Now(), .innovation = {}};
    std::copy_n(found.innovation.data(), found.innovation.size(), out.innovation.begin());
    return out;
  }

  // What the path asks of the estimator: a move may begin with another payload than before, and the
  // rest after one says nothing of it.
  void WatchMoves(const StepInput& input) noexcept {
    if (!payload || input.mode != LoopMode::kFollow) return;
    if (move.Take(input.path[1], period_s)) payload->BeginMove();
    if (std::isfinite(move.rested_s()) && move.rested_s() > kComesToRest_s) payload->EndMove();
  }

  std::int64_t ActsFrom(const StepInput& input) const noexcept {
    return input.sampling_instant_ns + period_ns + input.acts_late_ns;
  }

  // From k Ts to the instant at which the torque computed now will act, under those on their way:
  // all as much later as was found.
  StateVector Predict(const StateVector& x, const StepInput& input) const noexcept {
    const PiecewiseTorque pending = asked.Between(
        input.sampling_instant_ns - delay_found() * period_ns, ActsFrom(input), period_ns);
    if (payload) return payload->After(pending);
    StateVector next = x;
    nominal.Advance(pending, &next);
    return next;
  }

  TrackingLaw::Result Decide(const StepInput& input, const StateVector& x,
                             bool sensors_good) noexcept {
    if (input.mode == LoopMode::kOpenLoop) return OpenLoop(input);
    if (input.safety_state != SafetyState::kRunning) return Stop(input, x);
    // Gains learnt in an earlier run belong to the load of that run: S21 x_m of an arm that rests
    // away from zero would begin with a step.
    if (phase != Phase::kRunning) law.Reset();
    phase = Phase::kRunning;
    if (input.mode == LoopMode::kFollow) {
      return scheduled ? law.Hold(scheduled->Torque(x, known, Desired(input), move.rested_s()))
                       : law.Compute(x, input.reference_next, sensors_good);
    }
    const Eigen::Vector2d goal_rad(input.reference_next.x_m[0], input.reference_next.x_m[1]);
    return law.Hold(law.Regulate(x, AtRest(goal_rad)));
  }

  QuasiStaticSample Desired(const StepInput& input) const noexcept {
    if (input.planned == 0) return scheduled->ClosedForm(known.payload_kg, input.path);
    return {.x = ScheduledLaw::State::Map(input.plan.x.data()),
            .torque_nm = Eigen::Vector2d::Map(input.plan.torque_nm.data())};
  }

  // Damps the arm towards a goal that gives way: it starts where the reference ended, or where the
  // stop found the hubs, and follows them, so that a heavy payload is not dragged back for long.
  TrackingLaw::Result Stop(const StepInput& input, const StateVector& x) noexcept {
    const bool first = phase != Phase::kStopping;
    if (first) {
      for (int i = 0; i < 2; ++i) {
        stop_hub_rad(i) = input.reference_ended != 0
                              ? input.reference_next.x_m[static_cast<std::size_t>(layout.hub(i))]
                              : x(layout.hub(i));
      }
    }
    const Eigen::Vector2d hubs(x(layout.hub(0)), x(layout.hub(1)));
    stop_hub_rad += (period_s / kStopGoalFollow_s) * (hubs - stop_hub_rad);
    const Eigen::Vector2d u = law.Regulate(x, AtRest(stop_hub_rad));
    if (first) hand_over = Eigen::Vector2d(pending_nm[0], pending_nm[1]) - u;
    stopping_s = first ? 0.0 : stopping_s + period_s;
    const double hold = std::fmin(1.0, std::fmax(0.0, (kLetGoBy_s - stopping_s) / kLetGoIn_s));
    const TrackingLaw::Result result = law.Hold(hold * (u + hand_over));
    hand_over *= 1.0 - period_s / kHandOver_s;
    phase = Phase::kStopping;
    return result;
  }

  // The arm unbent, its joints untwisted, with its hubs there.
  StateVector AtRest(const Eigen::Vector2d& hub_rad) const noexcept {
    StateVector x = StateVector::Zero(layout.states());
    for (int i = 0; i < 2; ++i) x(layout.hub(i)) = x(layout.rotor(i)) = hub_rad(i);
    return x;
  }

  TrackingLaw::Result OpenLoop(const StepInput& input) const noexcept {
    Eigen::Vector2d u = Eigen::Vector2d::Zero();
    if (input.safety_state == SafetyState::kRunning) {
      u << input.reference_next.u_m_nm[0], input.reference_next.u_m_nm[1];
    }
    return law.Hold(u);
  }

  void CountSaturation(std::uint32_t limits) noexcept {
    if ((limits & kLimitTorque1) != 0) saturated_s[0] += period_s;
    if ((limits & kLimitTorque2) != 0) saturated_s[1] += period_s;
  }

  const double period_s;
  const std::int64_t period_ns;
  const std::int64_t max_reading_age_ns;  // half a period: nearer to this sample than to another
  const bool prediction;
  CounterDecoder decoder;
  StrainFit fit;
  StateEstimator estimator;
  const StateLayout layout;
  FaultDetection supervisor;
  TrackingLaw law;
  FractionalZeroOrderHold nominal;
  const std::optional<TipAccelerometerConfig> tip_accelerometer;
  std::optional<PayloadEstimator> payload;
  std::optional<ScheduledLaw> scheduled;
  std::optional<PayloadMonitor> payload_monitor;
  PayloadKnowledge known = kNoPayloadSought;
  bool detect_delay = false, delay_may_be_less = false;
  MotionState move;
  ActuationQueue asked;
  // By the drive side, of this sample and of those before it.
  std::array<std::array<double, 2>, kDelays - kDelayAsKnown> reported_nm{};
  std::array<double, 2> pending_nm{};  // the newest of those asked
  std::array<double, 2> saturated_s{};
  Phase phase = Phase::kNoTorque;
  Eigen::Vector2d stop_hub_rad = Eigen::Vector2d::Zero();
  double stopping_s = 0.0;
  // Of Stopping: what is left of the torque before it.
  Eigen::Vector2d hand_over = Eigen::Vector2d::Zero();
};

ControlStep::ControlStep(const ControlConfig& config, const Design& design)
    : stages_(std::make_unique<Stages>(config, design)) {}  // start-up

ControlStep::~ControlStep() = default;

StepOutput ControlStep::Step(const StepInput& input) noexcept {
  Stages& s = *stages_;
  if (input.reset != 0) s.Reset(input);

  const double frame_age_s =
      static_cast<double>(input.sampling_instant_ns - input.frame.sampled_at_ns) * 1e-9;
  const SensorFrame frame =
      WithoutStaleReadings(input.frame, input.sampling_instant_ns, s.max_reading_age_ns);

  const DecodedCounters counters = s.decoder.Decode(frame);
  const PiecewiseTorque applied = s.Applied(input);
  const FittedModes modes = s.Fit(frame, input.sampling_instant_ns, applied);
  s.WatchMoves(input);
  const StateEstimator::Estimate estimate = s.Estimate(counters, modes, applied, frame, input);
  const FaultDetection::Verdict verdict =
      s.supervisor.Judge({.counters = &counters,
                          .modes = &modes,
                          .estimate = &estimate,
                          .applied_torque_nm = input.applied_torque_nm,
                          .frame_age_s = frame_age_s,
                          .mode = input.mode});
  const StateVector x_next = s.prediction ? s.Predict(estimate.x, input) : estimate.x;
  // Start again from the next measurement. A trip needs its cause gone before the arm can be armed,
  // and so reset: a state that stayed bad would be tripped for ever.
  if ((verdict.faults & CauseBit(TripCause::kStateNotFinite)) != 0) s.ResetEstimator();

  StepOutput out{};
  out.tick = input.tick;
  out.faults = verdict.faults;
  out.lyapunov_nm2 = std::numeric_limits<double>::quiet_NaN();
  if (TorqueAllowed(input.safety_state) && verdict.faults == 0) {
    const bool sensors_good = modes.valid[0] && modes.valid[1] && (counters.good & 3u) == 3u;
    const TrackingLaw::Result decision = s.Decide(input, x_next, sensors_good);
    out.torque_nm = decision.torque_nm;
    out.limits = decision.limits;
    out.lyapunov_nm2 = decision.lyapunov_nm2;
    s.CountSaturation(decision.limits);
    if (!decision.finite) out.faults |= CauseBit(TripCause::kStateNotFinite);
  } else {
    out.limits = kAdaptationHeld;
    s.phase = Stages::Phase::kNoTorque;
  }
  if (!s.prediction) out.limits |= kPredictionOff;
  s.pending_nm = out.torque_nm;
  s.asked.Push(s.ActsFrom(input), s.pending_nm);

  out.angle_rad = counters.angle_rad;
  out.modal_m = modes.modal_m;
  Store(estimate.x, &out.x_hat);
  Store(x_next, &out.x_next);
  out.innovation = estimate.innovation;
  out.root_strain = modes.root_strain;
  out.fit_residual = modes.residual;
  out.adaptive_gain_change = s.law.adaptive_gain_change();
  out.saturated_s = s.saturated_s;
  Store(s.known, &out);
  out.delay_found = static_cast<std::int8_t>(s.delay_found());
  out.fault_value = verdict.value;
  out.fault_limit = verdict.limit;
  out.fault_channel = verdict.channel;
  out.counts = counters.counts;
  out.strain_used = modes.used;
  out.counters_used = counters.good;
  out.at_rest = verdict.at_rest ? 1 : 0;
  out.experiment_done = input.reference_ended;
  return out;
}

}  // namespace flexarm
