#pragma once

#include <Eigen/Core>

#include "model/arm/foreshortening.h"

namespace flexarm {

/// Terms that foreshortening adds to the inertial forces of one link, at one state.
///
/// With p, p_dot, p_ddot the products and their derivatives and J = dp/dphi; everything else
/// follows from x = u - h'p, y = w in a frame that turns at `rate` and whose origin accelerates.
/// Scalar: double, or std::complex<double> for the complex step. M: modes, fixed or Eigen::Dynamic.
/// Real-time: safe for a fixed M.
template <typename Scalar, int M>
class ShortenedLink {
 public:
  using Vec = Eigen::Matrix<Scalar, M, 1>;
  using VecP = Eigen::Matrix<Scalar, ProductCount(M), 1>;

  ShortenedLink(const Foreshortening<M>& link, const Vec& f, const Vec& f_dot, const Vec& f_ddot)
      : link_(link), f_(f), p_(Scalar(0.5) * Products(f, f)), p_dot_(Products(f, f_dot)) {
    p_ddot_ = Products(f, f_ddot) + Products(f_dot, f_dot);
    const VecP Qp = link_.Q * p_;
    const VecP Qp_ddot = link_.Q * p_ddot_;
    const VecP Cf = link_.C * f;
    const VecP Cf_dot = link_.C * f_dot;
    const auto Ct = link_.C.transpose();
    const Vec Ctp = Ct * p_;
    tip = Dot(link_.tip, p_), tip_dot = Dot(link_.tip, p_dot_), tip_ddot = Dot(link_.tip, p_ddot_);
    k = Dot(link_.k, p_), k_dot = Dot(link_.k, p_dot_), k_ddot = Dot(link_.k, p_ddot_);
    tip_slope = Back(link_.tip.template cast<Scalar>());
    k_slope = Back(link_.k.template cast<Scalar>());
    second_moment = Sum(p_, Qp) - 2.0 * Dot(link_.b, p_);
    half_rate = Sum(p_dot_, Qp) - Dot(link_.b, p_dot_);
    turning = Sum(Cf, p_ddot_) - Sum(Ctp, f_ddot);
    coupling = Back(Cf) - Ctp;
    coriolis_ = Back(Cf_dot) - Ct * p_dot_;
    centrifugal_ = Back(link_.b.template cast<Scalar>() - Qp);
    inertia_ = Back(Qp_ddot);
  }

  Scalar tip, tip_dot, tip_ddot;  ///< delta(L), m
  Vec tip_slope;                  ///< d delta(L) / d phi
  Scalar k, k_dot, k_ddot;        ///< int lam delta: the loss of first moment, kg m
  Vec k_slope;                    ///< d k / d phi
  Scalar second_moment;           ///< added to int lam (x^2 + y^2), kg m^2
  Scalar half_rate;               ///< half of the second moment's time derivative, without y
  Scalar turning;                 ///< moment of the accelerations relative to the frame, N m
  Vec coupling;  ///< added to int lam u psi: coupling of the frame's rotation to phi

  /// Forces on phi in a frame that turns with `rate` and `rate_dot`.
  Vec Forces(const Scalar& rate, const Scalar& rate_dot) const {
    return rate_dot * coupling + 2.0 * rate * coriolis_ + rate * rate * centrifugal_ + inertia_;
  }

  /// J'y
  Vec Back(const VecP& y) const {
    Vec out = Vec::Zero(f_.size());
    Eigen::Index n = 0;
    for (Eigen::Index i = 0; i < f_.size(); ++i) {
      for (Eigen::Index j = i; j < f_.size(); ++j, ++n) {
        out[i] += y[n] * f_[j];
        out[j] += y[n] * f_[i];
      }
    }
    return out;
  }

 private:
  static VecP Products(const Vec& a, const Vec& b) {  // symmetric: d(p)/dt for a = f, b = f_dot
    VecP out(ProductCount(static_cast<int>(a.size())));
    Eigen::Index n = 0;
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      for (Eigen::Index j = i; j < a.size(); ++j) out[n++] = a[i] * b[j] + a[j] * b[i];
    }
    return out;
  }
  static Scalar Dot(const typename Foreshortening<M>::VecP& a, const VecP& b) {
    return (a.template cast<Scalar>().array() * b.array()).sum();
  }
  template <typename Vector>
  static Scalar Sum(const Vector& a, const Vector& b) {  // no conjugation
    return (a.array() * b.array()).sum();
  }

  const Foreshortening<M>& link_;
  Vec f_;
  VecP p_, p_dot_, p_ddot_;
  Vec coriolis_, centrifugal_, inertia_;
};

/// J'QJ: added by foreshortening to the masses of the modal coordinates, kg.
template <int M>
Eigen::Matrix<double, M, M> ShorteningMass(const Foreshortening<M>& link,
                                           const Eigen::Matrix<double, M, 1>& f) {
  typename Foreshortening<M>::MatPM J =
      Foreshortening<M>::MatPM::Zero(ProductCount(static_cast<int>(f.size())), f.size());
  Eigen::Index n = 0;
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    for (Eigen::Index j = i; j < f.size(); ++j, ++n) {
      J(n, i) += f[j];
      J(n, j) += f[i];
    }
  }
  return J.transpose() * (link.Q * J);
}

}  // namespace flexarm
