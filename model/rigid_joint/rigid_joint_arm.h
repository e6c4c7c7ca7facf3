#pragma once

#include <Eigen/Core>
#include <span>
#include <type_traits>
#include <vector>

#include "model/math/portable_math.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Everything that turns with hub 2, as a load on the end of link 1; moments about the elbow.
/// Affine in the payload. Scalar: double, or Lanes for four payloads.
template <typename Scalar>
struct OutboardBodyOf {
  Scalar m;                        ///< mass, kg
  Scalar Sx;                       ///< first moment along link 2, kg m
  Scalar I2;                       ///< second moment with rotor 2, undeformed, without I_p, kg m^2
  Eigen::Matrix<Scalar, 2, 1> k2;  ///< int lam2 psi2 + m_p psi2(L2), kg
  Eigen::Matrix<Scalar, 2, 1> a2;  ///< int lam2 u psi2 + m_p L2 psi2(L2), kg m
  Eigen::Matrix<Scalar, 2, 2> N2;  ///< int lam2 psi2 psi2 + m_p psi2(L2) psi2(L2), kg
};
using OutboardBody = OutboardBodyOf<double>;

/// The arm with rigid joints and two modes a link, small enough for the loop:
///   M(q; m_p) q'' + bias(q, q'; m_p) + D q' + K q = [tau1 tau2 0 0 0 0]' + friction.
///
/// q = [th1 th2 phi1_1 phi1_2 phi2_1 phi2_2], rad and m: ArmModel with th3 = th1, th4 = th2, so
/// M = T_r' M T_r and bias = T_r' bias. Mode shapes are those of the nominal payload for any
/// payload, so mass and bias are affine in it. Not modelled: foreshortening, backlash, torsion.
/// Source: docs/theory/payload.md 1; docs/theory/plant.md 3.4.
/// Real-time: all but the constructor is safe.
class RigidJointArm {
 public:
  static constexpr int kDof = 6;
  template <typename Scalar>
  using VectorOf = Eigen::Matrix<Scalar, kDof, 1>;
  template <typename Scalar>
  using MatrixOf = Eigen::Matrix<Scalar, kDof, kDof>;
  using Vector = VectorOf<double>;
  using Matrix = MatrixOf<double>;

  /// Result of At.
  template <typename Scalar>
  struct InertiaOf {
    MatrixOf<Scalar> M;     ///< mass matrix, symmetric to the bit
    VectorOf<Scalar> bias;  ///< Coriolis and centrifugal forces
  };
  using Inertia = InertiaOf<double>;

  /// Of the payload in `parameters` only the inertia is used; the mass is the argument of Outboard.
  /// @throws std::invalid_argument if the parameters have Problems().
  explicit RigidJointArm(const ArmParameters& parameters);

  /// All computed constants, as numbers. Another processor's libm may differ in the last digit, and
  /// a replay must agree to the bit, so a run records them.
  std::vector<double> Constants() const;
  /// @throws std::invalid_argument if their number differs from that of Constants()
  explicit RigidJointArm(std::span<const double> constants);

  OutboardBody Outboard(double payload_kg) const noexcept { return OutboardOf(payload_kg); }
  template <typename Scalar>
  OutboardBodyOf<Scalar> OutboardOf(const Scalar& payload_kg) const noexcept;

  /// Mass matrix and bias at (q, v), one or four. Math: PortableMath in the loop, LibraryMath off
  /// line.
  template <typename Math = PortableMath, typename Scalar = double>
  InertiaOf<Scalar> At(const OutboardBodyOf<Scalar>& body,
                       const std::type_identity_t<VectorOf<Scalar>>& q,
                       const std::type_identity_t<VectorOf<Scalar>>& v) const noexcept;

  /// Elastic forces at q and damping forces at v: K q + D v. Hubs have no stiffness, and no mode of
  /// a link acts on the other link or on a hub.
  template <typename Scalar>
  VectorOf<Scalar> RestoringForce(const VectorOf<Scalar>& q,
                                  const VectorOf<Scalar>& v) const noexcept;

  /// Acceleration of the tip along the normal of link 2 there, m/s^2: tip_acceleration.h.
  double TipAcceleration(const Vector& q, const Vector& v, const Vector& a) const noexcept;

  const Matrix& stiffness() const noexcept { return stiffness_; }  ///< K; zero for the hubs
  const Matrix& damping() const noexcept { return damping_; }      ///< D

 private:
  template <typename Arm, typename Visit>
  static void ForEachConstant(Arm& arm, Visit visit);

  // Inboard of the elbow: hub 1 with rotor 1, link 1, and motor 2's stator at its end.
  double L1_, I1_, Ir2_, Ip_;
  Eigen::Vector2d a1_, p1_, s1_;  // int lam u psi1, psi1(L1), psi1'(L1)
  Eigen::Matrix2d N1_;
  Eigen::Vector2d s2_;  // psi2'(L2)
  OutboardBody empty_, per_kg_;
  Matrix stiffness_, damping_;
};

}  // namespace flexarm

#include "model/rigid_joint/rigid_joint_arm_impl.h"
