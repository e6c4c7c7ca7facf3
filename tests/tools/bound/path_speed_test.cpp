#include "tools/bound/path_speed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace flexarm {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kStep = 1e-3;  // of the path, which is 1 long
constexpr int kPieces = 1000;

std::vector<PathPiece> Path(const std::function<PathPiece(double s)>& at) {
  std::vector<PathPiece> pieces;
  for (int k = 0; k < kPieces; ++k) pieces.push_back(at((k + 0.5) * kStep));
  return pieces;
}

double Time_s(const std::vector<PathPiece>& pieces, const std::array<double, 2>& torque_nm) {
  return TimesOver(FastestSquaredSpeeds(pieces, kStep, torque_nm), kStep).back();
}

// One mass, which the first joint moves.
PathPiece DoubleIntegrator(double mass, double largest_speed = kInfinite) {
  return {
      .a = {mass, 0.0}, .b = {0.0, 0.0}, .largest_speed_squared = largest_speed * largest_speed};
}

TEST(FastestSquaredSpeeds, AccelerateAndBrakeADoubleIntegratorWithAllTorque) {
  const auto path = Path([](double) { return DoubleIntegrator(2.0); });
  // T = 2 sqrt(m / F), exact on the grid but for the round-off of 1000 sums.
  EXPECT_NEAR(Time_s(path, {8.0, 1.0}), 2.0 * std::sqrt(2.0 / 8.0), 1e-11);
  const std::vector<double> z = FastestSquaredSpeeds(path, kStep, {8.0, 1.0});
  EXPECT_EQ(z.front(), 0.0);
  EXPECT_EQ(z.back(), 0.0);
  EXPECT_NEAR(z[500], 2.0 * (8.0 / 2.0) * 0.5, 1e-11);  // v^2 = 2 a s in the middle
}

TEST(FastestSquaredSpeeds, KeepASpeedLimit) {
  const auto path = Path([](double) { return DoubleIntegrator(2.0, 1.5); });
  // T = D / v + v / a. The limit is reached between two pieces of the grid: 1e-3 of the path of
  // 0.28 in which it accelerates, and a part of it at the wrong speed by less than its square.
  EXPECT_NEAR(Time_s(path, {8.0, 1.0}), 1.0 / 1.5 + 1.5 / 4.0, 1e-5);
}

TEST(FastestSquaredSpeeds, ObeyTheWeakerOfTwoJoints) {
  const auto path = Path([](double) {
    return PathPiece{.a = {2.0, -3.0}, .b = {0.0, 0.0}, .largest_speed_squared = kInfinite};
  });
  EXPECT_NEAR(Time_s(path, {100.0, 6.0}), 2.0 * std::sqrt(3.0 / 6.0), 1e-11);
}

TEST(FastestSquaredSpeeds, BrakeBeforeASlowPart) {
  const auto path =
      Path([](double s) { return DoubleIntegrator(1.0, s > 0.4 && s < 0.6 ? 0.2 : kInfinite); });
  const std::vector<double> z = FastestSquaredSpeeds(path, kStep, {1.0, 1.0});
  for (int k = 0; k < kPieces; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double acceleration = (z[i + 1] - z[i]) / (2.0 * kStep);
    EXPECT_LE(std::fabs(acceleration), 1.0 + 1e-9) << k;
    if (k > 401 && k < 599) {
      EXPECT_LE(z[i], 0.04 + 1e-12) << k;
    }
  }
}

// A joint that only bears the centrifugal torque b z, however the path accelerates.
TEST(FastestSquaredSpeeds, LimitTheTorqueOfVelocityWhereNoAccelerationHelps) {
  const auto path = Path([](double) {
    return PathPiece{.a = {1.0, 0.0}, .b = {0.0, -4.0}, .largest_speed_squared = kInfinite};
  });
  // z <= 1 / 4: as a speed limit of 0.5; the tolerance as in KeepASpeedLimit.
  EXPECT_NEAR(Time_s(path, {1.0, 1.0}), 1.0 / 0.5 + 0.5 / 1.0, 1e-4);
}

// u = m s'' + b s'^2 with a constant b has dz/ds = 2 (u - b z) / m: z = (u / b) (1 - e^(-2 b s /
// m)) while it accelerates, and backwards from the end with -b while it brakes.
TEST(FastestSquaredSpeeds, FollowTheClosedFormWithTorqueOfVelocity) {
  const double b = 0.5;
  const auto path = Path([b](double) {
    return PathPiece{.a = {1.0, 0.0}, .b = {b, 0.0}, .largest_speed_squared = kInfinite};
  });
  const std::vector<double> z = FastestSquaredSpeeds(path, kStep, {1.0, 1.0});
  const auto faster = [b](double s) { return 2.0 * (1.0 - std::exp(-2.0 * b * s)); };
  const auto slower = [b](double s) { return 2.0 * (std::exp(2.0 * b * (1.0 - s)) - 1.0); };
  for (int k = 0; k < kPieces; k += 50) {
    const double s = k * kStep;
    // Midpoint steps: the error is of the order of (b ds)^2 = 2.5e-7, times z of 1.3 at most.
    EXPECT_NEAR(z[static_cast<std::size_t>(k)], std::min(faster(s), slower(s)), 1e-6) << s;
  }
}

}  // namespace
}  // namespace flexarm
