#pragma once

#include <Eigen/Core>

#include "model/arm/backlash.h"
#include "model/arm/foreshortening.h"
#include "model/beam/link_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Number of modes kept on each link, 1..kMaxModesPerLink each.
struct ModeCount {
  int link1;
  int link2;
};

constexpr int kMaxModesPerLink = 12;  ///< of the equations; order reduction uses 10
constexpr int kMaxSteppedModes = 6;   ///< of ArmSimulator, whose steps are compiled for each count
constexpr int kRigidCoordinates = 4;  ///< th1 th2 th3 th4 come first in q
constexpr int kMaxSteppedDof = kRigidCoordinates + 2 * kMaxSteppedModes;

/// Indices of the four angles in q; the modal coordinates of link 1 and then link 2 follow.
enum Coordinate : int { kTheta1 = 0, kTheta2 = 1, kTheta3 = 2, kTheta4 = 3, kPhi1 = 4 };

/// Constants of the equations of motion, with the actual payload attached to link 2.
///
/// The mode shapes are those of `shape_payload_mass_kg` for any payload, so N and G are full
/// matrices. "Outboard" is everything that turns with hub 2, with its moments about the elbow.
struct ArmConstants {
  /// @throws std::invalid_argument if the parameters have Problems() or a count is outside its
  /// bounds.
  ArmConstants(const ArmParameters& p, ModeCount count);

  /// Sets another payload mass at the tip: bit-identical to constants constructed with that mass.
  ///
  /// The mode shapes stay, so the coordinates and their rates keep their meaning.
  /// Real-time: safe.
  /// @param p  the parameters of the constructor, with another payload_mass_kg
  void CarryPayload(const ArmParameters& p) noexcept;

  int m1, m2;  ///< modes of link 1, link 2
  LinkModes link1, link2;
  double L1, L2;                ///< m
  double I1;                    ///< hub 1 and link 1 about the shoulder, undeformed, kg m^2
  double m_outboard;            ///< mass carried by the end of link 1, kg
  double Sx;                    ///< first moment of the outboard body along link 2, kg m
  double I2;                    ///< second moment of the outboard body without I_p, kg m^2
  Eigen::VectorXd k2;           ///< int lam2 psi2 + m_p psi2(L2), kg
  Eigen::VectorXd a2;           ///< int lam2 u psi2 + m_p L2 psi2(L2), kg m
  Eigen::MatrixXd N2;           ///< int lam2 psi2 psi2 + m_p psi2(L2) psi2(L2), kg
  double Ir2, J1, J2, Ip;       ///< motor 2, rotors 1 and 2, payload, kg m^2
  double K1, K2;                ///< joint stiffnesses, N m/rad
  Eigen::Vector2d friction_nm;  ///< K_F of joints 1 and 2
  Eigen::Vector2d viscous;      ///< viscous friction of joints 1 and 2, N m s/rad
  Backlash backlash;            ///< of joint 2
  bool foreshortening;          ///< if false, the three below are empty
  Foreshortening<> shortening1, shortening2;  ///< of link 1; of link 2 with the payload
  Foreshortening<> bare_shortening2;          ///< of link 2 alone

  int dof() const { return kRigidCoordinates + m1 + m2; }
  int phi2() const { return kPhi1 + m1; }  ///< index of link 2's first modal coordinate
};

}  // namespace flexarm
