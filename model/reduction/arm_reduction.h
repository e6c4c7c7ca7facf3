#pragma once

#include <array>
#include <cstdint>

#include "model/arm/arm_model.h"
#include "model/reduction/power_balancing.h"
#include "model/reduction/spectral_split.h"

namespace flexarm {

/// A nominal trajectory of chapter 6: unbent links, joint springs relaxed, constant rates sustained
/// by whatever forces are required. th1 has no influence.
struct NominalMotion {
  double theta2_rad;
  double theta1_rate_rad_s, theta2_rate_rad_s;
};

/// How the modal coordinates phi are scaled; contributions depend on it.
enum class ModalScaling : std::uint8_t {
  kTip,     ///< psi(L) = 1: phi is a tip deflection, as in the rest of the program
  kMass,    ///< rho A int psi^2 + m_t psi(L)^2 + J_t psi'(L)^2 = 1 kg
  kLength,  ///< int psi^2 = L (weighted by rho A on a stepped link), as a bare beam's shapes
};

/// The arm about a nominal motion, without dissipation: (6.21) with A2 = 0. Q1 = 1,
/// Q2 = M^-1 (dF/dq + K), input torques, output the tip's position in the base frame, m.
UndampedSystem UndampedArm(const ArmModel& model, const NominalMotion& motion);

/// The arm at rest in the form of the symmetric condition (6.6): z = [q; M q'], Q1 = M^-1, Q2 = K.
UndampedSystem UndampedArmAtRest(const ArmModel& model, double theta2_rad);

/// The same arm with its structural damping and gyroscopic terms, for truncation by Gramians.
StateSpace DampedArm(const ArmModel& model, const NominalMotion& motion);

/// Share of each mode of a link in the link's power.
struct LinkContribution {
  Eigen::VectorXd mu;               ///< power element of each modal coordinate, in its scaling
  Eigen::VectorXd epsilon_percent;  ///< power contribution coefficients eps_1 .. eps_M (6.22)
};

/// Power elements and contributions at one nominal motion.
struct ArmReduction {
  PowerBalance balance;                  ///< in tip scaling
  std::array<LinkContribution, 2> link;  ///< in the requested scaling
};

/// Power balancing of the arm at one nominal motion, thesis 6.5. Two rigid-body roots are marked;
/// those that stay zero or turn negative are dropped, one that turned positive counts in mu.
/// @throws as BalancePower
ArmReduction ReduceArm(const ArmModel& model, const NominalMotion& motion, ModalScaling scaling,
                       double rigid_below_rad2_s2 = PowerOptions{}.rigid_below_rad2_s2);

/// Factor from phi with psi(L) = 1 to phi in the scaling, for each mode of a link.
Eigen::VectorXd ModalScale(const LinkModes& link, ModalScaling scaling);

}  // namespace flexarm
