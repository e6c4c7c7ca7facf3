#include "controller/reference/motion_limits.h"

#include "controller/types/control_config.h"
#include "estimator/root_strain.h"

namespace flexarm {

MotionLimits MotionLimitsOf(const ControlConfig& config, bool reduced) {
  const ArmParameters& arm = config.arm;
  const SafetyConfig safety = reduced ? WithReducedLimits(config.safety) : config.safety;
  const int modes = config.controller.nominal.modes_per_link;
  const std::optional<PayloadLawConfig>& payload = config.controller.payload;
  return {
      .soft_angle_rad = SoftAngleRad(safety),
      .torque_nm = safety.torque_limit_nm,
      .slew_nm_per_s = safety.slew_limit_nm_per_s,
      .hub_rate_rad_s = safety.hub_rate_rad_s,
      .strain = safety.strain_limit,
      .plan_fraction = safety.plan_fraction,
      .fast_fraction = payload ? payload->fast_fraction : std::array<double, 2>{},
      .fast_least_s = payload ? payload->fast_least_s : 0.0,
      .coulomb_friction_nm = {arm.joint[0].coulomb_friction_nm, arm.joint[1].coulomb_friction_nm},
      .viscous_friction_nm_s_per_rad = {arm.joint[0].viscous_friction_nm_s_per_rad,
                                        arm.joint[1].viscous_friction_nm_s_per_rad},
      .modes_per_link = modes,
      .root_strain_per_m = RootStrainShapes(arm, modes),
      .link_length_m = {arm.link[0].length_m(), arm.link[1].length_m()}};
}

}  // namespace flexarm
