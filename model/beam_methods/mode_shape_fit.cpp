#include "model/beam_methods/mode_shape_fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "model/beam/beam_basis.h"
#include "model/beam/beam_equations.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

BeamMode::Piece FitSection(const BeamSection& s, double omega, double start,
                           const std::vector<double>& x, const std::vector<double>& w,
                           Eigen::VectorXd* residual) {
  const auto rows = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd basis(rows, 4);
  Eigen::VectorXd value(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto at = static_cast<std::size_t>(i);
    basis.row(i) = BasisRow(s, omega, x[at] - start, 0);
    value[i] = w[at];
  }
  // Krylov's functions start as powers of beta x: columns of one size before the factorisation.
  const Eigen::Vector4d scale = basis.colwise().norm().transpose().cwiseInverse();
  const Eigen::MatrixXd scaled = basis * scale.asDiagonal();
  const Eigen::VectorXd solution = scaled.colPivHouseholderQr().solve(value);
  const Eigen::Vector4d c = scale.cwiseProduct(solution);
  *residual = basis * c - value;
  const double beta = Beta(s, omega);
  const bool decaying = UseDecayingBasis(beta * s.length_m);
  return {start, s.length_m, beta, decaying, {c[0], c[1], c[2], c[3]}};
}

}  // namespace

std::array<double, 4> ModeShapeFit::Coefficients(std::size_t section) const {
  const BeamMode::Piece& p = mode.piece().at(section);
  const std::array<double, 4>& c = p.c;
  if (!p.decaying) {  // S, T, U, V = (cosh + cos)/2, (sinh + sin)/2, (cosh - cos)/2, (sinh - sin)/2
    return {0.5 * (c[1] - c[3]), 0.5 * (c[1] + c[3]), 0.5 * (c[0] - c[2]), 0.5 * (c[0] + c[2])};
  }
  const double end = c[3] * std::exp(-p.beta_per_m * p.length_m);
  return {c[1], end - c[2], c[0], end + c[2]};
}

ModeShapeFit FitModeShape(const std::vector<BeamSection>& section, double frequency_rad_s,
                          const std::vector<double>& x_m, const std::vector<double>& w) {
  if (x_m.size() != w.size()) throw std::invalid_argument("FitModeShape: sizes differ");
  std::vector<BeamMode::Piece> piece;
  double start = 0.0, square = 0.0, largest = 0.0;
  Eigen::Index samples = 0;
  for (std::size_t i = 0; i < section.size(); ++i) {
    const double end = start + section[i].length_m, slack = 1e-9 * section[i].length_m;
    std::vector<double> x_here, w_here;
    for (std::size_t j = 0; j < x_m.size(); ++j) {
      if (x_m[j] < start - slack || x_m[j] > end + slack) continue;
      x_here.push_back(x_m[j]);
      w_here.push_back(w[j]);
    }
    if (x_here.size() < 4) {
      throw std::invalid_argument("FitModeShape: section " + std::to_string(i + 1) +
                                  " has fewer than four samples");
    }
    Eigen::VectorXd residual;
    piece.push_back(FitSection(section[i], frequency_rad_s, start, x_here, w_here, &residual));
    square += residual.squaredNorm();
    samples += residual.size();
    largest = std::max(largest, residual.cwiseAbs().maxCoeff());
    start = end;
  }
  return {BeamMode(frequency_rad_s, std::move(piece)),
          std::sqrt(square / static_cast<double>(samples)), largest};
}

}  // namespace flexarm
