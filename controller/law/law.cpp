#include "controller/law/law.h"

#include <cmath>
#include <limits>

namespace flexarm {

LawOutput Saturate(const Eigen::Vector2d& u, const std::array<double, 2>& limit_nm) noexcept {
  LawOutput out{.torque_nm = {0.0, 0.0},
                .limits = 0,
                .finite = u.allFinite(),
                .lyapunov_nm2 = std::numeric_limits<double>::quiet_NaN()};
  if (!out.finite) return out;
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit = limit_nm[i];
    const double asked = u(static_cast<Eigen::Index>(i));
    out.torque_nm[i] = std::fmin(std::fmax(asked, -limit), limit);
    if (out.torque_nm[i] != asked) out.limits |= i == 0 ? kLimitTorque1 : kLimitTorque2;
  }
  return out;
}

LawOutput SaturateWithoutAdaptation(const Eigen::Vector2d& u,
                                    const std::array<double, 2>& limit_nm) noexcept {
  LawOutput out = Saturate(u, limit_nm);
  out.limits |= kAdaptationHeld;
  return out;
}

}  // namespace flexarm
