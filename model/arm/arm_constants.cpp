#include "model/arm/arm_constants.h"

#include <stdexcept>
#include <string>

namespace flexarm {
namespace {

const ArmParameters& Checked(const ArmParameters& p, ModeCount count) {
  for (const Problem& problem : p.Problems()) {
    throw std::invalid_argument(problem.key + " = " + problem.value + ": " + problem.rule);
  }
  if (count.link1 < 1 || count.link1 > kMaxModesPerLink || count.link2 < 1 ||
      count.link2 > kMaxModesPerLink) {
    throw std::invalid_argument("ModeCount: 1 to " + std::to_string(kMaxModesPerLink) +
                                " modes per link");
  }
  return p;
}

}  // namespace

ArmConstants::ArmConstants(const ArmParameters& p, ModeCount count)
    : m1(count.link1),
      m2(count.link2),
      link1(Link1Modes(Checked(p, count), count.link1)),
      link2(Link2Modes(p, count.link2)),
      L1(link1.length_m),
      L2(link2.length_m),
      backlash(p, 0.0),  // CarryPayload sets its load inertia
      foreshortening(p.foreshortening) {
  I1 = p.joint[0].hub_inertia_kgm2 + link1.second_moment;
  Ir2 = p.motor2_inertia_kgm2;
  J1 = p.joint[0].rotor_inertia_kgm2;
  J2 = p.joint[1].rotor_inertia_kgm2;
  Ip = p.payload_inertia_kgm2;
  K1 = p.joint[0].stiffness_nm_per_rad;
  K2 = p.joint[1].stiffness_nm_per_rad;
  friction_nm = {p.joint[0].coulomb_friction_nm, p.joint[1].coulomb_friction_nm};
  viscous = {p.joint[0].viscous_friction_nm_s_per_rad, p.joint[1].viscous_friction_nm_s_per_rad};
  if (foreshortening) {
    shortening1 = ForeshorteningOf(link1, p.link[0]);
    bare_shortening2 = ForeshorteningOf(link2, p.link[1]);
  }
  CarryPayload(p);
}

// Computed from the bare link each time: adding a mass and removing it again would leave round-off.
// An outer product that may alias allocates.
void ArmConstants::CarryPayload(const ArmParameters& p) noexcept {
  const double m_p = p.payload_mass_kg;
  m_outboard = p.motor2_mass_kg + p.hub2_mass_kg + link2.m + m_p;
  Sx = link2.first_moment + m_p * L2;
  I2 = p.joint[1].hub_inertia_kgm2 + link2.second_moment + m_p * L2 * L2;
  k2 = link2.k + m_p * link2.psi_tip;
  a2 = link2.a + m_p * L2 * link2.psi_tip;
  N2 = link2.N;
  N2.noalias() += m_p * link2.psi_tip * link2.psi_tip.transpose();
  backlash = Backlash(p, I2 + p.payload_inertia_kgm2);
  if (!foreshortening) return;
  shortening2 = bare_shortening2;
  AddTipMass(link2, m_p, &shortening2);
}

}  // namespace flexarm
