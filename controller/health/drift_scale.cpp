#include "controller/health/drift_scale.h"

#include <cmath>

namespace flexarm {

double StrainRange(const SensorConfig& sensors, std::size_t strain) {
  return sensors.strain_input.range_v / std::fabs(sensors.strain[strain].gain_v_per_unit);
}

// The steps are large against rounding and against the tolerance of the integrator's passes, and
// small against the nonlinearity of the arm.
DriftScale ScaleOf(const DriftChannel& channel, const ArmParameters& arm,
                   const SensorConfig& sensors) {
  switch (channel.kind) {
    case DriftKind::kGaugeGain:
      return {.prior = 0.3, .step = 0.0, .linear = 0.0, .floor = 3e-3};
    case DriftKind::kGaugeZero: {
      const double range = StrainRange(sensors, channel.strain);
      return {.prior = 0.3 * range, .step = 0.0, .linear = 0.0, .floor = 1e-3 * range};
    }
    case DriftKind::kFriction: {
      const double nominal_nm =
          arm.joint[static_cast<std::size_t>(channel.part) - 1].coulomb_friction_nm;
      return {.prior = nominal_nm,
              .step = 0.1 * nominal_nm,
              .linear = 0.2 * nominal_nm,
              .floor = 0.05 * nominal_nm};
    }
    case DriftKind::kJointStiffness:
      return {.prior = 0.5, .step = 0.0, .linear = 0.02, .floor = 4e-3};
    case DriftKind::kLinkStiffness:
      return {.prior = 0.3, .step = 0.01, .linear = 5e-3, .floor = 3e-3};
    case DriftKind::kPayload: {
      const double carried_kg = arm.payload_mass_kg + arm.link[1].mass_kg();
      return {.prior = carried_kg,
              .step = 0.02 * carried_kg,
              .linear = 0.02 * carried_kg,
              .floor = 4e-3};
    }
  }
  return {};
}

std::vector<DriftScale> ScalesOf(const std::vector<DriftChannel>& channels,
                                 const ArmParameters& arm, const SensorConfig& sensors) {
  std::vector<DriftScale> scales;
  for (const DriftChannel& channel : channels) scales.push_back(ScaleOf(channel, arm, sensors));
  return scales;
}

}  // namespace flexarm
