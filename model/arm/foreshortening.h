#pragma once

#include <Eigen/Core>

#include "model/beam/link_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Number of products phi_i phi_j, i <= j, of `modes` coordinates.
constexpr int ProductCount(int modes) {
  return modes == Eigen::Dynamic ? Eigen::Dynamic : modes * (modes + 1) / 2;
}

/// Integrals over a link that gets shorter along its axis as it bends.
///
/// A point at arc length u stands at x = u - delta(u), y = w(u), with
///   delta(u) = 1/2 int_0^u w'^2 = h(u)'p,   p = products phi_i phi_j (i <= j),
///   h_ij(u) = int_0^u psi_i' psi_j' (half of it for i = j):
/// an inextensible beam to second order in its slope. The products are coordinates along the link
/// as the phi are across it, so the kinetic energy of these positions is exact with constant
/// integrals. lam = rho A. Not in the thesis, whose links keep their projected length: in it the
/// centrifugal force softens a turning link instead of stiffening it.
template <int M = Eigen::Dynamic>
struct Foreshortening {
  using VecP = Eigen::Matrix<double, ProductCount(M), 1>;
  using MatP = Eigen::Matrix<double, ProductCount(M), ProductCount(M)>;
  using MatPM = Eigen::Matrix<double, ProductCount(M), M>;

  VecP tip;  ///< h(L), 1/m
  VecP k;    ///< int lam h, kg/m
  VecP b;    ///< int lam u h, kg
  MatPM C;   ///< int lam h psi', kg/m
  MatP Q;    ///< int lam h h', kg/m^2
};

/// By the quadrature of LinkModes, relative error below 1e-12. Distributed mass only.
Foreshortening<> ForeshorteningOf(const LinkModes& link, const LinkParameters& p);

/// Adds a point mass at the tip, m_p >= 0. Real-time: safe.
void AddTipMass(const LinkModes& link, double mass_kg, Foreshortening<>* out);

/// delta(L) of modal coordinates phi, m. Real-time: safe.
double TipShortening(const Foreshortening<>& link, const Eigen::Ref<const Eigen::VectorXd>& phi);

}  // namespace flexarm
