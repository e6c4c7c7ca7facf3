#include "estimator/polynomial_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

std::vector<StrainStation> Stations(double length_m, int count) {
  std::vector<StrainStation> stations;
  for (int i = 0; i < count; ++i) {
    stations.push_back({.position_m = (i + 0.5) * length_m / count,
                        .half_thickness_m = 1e-3,
                        .weight = i % 2 == 0 ? 1.0 : 4.0});
  }
  return stations;
}

// A shape that is a polynomial: w = 3 u^2 - u^4. Its strains are known, and so is the result of the
// least squares over the link: the normal equations, by an independent sum over points.
TEST(PolynomialFit, APolynomialShapeIsProjectedOntoTheModesExactly) {
  const LinkModes link = Link2Modes(ThesisRig(), 2);
  const double L = link.length_m;
  for (const int count : {5, 10}) {
    const std::vector<StrainStation> stations = Stations(L, count);
    Eigen::VectorXd strain(count);
    for (int i = 0; i < count; ++i) {
      const double u = stations[static_cast<std::size_t>(i)].position_m;
      strain(i) = 1e-3 * (6.0 - 12.0 * u * u);
    }
    const Eigen::Vector2d f = PolynomialModalMap(link, stations, 2) * strain;

    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (int i = 0; i <= 200; ++i) {
      const double u = i * L / 200.0;
      const Eigen::Vector2d psi(link.mode[0].Value(u), link.mode[1].Value(u));
      normal += psi * psi.transpose();
      right += psi * (3.0 * u * u - u * u * u * u);
    }
    EXPECT_LT((f - normal.inverse() * right).norm(), 1e-9 * f.norm()) << count;
  }
}

}  // namespace
}  // namespace flexarm
