#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <vector>

#include "tests/tools/thesis/second_method/element_link.h"

namespace flexarm::second_method {

using Complex = std::complex<double>;

/// A quantity along a line in the space of coordinates: value and the first two coefficients of
/// its power series. Complex, so that a complex step differentiates it once more.
struct Series {
  Complex value = 0.0, first = 0.0, second = 0.0;

  Series operator+(const Series& b) const {
    return {value + b.value, first + b.first, second + b.second};
  }
  Series operator*(const Series& b) const {
    return {value * b.value, value * b.first + first * b.value,
            value * b.second + first * b.first + second * b.value};
  }
  /// f(this), from f and its first two derivatives at `value`.
  Series Of(Complex f, Complex df, Complex ddf) const {
    return {f, df * first, df * second + 0.5 * ddf * first * first};
  }
  Series Sine() const { return Of(std::sin(value), std::cos(value), -std::sin(value)); }
  Series Cosine() const { return Of(std::cos(value), -std::sin(value), -std::cos(value)); }
  Series ArcTangent() const {
    const Complex one = 1.0 / (1.0 + value * value);
    return Of(std::atan(value), one, -2.0 * value * one * one);
  }
};

/// The arm as mass points on links that bend by ElementLink's shapes: Lagrange's equations from the
/// positions alone, for the statements on linear models a second time. No shortening of bent links.
///
/// q as ArmModel's: th1 th2 th3 th4, tip deflections of link 1, of link 2. Uniform links, damped by
/// (3.8) with the density (`ca_rho`).
class MassPointArm {
 public:
  MassPointArm(const ArmParameters& p, int modes, int elements)
      : p_(p),
        modes_(modes),
        link_{ElementLink(
                  p.link[0].section.front(),
                  p.motor2_mass_kg + p.hub2_mass_kg + p.link[1].mass_kg() + p.shape_payload_mass_kg,
                  p.motor2_inertia_kgm2 + (p.link1_tip_inertia == Link1TipInertia::kMotorAndRotor
                                               ? p.joint[1].rotor_inertia_kgm2
                                               : 0.0),
                  elements, modes),
              ElementLink(p.link[1].section.front(), p.shape_payload_mass_kg,
                          p.payload_inertia_kgm2, elements, modes)},
        stiffness_(Eigen::MatrixXd::Zero(dof(), dof())),
        damping_(stiffness_) {
    for (const Eigen::Index joint : {0, 1}) {
      const double k = p.joint[static_cast<std::size_t>(joint)].stiffness_nm_per_rad;
      stiffness_(joint, joint) = stiffness_(2 + joint, 2 + joint) = k;
      stiffness_(joint, 2 + joint) = stiffness_(2 + joint, joint) = -k;
      const ElementLink& link = link_[static_cast<std::size_t>(joint)];
      const Eigen::Index at = 4 + joint * modes_;
      stiffness_.block(at, at, modes_, modes_) = link.stiffness;
      const double per_stiffness = p.link[static_cast<std::size_t>(joint)].damping_ratio *
                                   link.length_m * link.length_m *
                                   std::sqrt(link.mass_per_m / link.bending_nm2);
      damping_.block(at, at, modes_, modes_) = per_stiffness * link.stiffness;
    }
  }

  int dof() const { return 4 + 2 * modes_; }
  const ElementLink& link(std::size_t i) const { return link_[i]; }
  const Eigen::MatrixXd& stiffness() const { return stiffness_; }
  const Eigen::MatrixXd& damping() const { return damping_; }

  Eigen::MatrixXd Mass(const Eigen::VectorXd& q) const {
    const Eigen::MatrixXcd J = Jacobian(q);
    return J.real().transpose() * Weights().asDiagonal() * J.real();
  }
  /// M(q) a + Bias(q, v) + D v + K q = B u.
  Eigen::VectorXd Bias(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    return BiasAt(q, v).real();
  }
  /// dBias/dq by the complex step.
  Eigen::MatrixXd BiasByPosition(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    constexpr double kStep = 1e-30;
    Eigen::MatrixXd slope(dof(), dof());
    for (Eigen::Index i = 0; i < dof(); ++i) {
      Eigen::VectorXcd at = q.cast<Complex>();
      at[i] += Complex(0.0, kStep);
      slope.col(i) = BiasAt(at, v).imag() / kStep;
    }
    return slope;
  }
  Eigen::MatrixXd Input() const {
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(dof(), 2);
    B(2, 0) = B(3, 1) = 1.0;
    return B;
  }
  /// d(tip)/dq.
  Eigen::MatrixXd TipByPosition(const Eigen::VectorXd& q) const {
    return Jacobian(q).real().middleRows(tip_row(), 2);
  }

