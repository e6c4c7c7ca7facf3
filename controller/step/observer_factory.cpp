#include "controller/step/observer_factory.h"

#include <array>
#include <cstddef>
#include <numbers>

#include "controller/types/rejected_error.h"
#include "estimator/nominal_observer.h"
#include "estimator/payload_observer.h"

namespace flexarm {
namespace {

// For a law that damps the arm at rest, noise of the estimated rates matters more than how fast the
// payload is found: docs/theory/control-law.md 14.3.
constexpr std::array<double, 6> kSettlingForceShare = {0.3, 0.3, 0.7, 0.7, 0.75, 0.75};
constexpr double kSettlingDeadBand = 0.4;  // of half a count

PayloadFilterConfig FilterFor(const ControlConfig& config) {
  PayloadFilterConfig filter = PayloadFilterFor(config.arm, config.sensors, config.estimator);
  if (!Settles(config.controller.kind)) return filter;
  for (std::size_t i = 0; i < filter.process_force.size(); ++i) {
    filter.process_force[i] *= kSettlingForceShare[i];
  }
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    filter.count_dead_band_rad[static_cast<std::size_t>(encoder.counter)] =
        kSettlingDeadBand * std::numbers::pi / encoder.counts_per_turn;
  }
  return filter;
}

}  // namespace

std::unique_ptr<Observer> MakeObserver(const ControlConfig& config, const Design& design) {
  const double period_s = config.loop.period_s();
  if (config.estimator.kind == EstimatorKind::kIdeal) {
    throw RejectedError(
        "estimator.name = \"ideal\" knows the state of a simulated arm, which sensors cannot tell: "
        "only `flexarm simulate` has it");
  }
  if (!design.payload_model.empty()) {
    return std::make_unique<PayloadObserver>(  // start-up
        PayloadEstimator(design.payload_model, FilterFor(config)), *config.estimator.payload);
  }
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
  return std::make_unique<NominalObserver>(  // start-up
      StateEstimator(config.estimator, gains, period_s, config.arm.joint_stiffness_nm_per_rad()),
      FractionalZeroOrderHold({.A = design.A, .B = design.B}, design.A_rate, design.B_rate,
                              period_s));
}

}  // namespace flexarm
