#include "controller/law/control_step.h"

#include <cmath>

#include "controller/law/design.h"
#include "controller/law/loop_supervisor.h"
#include "controller/law/tracking_law.h"
#include "controller/runtime/stack_config.h"
#include "estimator/counter_decoder.h"
#include "estimator/reading_age.h"
#include "estimator/state_estimator.h"
#include "estimator/strain_fit.h"

namespace flexarm {
namespace {

// While Stopping the goal follows the hubs with this time constant: slower than the arm's vibration
// (below 0.2 s with free joints), faster than the stop's time-out of 3 s.
constexpr double kStopGoalFollow_s = 0.5;

std::array<double, 2> JointStiffness(const ArmParameters& arm) {
  return {arm.joint[0].stiffness_nm_per_rad, arm.joint[1].stiffness_nm_per_rad};
}

void Store(const StateVector& x, std::array<double, kMaxNominalStates>* out) noexcept {
  for (Eigen::Index i = 0; i < x.size(); ++i) (*out)[static_cast<std::size_t>(i)] = x(i);
}

}  // namespace

struct ControlStep::Stages {
  Stages(const StackConfig& config, const Design& design)
      : period_s(config.loop.period_ms * 1e-3),
        max_reading_age_ns(std::llround(config.loop.period_ms * 0.5e6)),
        prediction(config.controller.prediction),
        decoder(config.sensors, period_s, config.estimator.max_joint_rate_rad_s),
        fit(config.arm, config.sensors, config.estimator),
        estimator(config.estimator,
                  {.A = design.filter_A,
                   .B = design.filter_B,
                   .C = design.filter_C,
                   .L = design.filter_L},
                  period_s, JointStiffness(config.arm)),
        supervisor(config.safety, config.estimator, period_s, config.sensors.counters_present(),
                   JointStiffness(config.arm)),
        law(design, config.controller, config.safety.torque_limit_nm),
        A(design.A),
        B(design.B) {}

  void Reset(const StepInput& input) noexcept {
    decoder.Reset(input.counts_before, input.calibration.counter_zero);
    fit.Reset(input.calibration);
    estimator.Reset();
    supervisor.Reset();
    law.Reset();
    pending_nm = {};
    stopping = false;
  }

  // x(k+1) = A x(k) + B u(k), u(k) the torque that acts now: asked one sample ago.
  StateVector Predict(const StateVector& x) const noexcept {
    StateVector next = A.lazyProduct(x);
    next += B.col(0) * pending_nm[0];
    next += B.col(1) * pending_nm[1];
    return next;
  }

  TrackingLaw::Result Decide(const StepInput& input, const StateVector& x,
                             bool sensors_good) noexcept {
    if (input.mode == LoopMode::kOpenLoop) return OpenLoop(input);
    if (input.safety_state == SafetyState::kRunning) {
      stopping = false;
      if (input.mode == LoopMode::kFollow) {
        return law.Compute(x, input.reference_next, sensors_good);
      }
      StateVector goal = StateVector::Zero(x.size());
      goal.head<2>() << input.reference_next.x_m[0], input.reference_next.x_m[1];
      return law.Regulate(x, goal);
    }
    // Damp the arm towards a goal that gives way: it starts where the reference ended, or where the
    // stop found the hubs, and follows them, so that a heavy payload is not dragged back for long.
    if (!stopping) {
      stopping = true;
      stop_goal = StateVector::Zero(x.size());
      for (Eigen::Index i = 0; i < 2; ++i) {
        stop_goal(i) = input.reference_ended != 0
                           ? input.reference_next.x_m[static_cast<std::size_t>(i)]
                           : x(i);
      }
    }
    stop_goal.head<2>() += (period_s / kStopGoalFollow_s) * (x.head<2>() - stop_goal.head<2>());
    return law.Regulate(x, stop_goal);
  }

  TrackingLaw::Result OpenLoop(const StepInput& input) const noexcept {
    Eigen::Vector2d u = Eigen::Vector2d::Zero();
    if (input.safety_state == SafetyState::kRunning) {
      u << input.reference_next.u_m_nm[0], input.reference_next.u_m_nm[1];
    }
    TrackingLaw::Result result = law.Clip(u);
    result.limits |= kAdaptationHeld;
    return result;
  }

  const double period_s;
  const std::int64_t max_reading_age_ns;  // half a period: nearer to this sample than to another
  const bool prediction;
  CounterDecoder decoder;
  StrainFit fit;
  StateEstimator estimator;
  LoopSupervisor supervisor;
  TrackingLaw law;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 16, 16> A;
  Eigen::Matrix<double, Eigen::Dynamic, 2, 0, 16, 2> B;
  std::array<double, 2> pending_nm{};  // asked in the last step, acts from this sample on
  bool stopping = false;
  StateVector stop_goal;
};

ControlStep::ControlStep(const StackConfig& config, const Design& design)
    : stages_(std::make_unique<Stages>(config, design)) {}

ControlStep::~ControlStep() = default;

StepOutput ControlStep::Step(const StepInput& input) noexcept {
  Stages& s = *stages_;
  if (input.reset != 0) s.Reset(input);

  const double frame_age_s =
      static_cast<double>(input.sampling_instant_ns - input.frame.sampled_at_ns) * 1e-9;
  const SensorFrame frame =
      WithoutStaleReadings(input.frame, input.sampling_instant_ns, s.max_reading_age_ns);

  const DecodedCounters counters = s.decoder.Decode(frame);
  const FittedModes modes = s.fit.Fit(frame);
  const StateEstimator::Estimate estimate =
      s.estimator.Update(counters, modes, input.applied_torque_nm);
  const LoopSupervisor::Verdict verdict =
      s.supervisor.Judge({.counters = &counters,
                          .modes = &modes,
                          .estimate = &estimate,
                          .applied_torque_nm = input.applied_torque_nm,
                          .frame_age_s = frame_age_s,
                          .mode = input.mode});
  const StateVector x_next = s.prediction ? s.Predict(estimate.x) : estimate.x;
  // Start again from the next measurement. A trip needs its cause gone before the arm can be armed,
  // and so reset: a state that stayed bad would be tripped for ever.
  if ((verdict.faults & CauseBit(TripCause::kStateNotFinite)) != 0) s.estimator.Reset();

  StepOutput out{};
  out.tick = input.tick;
  out.faults = verdict.faults;
  if (TorqueAllowed(input.safety_state) && verdict.faults == 0) {
    const bool sensors_good = modes.valid[0] && modes.valid[1] && (counters.good & 3u) == 3u;
    const TrackingLaw::Result decision = s.Decide(input, x_next, sensors_good);
    out.torque_nm = decision.torque_nm;
    out.limits = decision.limits;
    if (!decision.finite) out.faults |= CauseBit(TripCause::kStateNotFinite);
  } else {
    out.limits = kAdaptationHeld;
  }
  if (!s.prediction) out.limits |= kPredictionOff;
  s.pending_nm = out.torque_nm;

  out.angle_rad = counters.angle_rad;
  out.modal_m = modes.modal_m;
  Store(estimate.x, &out.x_hat);
  Store(x_next, &out.x_next);
  out.innovation = estimate.innovation;
  out.root_strain = modes.root_strain;
  out.fit_residual = modes.residual;
  out.adaptive_gain_change = s.law.adaptive_gain_change();
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