 private:
  using Rows = std::vector<Series>;

  Eigen::Index tip_row() const {
    return 2 * static_cast<Eigen::Index>(link_[0].point.size() + 1 + link_[1].point.size());
  }

  // x and y of every mass point, then the angles of the bodies that turn.
  Rows Places(const std::vector<Series>& q) const {
    Rows rows;
    const auto bend = [&](const Eigen::VectorXd& shape, int link) {
      Series sum;
      for (int j = 0; j < modes_; ++j) {
        const int place = 4 + link * modes_ + j;
        sum = sum + Series{shape[j]} * q[static_cast<std::size_t>(place)];
      }
      return sum;
    };
    const auto add = [&](const Series& x0, const Series& y0, const Series& c, const Series& s,
                         double along, const Series& across) {
      rows.push_back(x0 + Series{along} * c + Series{-1.0} * across * s);
      rows.push_back(y0 + Series{along} * s + across * c);
    };
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(modes_);
    const Series c1 = q[0].Cosine(), s1 = q[0].Sine(), zero;
    for (const auto& point : link_[0].point) add(zero, zero, c1, s1, point.x_m, bend(point.psi, 0));
    add(zero, zero, c1, s1, link_[0].length_m, bend(one, 0));
    const Series ex = rows[rows.size() - 2], ey = rows.back();
    const Series end = q[0] + bend(link_[0].tip_slope, 0).ArcTangent(), root = end + q[1];
    const Series c2 = root.Cosine(), s2 = root.Sine();
    for (const auto& point : link_[1].point) add(ex, ey, c2, s2, point.x_m, bend(point.psi, 1));
    add(ex, ey, c2, s2, link_[1].length_m, bend(one, 1));
    for (const Series& angle :
         {q[0], end, root, q[2], end + q[3], root + bend(link_[1].tip_slope, 1).ArcTangent()}) {
      rows.push_back(angle);
    }
    return rows;
  }

  // Masses and inertias in the order of Places.
  Eigen::VectorXd Weights() const {
    std::vector<double> w;
    const auto mass = [&w](double kg) { w.insert(w.end(), {kg, kg}); };
    for (const auto& point : link_[0].point) mass(point.mass_kg);
    mass(p_.motor2_mass_kg + p_.hub2_mass_kg);
    for (const auto& point : link_[1].point) mass(point.mass_kg);
    mass(p_.payload_mass_kg);
    w.insert(w.end(), {p_.joint[0].hub_inertia_kgm2, p_.motor2_inertia_kgm2,
                       p_.joint[1].hub_inertia_kgm2, p_.joint[0].rotor_inertia_kgm2,
                       p_.joint[1].rotor_inertia_kgm2, p_.payload_inertia_kgm2});
    return Eigen::Map<Eigen::VectorXd>(w.data(), static_cast<Eigen::Index>(w.size()));
  }

  Rows Along(const Eigen::VectorXcd& q, const Eigen::VectorXd& direction) const {
    std::vector<Series> line;
    for (Eigen::Index i = 0; i < dof(); ++i) line.push_back({q[i], direction[i], 0.0});
    return Places(line);
  }

  Eigen::MatrixXcd Jacobian(const Eigen::VectorXcd& q) const {
    Eigen::MatrixXcd J;
    for (Eigen::Index i = 0; i < dof(); ++i) {
      const Rows rows = Along(q, Eigen::VectorXd::Unit(dof(), i));
      if (i == 0) J.resize(static_cast<Eigen::Index>(rows.size()), dof());
      for (std::size_t k = 0; k < rows.size(); ++k)
        J(static_cast<Eigen::Index>(k), i) = rows[k].first;
    }
    return J;
  }

  // The force that keeps every body on q + v t: J' m p''.
  Eigen::VectorXcd BiasAt(const Eigen::VectorXcd& q, const Eigen::VectorXd& v) const {
    const Rows rows = Along(q, v);
    Eigen::VectorXcd acceleration(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      acceleration[static_cast<Eigen::Index>(k)] = 2.0 * rows[k].second;
    }
    return Jacobian(q).transpose() * Weights().cast<Complex>().cwiseProduct(acceleration);
  }

  ArmParameters p_;
  int modes_;
  std::array<ElementLink, 2> link_;
  Eigen::MatrixXd stiffness_, damping_;
};

}  // namespace flexarm::second_method
