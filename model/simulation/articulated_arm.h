#pragma once

#include <Eigen/Dense>
#include <array>

#include "model/arm/arm_constants.h"
#include "model/simulation/coulomb_friction_lcp.h"
#include "model/simulation/fixed_constants.h"
#include "model/simulation/mode_vector.h"
#include "model/simulation/nearby_angle.h"

namespace flexarm {

/// What ArticulatedArm needs of one link: everything that is linear in its modal coordinates f, as
/// constant maps, with A = N + h/2 D + h^2/4 G. c1, c2, c3 are the vectors through which the link
/// is coupled to the rest.
template <int M>
struct LinkMaps {
  using Mat = Eigen::Matrix<double, M, M>;
  using Couplings = Eigen::Matrix<double, M, 3>;

  /// @param tip  M x 2: the two of them that kinematics needs of f
  LinkMaps(const Mat& N, const Mat& G, const Mat& DhG, const Mat& A_inv, const Couplings& c,
           const Eigen::Matrix<double, M, 2>& tip);

  ModeMap<M, M> mass;         // N
  ModeMap<M, M> stiffness;    // G
  ModeMap<M, M> damping;      // D + h/2 G
  ModeMap<M, M> inverse;      // A^-1
  ModeMap<M, M> turned;       // A^-1 N
  ModeMap<3, M> reaction;     // [c1 c2 c3]' A^-1
  ModeMap<3, M> centrifugal;  // [c1 c2 c3]' A^-1 N
  ModeMap<2, M> tip;
  std::array<ModeVector<M>, 3> x;  // A^-1 [c1 c2 c3]
};

/// StepConstants in the form of LinkMaps.
template <int M>
struct ArticulatedStep {
  ArticulatedStep(const FixedConstants<M>& c, double step)
      : ArticulatedStep(c, StepConstants<M>(c, step)) {}

  double h;
  Eigen::Matrix3d X1, X2;
  double K1h, K2h, b1h, b2h, rotor1;
  double det1;  // of X1's block of p1 and s1
  LinkMaps<M> link1, link2;

 private:
  ArticulatedStep(const FixedConstants<M>& c, const StepConstants<M>& k);
};

/// Articulated-body algorithm: solves (M(q) + h/2 D + h^2/4 K) a = r - bias(q, v) from the tip
/// inwards.
///
/// Unknowns of link 2 are eliminated first: they are coupled to the hub through k2 (with the
/// acceleration across the link), a2 and the payload's rotation (with gamma''). The result is a
/// rigid body with corrected mass m_y, moment Sx and inertia I2. Then th4, whose equation has a
/// constant pivot, and link 1's: they are coupled to the rest through w'' = p1'f1'', s'' = s1'f1''
/// and a1'f1''. Friction acts on the remaining 2x2 system in th1, th2. Each object serves one step;
/// Reduce and Expand are one evaluation. Equation names as in arm_equations.h.
///
/// A pass costs mostly the waiting of each operation for the one before. So what is linear in the
/// modal coordinates comes from constant maps at once, and of the two divisions of the elimination
/// the first is off that path.
template <int M>
class ArticulatedArm {
 public:
  static constexpr int kModes = M;
  static constexpr bool kWide = true;  ///< compiled for AVX2 as well
  using Constants = FixedConstants<M>;
  using Step = ArticulatedStep<M>;
  using Vec = ModeVector<M>;
  using Coordinates = ArmCoordinates<Vec>;
  using Forces = AppliedForces<Vec>;

  /// @param r      forces of the step on the modes; those on the angles are given to Reduce
  /// @param th2_m  a value near those of Reduce
  ArticulatedArm(const Constants& c, const Step& k, const Forces& r, double th2_m) noexcept;

  template <typename Entry>
  static Vec MakeVec(Entry entry) noexcept {
    return Vec::Of(entry);
  }
  /// Forces of the links' own stiffness and damping, at (q + h/2 v, v).
  static void Bend(const Constants& c, const Step& k, const Coordinates& q, const Coordinates& v,
                   Forces* r) noexcept;

  /// Geometry and bias at (q, v), and elimination down to th1, th2.
  void Reduce(const Coordinates& q, const Coordinates& v, const Forces& r) noexcept;
  /// The 2x2 system in th1, th2.
  CoulombFrictionLcp hubs() const noexcept { return {z11_, z12_, z22_, r1_, r2_}; }
  double z11() const noexcept { return z11_; }
  double z12() const noexcept { return z12_; }
  double z22() const noexcept { return z22_; }
  /// All accelerations except that of th3, from those of th1 and th2.
  /// @returns s1'f1'', 1/s^2
  double Expand(const std::array<double, 2>& hub, Coordinates* a) const noexcept;

 private:
  void Turn(const Coordinates& q, const Coordinates& v) noexcept;
  void EliminateLink2(const Coordinates& q, const Coordinates& v) noexcept;
  void AssembleHub(const Coordinates& q, const Coordinates& v, const Forces& r) noexcept;
  void EliminateLink1() noexcept;

  const Constants& c_;
  const Step& k_;
  NearbyAngle elbow_;
  // forces on the modes through A^-1
  Vec bent1_, bent2_;
  ModeVector<3> reaction1_, reaction2_;
  // geometry and rates
  double w_, e_, sb_, cb_, gamma_dot_, kappa_, tx_, ty_;
  // outboard body reduced to the elbow
  double m_y_, Sx_, Sy_, I_, u_, phi_, B_x_, B_y_, B_g_, X_, Y_, tip2_, z_s2_;
  // accelerations of the modes if nothing else moved
  Vec free1_, free2_;
  // system in (th1, th2 | w, s) without th4
  double S11_, S12_, S22_, S1w_, S2w_, Sww_, S1s_, S2s_, Sws_, Sss_;
  double g1_, g2_, g4_, gw_, gs_, over4_, K2h_;
  ModeVector<3> z1_;
  // after the elimination of link 1: det c = c0 - C theta
  double over_, Cw1_, Cw2_, Cs1_, Cs2_, cw_, cs_;
  double z11_, z12_, z22_, r1_, r2_;
};

}  // namespace flexarm

#include "model/simulation/articulated_arm_impl.h"
