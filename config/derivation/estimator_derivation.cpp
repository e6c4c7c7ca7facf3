#include <algorithm>
#include <cmath>
#include <set>

#include "config/derivation/derivation_parts.h"
#include "config/derivation/sensor_scales.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Pair = std::array<double, 2>;

Pair Times(const Pair& a, double factor) { return {a[0] * factor, a[1] * factor}; }
Pair Over(const Pair& a, const Pair& b) { return {a[0] / b[0], a[1] / b[1]}; }

// Noise forces on th1 th2 f11 f12 f21 f22.
std::array<double, 6> Forces(const Pair& hubs_nm, const Pair& modes_n) {
  return {hubs_nm[0], hubs_nm[1], modes_n[0], modes_n[0], modes_n[1], modes_n[1]};
}

int FittedModes(const SensorConfig& sensors) {
  for (const int link : {1, 2}) {
    std::set<double> positions;
    for (const StrainChannelConfig& gauge : sensors.strain) {
      if (gauge.link == link) positions.insert(gauge.position_m);
    }
    if (positions.size() < 2) return 1;
  }
  return 2;
}

double CountsPerRad(const SensorConfig& sensors, int counter) {
  for (const EncoderConfig& encoder : sensors.encoder) {
    if (encoder.counter == counter) return encoder.counts_per_turn / kTwoPi;
  }
  return 0.0;
}

std::array<double, 4> ModalSigma_m(const ArmScales& scales) {
  constexpr double kModelError = 2.7e-3;  // of the deflection at the strain limit
  std::array<double, 4> sigma{};
  for (std::size_t i = 0; i < 2; ++i) {
    sigma[2 * i] = std::hypot(kModelError * scales.deflection_m[i], scales.modal_noise_m[i]);
    sigma[2 * i + 1] = 0.5 * sigma[2 * i];
  }
  return sigma;
}

}  // namespace

void DeriveEstimator(const TuningBasis& basis, const ArmScales& scales, DerivedList* out) {
  const Pair force_n = Over(scales.torque_nm, scales.length_m);
  const Pair slope_rad = Over(scales.deflection_m, scales.length_m);
  const double strain = std::max(scales.strain_limit[0], scales.strain_limit[1]);
  const double noise = StrainNoise(basis.sensors);
  const Pair rate_rad_s = HubRateLimit_rad_s(scales);

  out->Whole("estimator.modes_per_link", FittedModes(basis.sensors),
             "2 where both links have gauges at two positions");
  out->List(
      "estimator.process_force",
      Forces({0.002 * scales.torque_nm[0], 0.001 * scales.torque_nm[1]}, Times(force_n, 0.025)),
      "0.2 and 0.1 % of the usable torques S, 2.5 % of S / L");
  out->List("estimator.hub_extra_sigma_rad", Times(slope_rad, 0.004),
            "0.4 % of the slope d / L at the strain limit: what a hub does beyond the model");
  out->List("estimator.rotor_extra_sigma_rad", Times(scales.torsion_rad, 0.02),
            "2 % of the joint's twist S / K");
  out->List("estimator.modal_sigma_m", ModalSigma_m(scales),
            "0.27 % of the deflection d at the strain limit, and the noise of the gauges");
  out->Number(
      "estimator.max_joint_rate_rad_s",
      std::min(1.4 * std::max(rate_rad_s[0], rate_rad_s[1]), 0.9 * scales.ambiguous_rate_rad_s),
      "1.4 times the hub rate limit, within what the counters can tell");
  out->Number("estimator.hub_rotor_limit_rad",
              std::max(0.05, 5.0 * std::max(scales.torsion_rad[0], scales.torsion_rad[1])),
              "5 twists of a joint, at least 0.05");
  out->Number("estimator.strain_family_limit", std::max(0.2 * strain, 5.0 * noise),
              "0.2 of the strain limit, at least 5 times the noise");
  out->Number("estimator.strain_stuck_limit", std::max(0.05 * strain, 5.0 * noise),
              "0.05 of the strain limit, at least 5 times the noise");
}

void DerivePayloadFilter(const TuningBasis& basis, const ArmScales& scales, DerivedList* out) {
  const auto [least_kg, most_kg] = basis.payload_range_kg;
  const Pair& F = scales.friction_nm;
  const auto key = [](const char* name) { return std::string("estimator.payload.") + name; };
  const double filter_most_kg = std::max(1.1 * most_kg, 1e-3);

  out->List(key("process_force"),
            Forces({0.002 * scales.torque_nm[0], 0.0012 * scales.torque_nm[1]},
                   Times(Over(scales.torque_nm, scales.length_m), 0.01)),
            "0.2 and 0.12 % of S, 1 % of S / L");
  out->List(key("rotor_extra_sigma_rad"),
            Pair{0.02 * scales.torsion_rad[0], 0.06 * scales.torsion_rad[1]},
            "2 and 6 % of the joint's twist S / K");
  out->Number(key("start_kg"), std::max(least_kg, 0.5 * most_kg), "half of the greatest payload");
  out->Number(key("start_sigma_kg"), 0.33 * filter_most_kg, "0.33 of max_kg");
  out->Number(key("max_kg"), filter_most_kg, "1.1 times the greatest payload");
  out->Number(key("move_sigma_kg"), 0.27 * filter_most_kg, "0.27 of max_kg");
  out->Number(key("walk_kg"), 0.0025 * filter_most_kg, "0.0025 of max_kg");
  out->Constant(key("min_rate_rad_s"), 0.03, "as for the arm of the thesis");
  out->List(key("friction_start_sigma_nm"), Pair{0.6 * F[0], F[1]},
            "0.6 and 1 of the Coulomb friction F");
  out->List(key("friction_max_nm"), Pair{6.0 * F[0], 20.0 * F[1]}, "6 and 20 F");
  out->List(key("friction_walk_nm"), Pair{0.025 * F[0], 0.04 * F[1]}, "2.5 and 4 % of F");
  out->Constant(key("friction_min_rate_rad_s"), 0.05, "as for the arm of the thesis");
  out->Number(key("play_threshold_counts"), std::max(1.5, 3.7e-3 * CountsPerRad(basis.sensors, 1)),
              "3.7 mrad, at least 1.5 counts");
  out->Constant(key("play_memory"), 0.999, "as for the arm of the thesis");
  out->Constant(key("gate_sigmas"), 4.0, "as for the arm of the thesis");
}

}  // namespace flexarm
