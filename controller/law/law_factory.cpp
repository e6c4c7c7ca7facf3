#include "controller/law/law_factory.h"

#include <optional>
#include <utility>

#include "controller/law/scheduled_law.h"
#include "controller/law/settle_term.h"
#include "controller/law/tracking_law.h"

namespace flexarm {

std::unique_ptr<Law> MakeLaw(const ControlConfig& config, const Design& design) {
  const std::array<double, 2>& limit_nm = config.safety.torque_limit_nm;
  if (design.scheduled) {
    return std::make_unique<ScheduledLaw>(MakeRigidJointArm(design),  // start-up
                                          design.scheduled->gains, BendingGuard(config),
                                          design.scheduled->max_kg, config.loop.period_s(),
                                          limit_nm);
  }
  std::optional<SettleTerm> settle;
  if (config.settles()) {
    TipSway sway(MakeRigidJointArm(design), config.arm.payload_mass_kg);
    settle = SettleTerm(design, *config.controller.settling, std::move(sway),
                        config.arm.joint[0].coulomb_friction_nm, config.loop.period_s());
  }
  return std::make_unique<TrackingLaw>(design, config.controller, limit_nm,  // start-up
                                       std::move(settle));
}

}  // namespace flexarm
