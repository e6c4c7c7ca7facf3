#pragma once

#include <Eigen/Dense>
#include <array>

#include "model/arm/shortened_link.h"
#include "model/math/small_cholesky.h"
#include "model/simulation/coulomb_friction_lcp.h"
#include "model/simulation/fixed_constants.h"

namespace flexarm {

/// Constants of the arm with foreshortening, links padded to M modes.
template <int M>
struct ForeshortenedConstants : FixedConstants<M> {
  explicit ForeshortenedConstants(const ArmConstants& c);

  Foreshortening<M> shortening1, shortening2;
};

/// Linear solver of a step for an arm with foreshortening.
///
/// Foreshortening makes the masses of the modal coordinates depend on them, so there is no constant
/// inverse: M + h/2 D + h^2/4 K is assembled from the velocities of the bodies as rows
/// (as ArmModel::MassMatrix does) in the order th4, phi1, phi2 | th1, th2 and factorised. Same
/// interface and meaning as ArticulatedArm. Real-time: safe.
template <int M>
class ForeshortenedArm {
 public:
  static constexpr int kModes = M;
  static constexpr bool kWide = false;  ///< compiled for AVX2 as well
  using Constants = ForeshortenedConstants<M>;
  using Step = StepConstants<M>;
  using Vec = Eigen::Matrix<double, M, 1>;
  using Coordinates = ArmCoordinates<Vec>;
  using Forces = AppliedForces<Vec>;

  ForeshortenedArm(const Constants& c, const Step& k, const Forces& /*r*/,
                   double /*th2_m*/) noexcept
      : c_(c), k_(k) {}

  template <typename Entry>
  static Vec MakeVec(Entry entry) noexcept {
    return Vec::NullaryExpr([&](Eigen::Index i) { return entry(static_cast<int>(i)); });
  }
  static void Bend(const Constants& c, const Step& k, const Coordinates& q, const Coordinates& v,
                   Forces* r) noexcept;

  void Reduce(const Coordinates& q, const Coordinates& v, const Forces& r) noexcept;
  CoulombFrictionLcp hubs() const noexcept { return {Z_(0, 0), Z_(1, 0), Z_(1, 1), y_[0], y_[1]}; }
  double z11() const noexcept { return Z_(0, 0); }
  double z12() const noexcept { return Z_(1, 0); }
  double z22() const noexcept { return Z_(1, 1); }
  double Expand(const std::array<double, 2>& hub, Coordinates* a) const noexcept;

 private:
  static constexpr int kInner = 1 + 2 * M;  // th4, phi1, phi2
  using Link = ShortenedLink<double, M>;
  using Outer = Eigen::Matrix<double, 2 + M, 1>;  // rates of phi1, th1, th2
  using Mat = Eigen::Matrix<double, M, M>;

  void Turn(const Coordinates& q, const Coordinates& v, const Link& link1) noexcept;
  void AssembleOuter(const Coordinates& q, const Link& link1, const Link& link2) noexcept;
  void AssembleInner(const Coordinates& q, const Link& link2) noexcept;
  void AddBias(const Coordinates& q, const Coordinates& v, const Link& link1,
               const Link& link2) noexcept;
  void Factorise(const Forces& r) noexcept;

  const Constants& c_;
  const StepConstants<M>& k_;
  // Bodies' rates as rows: elbow along and across link 2, frame 2, stator of motor 2.
  Outer x_, y_row_, gamma_, turn_;
  double e_, e2_, sb_, cb_, gamma_dot_, kappa_, X_, Y_, Sx_, Sy_, I_;
  Vec to_gamma_;                           // phi2 against gamma''
  Eigen::Matrix<double, 2 + M, 2 + M> A_;  // outer
  Eigen::Matrix<double, M, 2 + M> B_;      // phi2 against outer
  Mat A2_;
  Outer f_;                             // bias on outer
  Vec f2_;                              // bias on phi2
  Eigen::Matrix<double, kInner, 3> V_;  // L^-1 [inner against th1, th2 | inner right side]
  SmallCholesky<kInner> factor_;
  Eigen::Matrix2d Z_;
  Eigen::Vector2d y_;
};

}  // namespace flexarm

#include "model/simulation/foreshortened_arm_impl.h"
