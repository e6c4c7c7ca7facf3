#include <algorithm>

#include "config/derivation/derivation_parts.h"

namespace flexarm {
namespace {

using Pair = std::array<double, 2>;

// Shares of the greatest payload at which gains are computed, denser where the arm is light. Gains
// of more than half of it shake the bent arm: docs/theory/payload.md 4.2.
constexpr std::array<double, 8> kGainPayloads = {0.0, 0.05, 0.1, 0.2, 0.3, 0.35, 0.4, 0.5};
constexpr std::array<double, 8> kGainElbow_deg = {0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 150.0};
// The bending guard makes room for 0.04 more than the study's: docs/theory/fast-moves.md 1.
constexpr Pair kFastFraction = {0.72, 0.62};

}  // namespace

void DeriveController(const TuningBasis& basis, const ArmScales& scales, DerivedList* out) {
  const Pair& S = scales.torque_nm;
  const auto [least_kg, most_kg] = basis.payload_range_kg;
  const auto key = [](const char* name) { return std::string("controller.") + name; };
  const double torque_weight = 2.0;
  // The angle at which the weights ask for S: the larger, the calmer; a small one is stiff against
  // friction. The decay is alpha's.
  const double full_rad = 6.5;
  const Pair angle = {torque_weight * S[0] * S[0] / (full_rad * full_rad),
                      torque_weight * S[1] * S[1] / (full_rad * full_rad)};

  out->Constant(key("alpha"), 1.5, "half of that for the arm of the thesis");
  out->List(key("hub_angle_weight"), angle, "torque_weight (S / 6.5 rad)^2");
  out->List(key("hub_rate_weight"), Pair{0.05 * angle[0], 0.05 * angle[1]},
            "hub_angle_weight (0.22 s)^2");
  out->Constant(key("torque_weight"), torque_weight, "the unit of the weights");
  out->Constant(key("passivity_margin"), 5.0, "as for the arm of the thesis");
  out->Number(key("adaptation_gain"), 2.4 / (S[0] * S[0]), "2.4 / S1^2");
  out->Number(key("adaptation_bound"), S[0] / 15.0, "S1 / 15 N m");
  out->List(key("pd_stiffness_nm_per_rad"), Pair{2.0 * S[0], 0.17 * S[1]}, "2 S1 and 0.17 S2");
  out->List(key("pd_damping_nms_per_rad"), Pair{0.03 * S[0], 0.05 * S[1]}, "0.03 S1 and 0.05 S2");

  std::array<double, 8> payloads = kGainPayloads;
  const double top_kg = std::max(most_kg, 1e-3);
  for (double& payload : payloads) payload *= top_kg;
  out->Number(key("payload.max_kg"), top_kg, "the greatest payload");
  out->List(key("payload.fast_fraction"), kFastFraction, "as for the arm of the thesis");
  out->Number(key("payload.fast_least_s"), 3.36 / scales.torque_mode_hz,
              "3.36 periods of the lowest torque mode with the greatest payload");
  out->Number(key("payload.reference_kg"),
              std::clamp(1.5 * basis.arm.payload_mass_kg, least_kg, top_kg),
              "1.5 times the nominal payload, within its range");
  out->List(key("payload.gain_payload_kg"), payloads, "shares of max_kg, at most half");
  out->List(key("payload.gain_elbow_deg"), kGainElbow_deg, "as for the arm of the thesis");
}

}  // namespace flexarm
