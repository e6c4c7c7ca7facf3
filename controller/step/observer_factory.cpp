#include "controller/step/observer_factory.h"

#include <cstddef>
#include <numbers>

#include "controller/types/rejected_error.h"
#include "estimator/nominal_observer.h"
#include "estimator/payload_observer.h"
#include "estimator/settling_observer.h"

namespace flexarm {
namespace {

PayloadFilterConfig FilterFor(const ControlConfig& config) {
  PayloadFilterConfig filter = PayloadFilterFor(config.arm, config.sensors, config.estimator);
  if (!config.settles()) return filter;
  const SettlingConfig& settling = *config.controller.settling;
  for (std::size_t i = 0; i < filter.process_force.size(); ++i) {
    filter.process_force[i] *= settling.process_force_share[i];
  }
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    filter.count_dead_band_rad[static_cast<std::size_t>(encoder.counter)] =
        settling.dead_band_counts * 2.0 * std::numbers::pi / encoder.counts_per_turn;
  }
  return filter;
}

PayloadObserver PayloadObserverOf(const ControlConfig& config, const Design& design) {
  return {PayloadEstimator(design.payload_model, FilterFor(config)), *config.estimator.payload};
}

NominalObserver NominalObserverOf(const ControlConfig& config, const Design& design) {
  const double period_s = config.loop.period_s();
  const FilterGains gains{.layout = design.layout,
                          .A = design.filter_A,
                          .B = design.filter_B,
                          .C = design.filter_C,
                          .L = design.filter_L,
                          .A_rate = design.filter_A_rate,
                          .B_rate = design.filter_B_rate,
                          .W = design.filter_W,
                          .P = design.filter_P,
                          .R = design.filter_R};
  return {
      StateEstimator(config.estimator, gains, period_s, config.arm.joint_stiffness_nm_per_rad()),
      FractionalZeroOrderHold({.A = design.A, .B = design.B}, design.A_rate, design.B_rate,
                              period_s)};
}

SettlingObserver SettlingObserverOf(const ControlConfig& config, const Design& design) {
  return {NominalObserverOf(config, design),
          PayloadObserverOf(config, design),
          TipSway(MakeRigidJointArm(design), config.arm.payload_mass_kg),
          1e-3 * config.controller.settling->payload_filter_below_mm,
          config.arm.payload_mass_kg,
          config.loop.period_s()};
}

}  // namespace

std::unique_ptr<Observer> MakeObserver(const ControlConfig& config, const Design& design) {
  if (config.estimator.kind == EstimatorKind::kIdeal) {
    throw RejectedError(
        "estimator.name = \"ideal\" knows the state of a simulated arm, which sensors cannot tell: "
        "only `flexarm simulate` has it");
  }
  if (config.settles()) {
    return std::make_unique<SettlingObserver>(SettlingObserverOf(config, design));  // start-up
  }
  if (config.uses_payload_estimator()) {
    return std::make_unique<PayloadObserver>(PayloadObserverOf(config, design));  // start-up
  }
  return std::make_unique<NominalObserver>(NominalObserverOf(config, design));  // start-up
}

}  // namespace flexarm
