#include "controller/reference/motion_check.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "controller/types/rounded_text.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kJumpPeriods = 4.0;

struct Quantity {
  const char* what;
  const char* part;  // joint or link
  const char* unit;
  double per_si;      // unit per SI unit
  const char* limit;  // key in [limits]
};

constexpr Quantity kAngle{"the angle", "joint", "deg", kDegPerRad, "soft_angle_deg"};
constexpr Quantity kRate{"the hub rate", "joint", "rad/s", 1.0, "hub_rate_rad_s"};
constexpr Quantity kTorque{"the torque with friction", "joint", "N m", 1.0, "torque_limit_nm"};
constexpr Quantity kJump{"a jump of the torque", "joint", "N m", 1.0,
                         "slew_limit_nm_per_s over four periods"};
constexpr Quantity kStrain{"the strain at the root", "link", "microstrain", 1e6, "strain_limit"};

struct Check {
  const Quantity& quantity;
  double value;  // SI, as limit
  double limit;
  double share;  // of the limit
};

std::string Text(const Quantity& quantity, std::size_t i, double value, double limit,
                 double time_s) {
  const auto in_unit = [&](double si) {
    return RoundedText(si * quantity.per_si, 4) + " " + quantity.unit;
  };
  return std::string(quantity.what) + " of " + quantity.part + " " + std::to_string(i + 1) +
         " reaches " + in_unit(value) + " after " + RoundedText(time_s, 2, true) + " s, " +
         in_unit(std::fabs(value) - limit) + " beyond limits." + quantity.limit + ", " +
         in_unit(limit);
}

double RootStrain(const ReferenceSample& sample, std::size_t link, int states,
                  const MotionLimits& limits) {
  const auto modes = static_cast<std::size_t>(limits.modes_per_link);
  const std::size_t first = static_cast<std::size_t>(states) / 2 - 2 * modes + link * modes;
  double strain = 0.0;
  for (std::size_t j = 0; j < modes; ++j) {
    strain += limits.root_strain_per_m[link][j] * sample.x_m[first + j];
  }
  return strain;
}

}  // namespace

std::optional<BrokenLimit> FirstBrokenLimit(std::span<const ReferenceSample> reference, int states,
                                            const MotionLimits& limits, const LimitShares& shares,
                                            double period_s, int first) {
  ReferenceSample before = first > 0 ? reference.front() : ReferenceSample{};
  for (std::size_t n = first > 0 ? 1 : 0; n < reference.size(); ++n) {
    const ReferenceSample& now = reference[n];
    const int k = first + static_cast<int>(n);
    for (std::size_t i = 0; i < 2; ++i) {
      const double rate = now.x_m[static_cast<std::size_t>(states) / 2 + i];
      const double u = now.u_m_nm[i];
      const double friction = u == 0.0
                                  ? 0.0
                                  : limits.coulomb_friction_nm[i] +
                                        limits.viscous_friction_nm_s_per_rad[i] * std::fabs(rate);
      const double torque = u + std::copysign(friction, u);
      const double jump = u - before.u_m_nm[i];
      const std::array<Check, 5> checks = {{
          {kAngle, now.x_m[i], limits.soft_angle_rad[i], 1.0},
          {kTorque, torque, limits.torque_nm[i], shares.torque},
          {kJump, jump, kJumpPeriods * limits.slew_nm_per_s[i] * period_s, shares.jump},
          {kRate, rate, limits.hub_rate_rad_s[i], shares.rate},
          {kStrain, RootStrain(now, i, states, limits), limits.strain[i], shares.strain},
      }};
      for (const Check& check : checks) {
        const double limit = check.share * check.limit;
        if (std::fabs(check.value) <= limit) continue;
        return BrokenLimit{.sample = k,
                           .text = Text(check.quantity, i, check.value, limit, k * period_s)};
      }
    }
    before = now;
  }
  return std::nullopt;
}

}  // namespace flexarm
