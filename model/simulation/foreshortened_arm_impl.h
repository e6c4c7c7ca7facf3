#pragma once

// Bodies of foreshortened_arm.h, which includes this at its end.

#include <cmath>

namespace flexarm {

template <int M>
ForeshortenedConstants<M>::ForeshortenedConstants(const ArmConstants& c) : FixedConstants<M>(c) {
  const auto pad = [](const Foreshortening<>& link) {
    const int modes = static_cast<int>(link.C.cols());
    Foreshortening<M> out;
    out.tip.setZero(), out.k.setZero(), out.b.setZero(), out.C.setZero(), out.Q.setZero();
    Eigen::Matrix<int, ProductCount(M), 1> place;  // of a product among those of M modes
    int products = 0;
    for (int i = 0, at = 0; i < M; ++i) {
      for (int j = i; j < M; ++j, ++at) {
        if (i < modes && j < modes) place[products++] = at;
      }
    }
    for (Eigen::Index i = 0; i < products; ++i) {
      out.tip[place[i]] = link.tip[i], out.k[place[i]] = link.k[i], out.b[place[i]] = link.b[i];
      out.C.row(place[i]).head(modes) = link.C.row(i);
      for (Eigen::Index j = 0; j < products; ++j) out.Q(place[i], place[j]) = link.Q(i, j);
    }
    return out;
  };
  shortening1 = pad(c.shortening1);
  shortening2 = pad(c.shortening2);
}

template <int M>
void ForeshortenedArm<M>::Turn(const Coordinates& q, const Coordinates& v,
                               const Link& link1) noexcept {
  const double w = c_.p1.dot(q.f1), w_dot = c_.p1.dot(v.f1), s = c_.s1.dot(q.f1);
  e_ = 1.0 / (1.0 + s * s);
  const double root = std::sqrt(e_), alpha_dot = e_ * c_.s1.dot(v.f1), w1 = v.th[0];
  const double sine = std::sin(q.th[1]), cosine = std::cos(q.th[1]);
  sb_ = root * (sine + s * cosine), cb_ = root * (cosine - s * sine);
  gamma_dot_ = w1 + v.th[1] + alpha_dot;
  kappa_ = -2.0 * s * alpha_dot * alpha_dot;
  const double x_e = c_.L1 - link1.tip;
  const double x1 = -link1.tip_ddot - 2.0 * w1 * w_dot - w1 * w1 * x_e;
  const double y1 = -2.0 * w1 * link1.tip_dot - w1 * w1 * w;
  X_ = cb_ * x1 + sb_ * y1, Y_ = -sb_ * x1 + cb_ * y1;
  x_ << sb_ * c_.p1 - cb_ * link1.tip_slope, -cb_ * w + sb_ * x_e, 0.0;
  y_row_ << cb_ * c_.p1 + sb_ * link1.tip_slope, sb_ * w + cb_ * x_e, 0.0;
  turn_ << e_ * c_.s1, 1.0, 0.0;
  gamma_ = turn_;
  gamma_[M + 1] = 1.0;
}

template <int M>
void ForeshortenedArm<M>::AssembleOuter(const Coordinates& q, const Link& link1,
                                        const Link& link2) noexcept {
  const Outer F_x = c_.m * x_ - Sy_ * gamma_, F_y = c_.m * y_row_ + Sx_ * gamma_;
  const Outer T_g = I_ * gamma_ - Sy_ * x_ + Sx_ * y_row_;
  A_.noalias() = x_ * F_x.transpose();
  A_.noalias() += y_row_ * F_y.transpose();
  A_.noalias() += gamma_ * T_g.transpose();
  A_.noalias() += ((c_.Ir2 + c_.J2) * turn_) * turn_.transpose();
  A_.template topLeftCorner<M, M>() +=
      c_.N1 + (0.5 * k_.h) * k_.DhG1 + ShorteningMass<M>(c_.shortening1, q.f1);
  const Vec to_th1 = c_.a1 + link1.coupling;
  A_.template block<M, 1>(0, M) += to_th1;
  A_.template block<1, M>(M, 0) += to_th1.transpose();
  A_(M, M) +=
      c_.I1 + q.f1.dot(c_.N1 * q.f1) + link1.second_moment + k_.b1h + k_.K1h * (1.0 - k_.rotor1);
  B_.noalias() = c_.k2 * y_row_.transpose();
  B_.noalias() -= link2.k_slope * x_.transpose();
  B_.noalias() += to_gamma_ * gamma_.transpose();
}

template <int M>
void ForeshortenedArm<M>::AddBias(const Coordinates& q, const Coordinates& v, const Link& link1,
                                  const Link& link2) noexcept {
  const Vec N1f1 = c_.N1 * q.f1, N2f2 = c_.N2 * q.f2;
  const double g = gamma_dot_, w1 = v.th[0];
  const double s2 = c_.s2.dot(q.f2), alpha2_dot = e2_ * c_.s2.dot(v.f2);
  const double kappa2 = -2.0 * s2 * alpha2_dot * alpha2_dot;
  const double F_x =
      c_.m * X_ - link2.k_ddot - Sy_ * kappa_ - 2.0 * g * c_.k2.dot(v.f2) - g * g * Sx_;
  const double F_y = c_.m * Y_ + Sx_ * kappa_ - 2.0 * g * link2.k_dot - g * g * Sy_;
  const double T_g = -Sy_ * X_ + Sx_ * Y_ + I_ * kappa_ + link2.turning +
                     2.0 * g * (N2f2.dot(v.f2) + link2.half_rate) + c_.Ip * kappa2;
  f_ = F_x * x_ + F_y * y_row_ + T_g * gamma_ + ((c_.Ir2 + c_.J2) * kappa_) * turn_;
  f_.template head<M>() += link1.Forces(w1, 0.0) - (w1 * w1) * N1f1;
  f_[M] += 2.0 * w1 * (N1f1.dot(v.f1) + link1.half_rate) + link1.turning;
  // to_gamma_ contains the payload's rotation with gamma already, but not with alpha2.
  f2_ = Y_ * c_.k2 - X_ * link2.k_slope + kappa_ * (to_gamma_ - link2.coupling) +
        link2.Forces(g, kappa_) - (g * g) * N2f2 + (c_.Ip * e2_ * kappa2) * c_.s2;
}

template <int M>
void ForeshortenedArm<M>::AssembleInner(const Coordinates& q, const Link& link2) noexcept {
  const double s2 = c_.s2.dot(q.f2);
  e2_ = 1.0 / (1.0 + s2 * s2);
  Sx_ = c_.Sx - link2.k;
  Sy_ = c_.k2.dot(q.f2);
  I_ = c_.I2 + q.f2.dot(c_.N2 * q.f2) + link2.second_moment + c_.Ip;
  to_gamma_ = c_.a2 + link2.coupling + (c_.Ip * e2_) * c_.s2;
  A2_ = c_.N2 + (0.5 * k_.h) * k_.DhG2 + ShorteningMass<M>(c_.shortening2, q.f2);
  A2_.noalias() += ((c_.Ip * e2_ * e2_) * c_.s2) * c_.s2.transpose();
}

template <int M>
void ForeshortenedArm<M>::Bend(const Constants& c, const Step& k, const Coordinates& q,
                               const Coordinates& v, Forces* r) noexcept {
  r->f1.noalias() = -(c.G1 * q.f1);
  r->f1.noalias() -= k.DhG1 * v.f1;
  r->f2.noalias() = -(c.G2 * q.f2);
  r->f2.noalias() -= k.DhG2 * v.f2;
}

// Inner block first, so that the Schur complement is the 2x2 system that friction acts on.
template <int M>
void ForeshortenedArm<M>::Factorise(const Forces& r) noexcept {
  Eigen::Matrix<double, kInner, kInner> A = Eigen::Matrix<double, kInner, kInner>::Zero();
  A(0, 0) = c_.J2 + r.K2h + r.drag4;
  A.template block<M, 1>(1, 0) = (c_.J2 * e_) * c_.s1;
  A.template block<M, M>(1, 1) = A_.template topLeftCorner<M, M>();
  A.template block<M, M>(1 + M, 1) = B_.template leftCols<M>();
  A.template block<M, M>(1 + M, 1 + M) = A2_;
  factor_.Compute(A);
  V_ << c_.J2, -r.K2h, r.th4 - c_.J2 * kappa_,                           //
      A_.template topRightCorner<M, 2>(), r.f1 - f_.template head<M>(),  //
      B_.template rightCols<2>(), r.f2 - f2_;
  factor_.SolveLower(&V_);
  Z_ = A_.template bottomRightCorner<2, 2>();
  Z_(1, 1) += r.K2h + k_.b2h;
  Z_.noalias() -= V_.template leftCols<2>().transpose() * V_.template leftCols<2>();
  y_ << r.th1 - f_[M], r.th2 - f_[M + 1];
  y_.noalias() -= V_.template leftCols<2>().transpose() * V_.col(2);
}

template <int M>
void ForeshortenedArm<M>::Reduce(const Coordinates& q, const Coordinates& v,
                                 const Forces& r) noexcept {
  const Vec none = Vec::Zero();
  const Link link1(c_.shortening1, q.f1, v.f1, none), link2(c_.shortening2, q.f2, v.f2, none);
  Turn(q, v, link1);
  AssembleInner(q, link2);
  AssembleOuter(q, link1, link2);
  AddBias(q, v, link1, link2);
  Factorise(r);
}

template <int M>
double ForeshortenedArm<M>::Expand(const std::array<double, 2>& hub,
                                   Coordinates* a) const noexcept {
  Eigen::Matrix<double, kInner, 1> inner = V_.col(2) - hub[0] * V_.col(0) - hub[1] * V_.col(1);
  factor_.L().transpose().template triangularView<Eigen::Upper>().solveInPlace(inner);
  a->th[0] = hub[0], a->th[1] = hub[1], a->th[3] = inner[0];
  a->f1 = inner.template segment<M>(1);
  a->f2 = inner.template tail<M>();
  return c_.s1.dot(a->f1);
}

}  // namespace flexarm
