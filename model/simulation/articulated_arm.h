#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "model/arm/arm_constants.h"
#include "model/simulation/coulomb_friction_lcp.h"

namespace flexarm {

/// Rates, accelerations or coordinates of the arm with M modes on each link.
template <int M>
struct ArmCoordinates {
  using Vec = Eigen::Matrix<double, M, 1>;
  std::array<double, 4> th;  // th1..th4
  Vec f1, f2;
};

/// Constants of the arm with links padded to M modes, in fixed-size form.
template <int M>
struct FixedConstants {
  using Vec = Eigen::Matrix<double, M, 1>;
  using Mat = Eigen::Matrix<double, M, M>;

  explicit FixedConstants(const ArmConstants& c);

  double L1, I1, m, Sx, I2, Ir2, J1, J2, Ip, K1, K2, b1, b2;
  Vec a1, p1, s1;  // link 1: int lam u psi, psi(L) and psi'(L)
  Vec k2, a2, s2;  // link 2: int lam psi and int lam u psi with payload, psi'(L)
  Mat N1, D1, G1, N2, D2, G2;
};

/// Matrices that depend on the step h only: A = N + h/2 D + h^2/4 G of each link, inverted, and its
/// products with the three vectors through which the link is coupled to the rest. h = 0 gives the
/// plain masses.
template <int M>
struct StepConstants {
  using Vec = Eigen::Matrix<double, M, 1>;
  using Mat = Eigen::Matrix<double, M, M>;

  StepConstants(const FixedConstants<M>& c, double step);

  double h;
  Mat A1_inv, A2_inv;
  Vec x_a1, x_p1, x_s1;    // A1^-1 [a1 p1 s1]
  Vec x_k2, x_a2, x_s2;    // A2^-1 [k2 a2 s2]
  Eigen::Matrix3d X1, X2;  // [a1 p1 s1]' A1^-1 [a1 p1 s1], the same of link 2
  Mat DhG1, DhG2;          // D + h/2 G
  double K1h, K2h;         // h^2/4 K
  double b1h, b2h;         // h/2 of the viscous friction
  double rotor1;           // K1h / (J1 + K1h)
};

/// Right side of (M + h/2 D + h^2/4 K) a = r, apart from the bias.
template <int M>
struct AppliedForces {
  using Vec = Eigen::Matrix<double, M, 1>;
  double th1, th2, th4;  // th3 is eliminated beforehand
  Vec f1, f2;
  double K2h;    // joint 2 on the left: h^2/4 of its stiffness and h/2 of its damping
  double drag4;  // h/2 of the drag's slope on th4
};

/// Articulated-body algorithm: solves (M(q) + h/2 D + h^2/4 K) a = r - bias(q, v) from the tip
/// inwards.
///
/// Unknowns of link 2 are eliminated first: they are coupled to the hub through k2 (with the
/// acceleration across the link), a2 and the payload's rotation (with gamma''). The result is a
/// rigid body with corrected mass m_y, moment Sx and inertia I2. Then link 1's: they are coupled to
/// the rest through w'' = p1'f1'', s'' = s1'f1'' and a1'f1''. The remaining 3x3 system in th1, th2,
/// th4 is reduced by th4, and friction acts on the 2x2 one in th1, th2. Each object is one
/// evaluation. Equation names as in arm_equations.h.
template <int M>
class ArticulatedArm {
 public:
  static constexpr int kModes = M;
  using Constants = FixedConstants<M>;
  using Vec = Eigen::Matrix<double, M, 1>;

  ArticulatedArm(const FixedConstants<M>& c, const StepConstants<M>& k) noexcept : c_(c), k_(k) {}

  /// Geometry and bias at (q, v), and elimination down to th1, th2.
  void Reduce(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v,
              const AppliedForces<M>& r) noexcept;
  /// The 2x2 system in th1, th2.
  CoulombFrictionLcp hubs() const noexcept { return {z11_, z12_, z22_, r1_, r2_}; }
  double z11() const noexcept { return z11_; }
  double z12() const noexcept { return z12_; }
  double z22() const noexcept { return z22_; }
  /// All accelerations except that of th3, from those of th1 and th2.
  void Expand(const std::array<double, 2>& hub, ArmCoordinates<M>* a) const noexcept;

 private:
  void Turn(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v) noexcept;
  void EliminateLink2(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v,
                      const AppliedForces<M>& r) noexcept;
  void AssembleHub(const ArmCoordinates<M>& q, const ArmCoordinates<M>& v,
                   const AppliedForces<M>& r) noexcept;
  void EliminateLink1() noexcept;

  const FixedConstants<M>& c_;
  const StepConstants<M>& k_;
  // geometry and rates
  double w_, w_dot_, s_, e_, sb_, cb_, gamma_dot_, kappa_, tx_, ty_;
  // outboard body reduced to the elbow
  double m_y_, Sx_, Sy_, I_, u_, phi_, B_x_, B_y_, B_g_, X_, Y_;
  Vec r_f2_, r_f1_;
  // system in (th1, th2, th4 | w, s)
  double S11_, S12_, S22_, S14_, S24_, S44_, S1w_, S2w_, Sww_, S1s_, S2s_, S4s_, Sws_, Sss_;
  double g1_, g2_, g4_, gw_, gs_;
  // after the elimination of link 1: c = c0 - C theta, P and R of the 2x2 block
  double Cw1_, Cw2_, Cw4_, Cs1_, Cs2_, Cs4_, cw_, cs_;
  double z11_, z12_, z22_, r1_, r2_, th4_0_, th4_1_, th4_2_;
};

}  // namespace flexarm

#include "model/simulation/articulated_arm_impl.h"
