#include "tests/examples/pi_d_law.h"

namespace flexarm {

PiDLaw::PiDLaw(const PiDGains& gains, const StateLayout& layout, double period_s,
               const std::array<double, 2>& torque_limit_nm)
    : gains_(gains), layout_(layout), period_s_(period_s), torque_limit_nm_(torque_limit_nm) {}

LawOutput PiDLaw::Compute(const LawInput& input) noexcept {
  const StateVector& x = *input.x;
  std::array<double, 2> error_rad{};
  Eigen::Vector2d u;
  for (int i = 0; i < 2; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const int hub = layout_.hub(i);
    error_rad[joint] = input.reference->x_m[static_cast<std::size_t>(hub)] - x(hub);
    u(i) = gains_.stiffness_nm_per_rad[joint] * error_rad[joint] +
           gains_.integral_nm_per_rad_s[joint] * integral_rad_s_[joint] -
           gains_.damping_nm_s_per_rad[joint] * x(layout_.rate(hub));
  }
  const LawOutput out = SaturateWithoutAdaptation(u, torque_limit_nm_);
  if (!out.finite) return out;
  constexpr std::array<std::uint32_t, 2> kLimited = {kLimitTorque1, kLimitTorque2};
  for (std::size_t i = 0; i < 2; ++i) {
    if ((out.limits & kLimited[i]) == 0) integral_rad_s_[i] += period_s_ * error_rad[i];
  }
  return out;
}

}  // namespace flexarm
