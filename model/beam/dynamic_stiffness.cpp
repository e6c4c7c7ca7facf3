#include "model/beam/dynamic_stiffness.h"

#include <algorithm>
#include <cmath>

#include "model/beam/beam_equations.h"
#include "model/math/dense_decompositions.h"
#include "model/units.h"

namespace flexarm {
namespace {

// int of the products of Hermite's cubics: consistent mass at unit mass per length.
Eigen::Matrix4d StaticMass(double l) {
  Eigen::Matrix4d M;
  // clang-format off
  M <<  156.0,    22.0 * l,       54.0,    -13.0 * l,
     22.0 * l,  4.0 * l * l,  13.0 * l,  -3.0 * l * l,
         54.0,    13.0 * l,      156.0,    -22.0 * l,
    -13.0 * l, -3.0 * l * l, -22.0 * l,   4.0 * l * l;
  // clang-format on
  return l / 420.0 * M;
}

}  // namespace

Eigen::Matrix4d SectionStiffness(const BeamSection& s, double omega) {
  const double EI = s.bending_stiffness_nm2(), l = s.length_m;
  // Below beta l = 0.02 the next term of the series, (beta l)^8, is lost in round-off, and so are
  // the digits of the general form, which subtracts.
  if (Beta(s, omega) * l < 0.02) {
    return StaticStiffness(l, EI) - omega * omega * s.mass_per_length_kg_m() * StaticMass(l);
  }
  Eigen::Matrix4d displacement, force;
  displacement << BasisRow(s, omega, 0, 0), BasisRow(s, omega, 0, 1), BasisRow(s, omega, l, 0),
      BasisRow(s, omega, l, 1);
  force << EI * BasisRow(s, omega, 0, 3), -EI * BasisRow(s, omega, 0, 2),
      -EI * BasisRow(s, omega, l, 3), EI * BasisRow(s, omega, l, 2);
  // K = F E^-1. Slope rows are brought to the size of the others before the factorisation.
  const double beta = Beta(s, omega);
  const Eigen::Vector4d scale(1.0, 1.0 / beta, 1.0, 1.0 / beta);
  const Eigen::Matrix4d scaled = scale.asDiagonal() * displacement;
  const Eigen::Matrix4d inverse = scaled.fullPivLu().inverse() * scale.asDiagonal();
  const Eigen::Matrix4d K = force * inverse;
  return 0.5 * (K + K.transpose());
}

// Roots of 1 - cos z cosh z.
int CountClampedClamped(const BeamSection& s, double omega) {
  const double z = Beta(s, omega) * s.length_m;
  if (z < 4.0) return 0;  // the first root is 4.730
  // Of a section without stiffness it has no end. No caller asks for as many.
  constexpr double kMostCounted = 1e6;
  const int i = static_cast<int>(std::min(std::floor(z / kPi), kMostCounted));
  const bool positive = 1.0 / std::cosh(z) > std::cos(z);
  const bool even = i % 2 == 0;
  return i - (positive == even ? 0 : 1);
}

int CountNegativeEigenvalues(const Eigen::MatrixXd& K) {
  const Eigen::VectorXd scale = K.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * K * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled, Eigen::EigenvaluesOnly);
  return static_cast<int>((eigen.eigenvalues().array() < 0.0).count());
}

}  // namespace flexarm
