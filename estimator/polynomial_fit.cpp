#include "estimator/polynomial_fit.h"

#include <cmath>

#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

// Points of the shape along the link in the second least squares: far finer than any wave length.
constexpr int kPoints = 201;

}  // namespace

Eigen::MatrixXd PolynomialModalMap(const LinkModes& link, const std::vector<StrainStation>& station,
                                   int modes) {
  // In s = u / L every term has the size of w: w = sum a_p s^p, w'' = sum p (p - 1) a_p s^(p-2) /
  // L^2.
  const auto stations = static_cast<Eigen::Index>(station.size());
  const double L = link.length_m;
  Eigen::MatrixXd curvature(stations, kPolynomialTerms);
  Eigen::VectorXd root_weight(stations);
  for (Eigen::Index i = 0; i < stations; ++i) {
    const StrainStation& at = station[static_cast<std::size_t>(i)];
    root_weight(i) = std::sqrt(at.weight);
    for (int term = 0; term < kPolynomialTerms; ++term) {
      const int p = term + 2;
      curvature(i, term) = root_weight(i) * at.half_thickness_m * p * (p - 1) *
                           std::pow(at.position_m / L, p - 2) / (L * L);  // start-up
    }
  }
  const Eigen::MatrixXd weights = root_weight.asDiagonal();
  const Eigen::MatrixXd coefficients = curvature.colPivHouseholderQr().solve(weights);

  Eigen::MatrixXd powers(kPoints, kPolynomialTerms), shapes(kPoints, modes);
  for (Eigen::Index i = 0; i < kPoints; ++i) {
    const double s = static_cast<double>(i) / (kPoints - 1);
    for (int term = 0; term < kPolynomialTerms; ++term)
      powers(i, term) = std::pow(s, term + 2);  // start-up
    for (int j = 0; j < modes; ++j) {
      shapes(i, j) = link.mode[static_cast<std::size_t>(j)].Value(s * L);
    }
  }
  const Eigen::MatrixXd deflection = powers * coefficients;
  return shapes.colPivHouseholderQr().solve(deflection);
}

}  // namespace flexarm
