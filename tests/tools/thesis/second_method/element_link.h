#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm::second_method {

/// A uniform link, clamped, with what hangs at its tip: modes by Hermite elements, psi(L) = 1.
/// Shares nothing with the closed form of the product but the parameters.
struct ElementLink {
  struct Point {
    double x_m, mass_kg;
    Eigen::VectorXd psi;
  };
  std::vector<Point> point;    ///< four an element: exact for products of two shapes
  Eigen::VectorXd tip_slope;   ///< psi'(L), 1/m
  Eigen::VectorXd root_curve;  ///< psi''(0), 1/m^2
  Eigen::VectorXd frequency_rad_s;
  Eigen::MatrixXd stiffness;  ///< EI int psi_i'' psi_j'', N/m
  double bending_nm2, length_m, mass_per_m;

  ElementLink(const BeamSection& s, double tip_kg, double tip_kgm2, int elements, int modes)
      : bending_nm2(s.bending_stiffness_nm2()),
        length_m(s.length_m),
        mass_per_m(s.mass_per_length_kg_m()) {
    const Eigen::Index n = 2 * elements + 2;
    const double l = length_m / elements;
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n), M = K;
    for (Eigen::Index i = 0; i < elements; ++i) {
      Eigen::Matrix4d k = Eigen::Matrix4d::Zero(), m = k;
      ForGauss([&](double at, double weight) {
        const Eigen::Vector4d value = Shape(at, l), curve = Curve(at, l);
        k += weight * l * bending_nm2 * curve * curve.transpose();
        m += weight * l * mass_per_m * value * value.transpose();
      });
      K.block<4, 4>(2 * i, 2 * i) += k;
      M.block<4, 4>(2 * i, 2 * i) += m;
    }
    M(n - 2, n - 2) += tip_kg;
    M(n - 1, n - 1) += tip_kgm2;
    const Eigen::Index free = n - 2;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        K.bottomRightCorner(free, free), M.bottomRightCorner(free, free));
    Eigen::MatrixXd at_nodes = Eigen::MatrixXd::Zero(n, modes);
    for (Eigen::Index j = 0; j < modes; ++j) {
      const Eigen::VectorXd shape = eigen.eigenvectors().col(j);
      at_nodes.col(j).tail(free) = shape / shape[free - 2];
    }
    frequency_rad_s = eigen.eigenvalues().head(modes).cwiseSqrt();
    stiffness = at_nodes.transpose() * K * at_nodes;
    tip_slope = at_nodes.row(n - 1).transpose();
    root_curve = at_nodes.topRows(4).transpose() * Curve(0.0, l);
    for (Eigen::Index i = 0; i < elements; ++i) {
      ForGauss([&](double at, double weight) {
        point.push_back({(static_cast<double>(i) + at) * l, weight * l * mass_per_m,
                         at_nodes.middleRows(2 * i, 4).transpose() * Shape(at, l)});
      });
    }
  }

 private:
  template <typename F>
  static void ForGauss(const F& f) {  // four points on 0 .. 1
    const double inner = std::sqrt(3.0 / 7.0 - 2.0 / 7.0 * std::sqrt(6.0 / 5.0)),
                 outer = std::sqrt(3.0 / 7.0 + 2.0 / 7.0 * std::sqrt(6.0 / 5.0));
    const double heavy = (18.0 + std::sqrt(30.0)) / 72.0, light = (18.0 - std::sqrt(30.0)) / 72.0;
    for (const double side : {-1.0, 1.0}) {
      f(0.5 + 0.5 * side * inner, heavy);
      f(0.5 + 0.5 * side * outer, light);
    }
  }
  static Eigen::Vector4d Shape(double s, double l) {
    return {1 - 3 * s * s + 2 * s * s * s, l * (s - 2 * s * s + s * s * s),
            3 * s * s - 2 * s * s * s, l * (s * s * s - s * s)};
  }
  static Eigen::Vector4d Curve(double s, double l) {
    return Eigen::Vector4d(-6 + 12 * s, l * (-4 + 6 * s), 6 - 12 * s, l * (6 * s - 2)) / (l * l);
  }
};

}  // namespace flexarm::second_method
