#pragma once

#include <Eigen/Core>

#include "model/arm/arm_constants.h"
#include "model/beam/link_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Nonlinear model of the flexible arm: M(q) q'' + bias(q, q') + D q' + K q = generalised forces.
///
/// q = [th1 th2 th3 th4 phi1_1.. phi2_1..]; th1 and th3 against the base, th2 and th4 against the
/// tangent at the end of link 1; counter-clockwise seen from above is positive. phi in metres of
/// tip deflection. Off-line form in dynamic-size matrices; ArmSimulator integrates the same
/// equations fast. Options: foreshortening (foreshortening.h; not in the thesis) and backlash of
/// joint 2 (backlash.h). Not modelled: gravity; friction is a generalised force, see ArmSimulator.
/// Source: thesis chapter 3, (3.15)-(3.22), corrected by docs/theory/errata.md.
/// Real-time: all but CarryPayload start-up only (allocates).
class ArmModel {
 public:
  /// @throws std::invalid_argument if the parameters have Problems() or a count is outside its
  /// bounds.
  ArmModel(const ArmParameters& parameters, ModeCount count);

  int dof() const { return constants_.dof(); }
  ModeCount mode_count() const { return {constants_.m1, constants_.m2}; }
  const ArmParameters& parameters() const { return parameters_; }
  const ArmConstants& constants() const { return constants_; }
  /// @param link  1 or 2
  /// @throws std::out_of_range otherwise
  const LinkModes& link_modes(int link) const;

  /// Sets another payload mass, as if constructed with it; `payload_inertia_kgm2` stays.
  ///
  /// For a payload that is lost or picked up during a simulation. The mode shapes stay those of
  /// `shape_payload_mass_kg`, so q and v keep their meaning and the state continues unchanged. The
  /// momentum of a lost mass leaves with it, at the velocity of the tip; a mass that is picked up
  /// has that velocity already, so there is no impact.
  /// Real-time: safe.
  /// @param payload_kg  >= 0
  void CarryPayload(double payload_kg) noexcept;

  /// Symmetric positive definite, dof x dof.
  Eigen::MatrixXd MassMatrix(const Eigen::VectorXd& q) const;
  /// Coriolis and centrifugal forces, quadratic in v.
  Eigen::VectorXd Bias(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  /// Term on the right side that backlash of joint 2 adds to -K q: zero without backlash.
  Eigen::VectorXd BacklashForce(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  /// M^-1 (force - bias - D v - K q + backlash).
  Eigen::VectorXd Acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                               const Eigen::VectorXd& generalized_force) const;
  const Eigen::MatrixXd& stiffness() const {
    return stiffness_;
  }  ///< K, constant; without backlash
  const Eigen::MatrixXd& damping() const { return damping_; }  ///< D, constant
  /// dof x 2: motor torques act on th3 and th4, at the gearbox output.
  Eigen::MatrixXd InputMatrix() const;

  double KineticEnergy(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;  ///< J
  double PotentialEnergy(const Eigen::VectorXd& q) const;                          ///< J

  /// Point of the neutral line of link 1 or 2 at u_m from its root, in the base frame, m.
  Eigen::Vector2d Point(int link, double u_m, const Eigen::VectorXd& q) const;
  /// With foreshortening, u_m counts along the bent link. Its velocity, m/s.
  Eigen::Vector2d PointVelocity(int link, double u_m, const Eigen::VectorXd& q,
                                const Eigen::VectorXd& v) const;
  Eigen::Vector2d TipPosition(const Eigen::VectorXd& q) const;
  Eigen::Vector2d TipVelocity(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;

  /// Surface strain +(h/2) w''(x) at x_m from the root, as a channel with face = +1 reads it.
  /// Source: thesis Appendix B.2.
  double Strain(int link, double x_m, const Eigen::VectorXd& q) const;

 private:
  double Deflection(int link, double u_m, const Eigen::VectorXd& coordinates) const;
  double Shortening(int link, double u_m, const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  Eigen::VectorXd ModalPart(int link, const Eigen::VectorXd& q) const;

  ArmParameters parameters_;
  ArmConstants constants_;
  Eigen::MatrixXd stiffness_;
  Eigen::MatrixXd damping_;
};

}  // namespace flexarm
