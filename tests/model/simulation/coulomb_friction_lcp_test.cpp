#include "model/simulation/coulomb_friction_lcp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace flexarm {
namespace {

struct Case {
  double z11, z12, z22, r1, r2;
  std::array<double, 2> v, F;
  double h;
};

Case RandomCase(std::mt19937* engine) {
  std::normal_distribution<double> normal;
  const auto n = [&] { return normal(*engine); };
  const double a = n(), b = n(), c = n(), d = n();
  Case out{a * a + b * b + 0.01, a * c + b * d, c * c + d * d + 0.01, n(), n(), {}, {}, 5e-4};
  // A third of the hubs at rest, the others slow enough to stop within the step or fast.
  for (std::size_t i = 0; i < 2; ++i) {
    const double size = std::abs(n()) < 0.4 ? 0.0 : std::pow(10.0, -4.0 + n());
    out.v[i] = size * n();
    out.F[i] = std::abs(n()) < 0.2 ? 0.0 : std::abs(n());
  }
  return out;
}

// A quarter of a million cases: the solution must satisfy Coulomb's law (3.12) and the equation of
// motion. 1e-9 is round-off of the reaction; accelerations reach 1e4.
TEST(CoulombFrictionLcp, EverySolutionSatisfiesCoulombsLaw) {
  std::mt19937 engine(1);
  int stuck = 0, forward = 0;
  for (int i = 0; i < 250000; ++i) {
    const Case c = RandomCase(&engine);
    const FrictionSolution s =
        CoulombFrictionLcp(c.z11, c.z12, c.z22, c.r1, c.r2).Solve(c.v, c.F, c.h);
    const double a1 = s.acceleration[0], a2 = s.acceleration[1];
    const double scale = 1.0 + std::abs(a1) + std::abs(a2);
    const std::array<double, 2> lambda = {c.z11 * a1 + c.z12 * a2 - c.r1,
                                          c.z12 * a1 + c.z22 * a2 - c.r2};
    for (std::size_t j = 0; j < 2; ++j) {
      const double rate = c.v[j] + 0.5 * c.h * s.acceleration[j];
      ASSERT_LE(std::abs(lambda[j]), c.F[j] + 1e-9 * scale) << "case " << i;
      if (s.contact[j] == Contact::kStuck) {
        ++stuck;
        ASSERT_LE(std::abs(rate), 1e-15 + 1e-15 * std::abs(c.v[j])) << "case " << i;
      } else {
        ++forward;
        const double side = static_cast<double>(s.contact[j]);
        ASSERT_NEAR(lambda[j], -side * c.F[j], 1e-9 * scale) << "case " << i;
        ASSERT_GE(side * rate, -1e-12 * scale) << "case " << i;
      }
    }
  }
  EXPECT_GT(stuck, 50000);
  EXPECT_GT(forward, 50000);
}

TEST(CoulombFrictionLcp, AHubAtRestBelowTheLimitGetsExactlyNoAcceleration) {
  const FrictionSolution s =
      CoulombFrictionLcp(2.0, 0.5, 1.0, 0.1, -0.05).Solve({0, 0}, {0.16, 0.1}, 1e-3);
  EXPECT_EQ(s.acceleration[0], 0.0);
  EXPECT_EQ(s.acceleration[1], 0.0);
}

}  // namespace
}  // namespace flexarm
