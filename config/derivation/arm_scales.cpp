#include "config/derivation/arm_scales.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "config/derivation/sensor_scales.h"
#include "estimator/nominal_model.h"
#include "estimator/root_strain.h"
#include "model/beam/link_modes.h"

namespace flexarm {
namespace {

// Of the strain that the amplifier can show: a trip needs a reading beyond the limit.
constexpr double kShareOfFullScale = 0.95;
constexpr double kLeastFriction = 1e-3;  // of the torque limit

// The least full scale of the link's gauges.
double FullScale(const SensorConfig& sensors, int link) {
  double least = std::numeric_limits<double>::infinity();
  for (const StrainChannelConfig& gauge : sensors.strain) {
    if (gauge.link == link) least = std::min(least, FullScaleStrain(sensors, gauge));
  }
  return least;
}

// Standard deviation of the link's first modal coordinate as its gauges measure it.
double ModalNoise_m(const SensorConfig& sensors, const LinkParameters& link, const LinkModes& modes,
                    int number) {
  const double counts =
      std::sqrt(sensors.strain_input.noise_counts * sensors.strain_input.noise_counts + 1.0 / 12.0);
  double information = 0.0;
  for (const StrainChannelConfig& gauge : sensors.strain) {
    if (gauge.link != number) continue;
    const double volts_per_m = gauge.gain_v_per_unit * link.HalfThicknessAt_m(gauge.position_m) *
                               modes.mode[0].Curvature(gauge.position_m);
    const double counts_per_m = volts_per_m / sensors.strain_input.volts_per_count();
    information += counts_per_m * counts_per_m;
  }
  return counts / std::sqrt(information);
}

}  // namespace

ArmScales ScalesOf(const TuningBasis& basis) {
  ArmScales scales{};
  const ArmParameters& arm = basis.arm;
  const std::array<LinkModes, 2> modes = {Link1Modes(arm, 1), Link2Modes(arm, 1)};
  const Eigen::Matrix2d inertia = MakeNominalModel(arm, kR8).RigidInertia_kgm2();
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkParameters& link = arm.link[i];
    const int number = static_cast<int>(i) + 1;
    const double limit = basis.strain_limit[i];
    scales.strain_limit[i] =
        std::isnan(limit) ? kShareOfFullScale * FullScale(basis.sensors, number) : limit;
    scales.torque_nm[i] =
        std::min(basis.torque_limit_nm[i], scales.strain_limit[i] * MomentPerStrain_nm(link));
    scales.inertia_kgm2[i] = inertia(number - 1, number - 1);
    scales.deflection_m[i] =
        scales.strain_limit[i] / std::abs(RootStrainShape(link, modes[i]).front());
    scales.length_m[i] = link.length_m();
    scales.friction_nm[i] =
        std::max(arm.joint[i].coulomb_friction_nm, kLeastFriction * basis.torque_limit_nm[i]);
    scales.modal_noise_m[i] = ModalNoise_m(basis.sensors, link, modes[i], number);
  }
  scales.torque_nm[1] =
      std::min(scales.torque_nm[1], scales.strain_limit[0] * MomentPerStrain_nm(arm.link[0]));
  for (std::size_t i = 0; i < 2; ++i) {
    scales.torsion_rad[i] = scales.torque_nm[i] / arm.joint[i].stiffness_nm_per_rad;
  }
  ArmParameters heavy = arm;
  heavy.payload_mass_kg = std::max(arm.payload_mass_kg, basis.payload_range_kg[1]);
  scales.torque_mode_hz =
      MakeNominalModel(heavy, kR12).torque_mode_rad_s(0) / (2.0 * std::numbers::pi);
  scales.ambiguous_rate_rad_s = std::numeric_limits<double>::infinity();
  for (const EncoderConfig& encoder : basis.sensors.encoder) {
    scales.ambiguous_rate_rad_s =
        std::min(scales.ambiguous_rate_rad_s, AmbiguousRate_rad_s(encoder, basis.period_s));
  }
  return scales;
}

}  // namespace flexarm
