#include "controller/step/observer_factory.h"

#include "controller/types/rejected_error.h"
#include "estimator/nominal_observer.h"
#include "estimator/payload_observer.h"

namespace flexarm {

std::unique_ptr<Observer> MakeObserver(const ControlConfig& config, const Design& design) {
  const double period_s = config.loop.period_s();
  if (config.estimator.kind == EstimatorKind::kIdeal) {
    throw RejectedError(
        "estimator.name = \"ideal\" knows the state of a simulated arm, which sensors cannot tell: "
        "only `flexarm simulate` has it");
  }
  if (!design.payload_model.empty()) {
    return std::make_unique<PayloadObserver>(  // start-up
        PayloadEstimator(design.payload_model,
                         PayloadFilterFor(config.arm, config.sensors, config.estimator)),
        *config.estimator.payload);
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
