#include "controller/operator/limits_json.h"

#include <nlohmann/json.hpp>

namespace flexarm {

nlohmann::json LimitsJson(const SafetyConfig& safety, bool reduced) {
  const SafetyConfig limits = reduced ? WithReducedLimits(safety) : safety;
  return {{"reduced", reduced},
          {"torque_nm", limits.torque_limit_nm},
          {"angle_deg", limits.soft_angle_deg},
          {"hub_rate_rad_s", limits.hub_rate_rad_s},
          {"root_strain", limits.strain_limit}};
}

}  // namespace flexarm
