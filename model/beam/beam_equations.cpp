#include "model/beam/beam_equations.h"

#include <cmath>

#include "model/beam/beam_basis.h"

namespace flexarm {

double Beta(const BeamSection& s, double omega) {
  return std::sqrt(omega * std::sqrt(s.mass_per_length_kg_m() / s.bending_stiffness_nm2()));
}

// Row of basis values: derivative `order`, in SI units (1/m^order).
Eigen::RowVector4d BasisRow(const BeamSection& s, double omega, double x, int order) {
  const double beta = Beta(s, omega);
  const auto f = BeamBasis(UseDecayingBasis(beta * s.length_m), beta, s.length_m, x, order);
  const double scale = std::pow(beta, order);
  return scale * Eigen::RowVector4d(f[0], f[1], f[2], f[3]);
}

Eigen::Matrix4d StaticStiffness(double length_m, double bending_stiffness_nm2) {
  const double l = length_m, EI = bending_stiffness_nm2;
  Eigen::Matrix4d K;
  // clang-format off
  K <<  12.0,     6.0 * l,     -12.0,     6.0 * l,
      6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l,
       -12.0,    -6.0 * l,      12.0,    -6.0 * l,
      6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l;
  // clang-format on
  return EI / (l * l * l) * K;
}

Eigen::MatrixXd MatchingMatrix(const std::vector<BeamSection>& section, const BeamTip& tip,
                               double omega, BeamRoot root) {
  const Eigen::Index n = 4 * static_cast<Eigen::Index>(section.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A.block<1, 4>(0, 0) = BasisRow(section.front(), omega, 0.0, 0);
  A.block<1, 4>(1, 0) = BasisRow(section.front(), omega, 0.0, 1);
  if (!root.clamped()) {
    A.block<1, 4>(1, 0) *= -root.stiffness_nm_per_rad;
    A.block<1, 4>(1, 0) +=
        section.front().bending_stiffness_nm2() * BasisRow(section.front(), omega, 0.0, 2);
  }
  Eigen::Index row = 2;
  for (std::size_t i = 0; i + 1 < section.size(); ++i) {
    const BeamSection &a = section[i], &b = section[i + 1];
    const Eigen::Index col = 4 * static_cast<Eigen::Index>(i);
    for (int d = 0; d < 4; ++d, ++row) {
      const double Ka = d < 2 ? 1.0 : a.bending_stiffness_nm2();
      const double Kb = d < 2 ? 1.0 : b.bending_stiffness_nm2();
      A.block<1, 4>(row, col) = Ka * BasisRow(a, omega, a.length_m, d);
      A.block<1, 4>(row, col + 4) = -Kb * BasisRow(b, omega, 0.0, d);
    }
  }
  const BeamSection& s = section.back();
  const double EI = s.bending_stiffness_nm2(), w2 = omega * omega, l = s.length_m;
  A.block<1, 4>(row, n - 4) =
      EI * BasisRow(s, omega, l, 2) - w2 * tip.inertia_kgm2 * BasisRow(s, omega, l, 1);
  A.block<1, 4>(row + 1, n - 4) =
      EI * BasisRow(s, omega, l, 3) + w2 * tip.mass_kg * BasisRow(s, omega, l, 0);
  for (Eigen::Index i = 0; i < n; ++i) A.row(i) /= A.row(i).cwiseAbs().maxCoeff();
  return A;
}

}  // namespace flexarm
