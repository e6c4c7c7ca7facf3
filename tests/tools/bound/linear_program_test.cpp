#include "tools/bound/linear_program.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

// The method stops at a mean product of slack and multiplier of 1e-9: vertices are hit to 1e-6.
constexpr double kTolerance = 1e-6;

LinearProgram Box(const Eigen::Vector2d& cost) {
  return {.cost = cost,
          .rows = Eigen::MatrixXd::Zero(0, 2),
          .limit = Eigen::VectorXd(0),
          .low = Eigen::Vector2d(-1.0, -2.0),
          .high = Eigen::Vector2d(3.0, 4.0)};
}

TEST(LinearProgram, WithoutRowsEndsInACornerOfTheBox) {
  const auto x = SolveLinearProgram(Box({1.0, -1.0}));
  ASSERT_TRUE(x.has_value());
  EXPECT_NEAR((*x)[0], -1.0, kTolerance);
  EXPECT_NEAR((*x)[1], 4.0, kTolerance);
}

// Textbook: most of 3 x + 5 y with x <= 4, 2 y <= 12, 3 x + 2 y <= 18 is 36 at (2, 6).
TEST(LinearProgram, FindsTheVertexOfATextbookExample) {
  LinearProgram program{.cost = Eigen::Vector2d(-3.0, -5.0),
                        .rows = Eigen::MatrixXd(3, 2),
                        .limit = Eigen::Vector3d(4.0, 12.0, 18.0),
                        .low = Eigen::Vector2d(0.0, 0.0),
                        .high = Eigen::Vector2d(100.0, 100.0)};
  program.rows << 1.0, 0.0, 0.0, 2.0, 3.0, 2.0;
  const auto x = SolveLinearProgram(program);
  ASSERT_TRUE(x.has_value());
  EXPECT_NEAR((*x)[0], 2.0, kTolerance);
  EXPECT_NEAR((*x)[1], 6.0, kTolerance);
}

TEST(LinearProgram, HasNoAnswerWhereNoPointKeepsTheRows) {
  LinearProgram program = Box({1.0, 1.0});
  program.rows = Eigen::MatrixXd::Zero(1, 2);
  program.rows(0, 0) = 1.0;
  program.limit = Eigen::VectorXd::Constant(1, -2.0);  // x <= -2 against x >= -1
  EXPECT_FALSE(SolveLinearProgram(program).has_value());
}

}  // namespace
}  // namespace flexarm
