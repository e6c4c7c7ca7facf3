#include "tools/bound/bound_limits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "controller/types/rejected_error.h"
#include "controller/types/rounded_text.h"
#include "estimator/root_strain.h"
#include "model/problem_list.h"
#include "model/units.h"
#include "tools/bound/rest_move.h"

namespace flexarm {
namespace {

constexpr int kModes = 2;  // of RigidJointArm

void CheckPlace(const ControlConfig& config, const Eigen::Vector2d& place_rad, const char* which) {
  const std::array<double, 2> limit_rad = SoftAngleRad(config.safety);
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle_rad = place_rad[static_cast<Eigen::Index>(i)];
    if (std::fabs(angle_rad) <= limit_rad[i]) continue;
    throw RejectedError("the " + std::string(which) + " of the move has joint " +
                        std::to_string(i + 1) + " at " + RoundedText(angle_rad * kDegPerRad, 4) +
                        " deg: must be within +-" + RoundedText(limit_rad[i] * kDegPerRad, 4) +
                        " deg, limits.soft_angle_deg");
  }
}

}  // namespace

std::array<double, 2> BoundLimits::rigid_torque_nm() const {
  return {std::min(torque_nm[0], root_moment_nm[0]), std::min(torque_nm[1], root_moment_nm[1])};
}

double PlanTorqueShare(const ControlConfig& config) {
  return config.controller.plan ? config.controller.plan->torque_share : 1.0;
}

BoundLimits BoundLimitsOf(const ControlConfig& config, double torque_share) {
  const auto& link = config.arm.link;
  const SafetyConfig& safety = config.safety;
  return {.torque_nm = {torque_share * safety.torque_limit_nm[0],
                        torque_share * safety.torque_limit_nm[1]},
          .root_moment_nm = {MomentPerStrain_nm(link[0]) * safety.strain_limit[0],
                             MomentPerStrain_nm(link[1]) * safety.strain_limit[1]},
          .strain = safety.strain_limit,
          .hub_rate_rad_s = safety.hub_rate_rad_s,
          .hub_angle_rad = SoftAngleRad(safety),
          .root_strain_per_m = RootStrainShapes(config.arm, kModes)};
}

void CheckMove(const ControlConfig& config, const RestMove& move) {
  CheckPlace(config, move.from_rad, "beginning");
  CheckPlace(config, move.to_rad, "end");
  if (move.from_rad == move.to_rad) {
    throw RejectedError("the move ends where it begins: there is no time to find");
  }
  const auto& [least, most] = config.controller.payload_range_kg;
  if (!(move.payload_kg >= least && move.payload_kg <= most)) {
    throw RejectedError("payload " + NumberText(move.payload_kg) + " kg: must be " +
                        NumberText(least) + " to " + NumberText(most) +
                        " kg, controller.payload_range_kg");
  }
}

}  // namespace flexarm
