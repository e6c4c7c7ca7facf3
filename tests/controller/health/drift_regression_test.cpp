#include "controller/health/drift_regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace flexarm {
namespace {

DriftRegression::Settings Plain(std::size_t parameters) {
  return {.prior = std::vector<double>(parameters, 10.0), .family = {}, .block_samples = 20};
}

TEST(DriftRegression, FindsWhatMadeTheResiduals) {
  DriftRegression regression(Plain(3));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d truth(0.5, -1.0, 0.0);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(1, 3, [&] { return normal(random); });
    regression.Add(x, x * truth + Eigen::VectorXd::Constant(1, normal(random)));
    regression.EndSample();
  }
  const std::vector<DriftFigure> found = regression.Solve();
  for (std::size_t i = 0; i < 3; ++i) {
    // White noise of 1 in 2000 samples; the scatter of 64 blocks knows it to 10 %.
    EXPECT_NEAR(found[i].standard_error, 1.0 / std::sqrt(2000.0), 0.006);
    EXPECT_NEAR(found[i].value, truth(static_cast<Eigen::Index>(i)), 4.0 * found[i].standard_error);
  }
  EXPECT_NEAR(regression.Misfit(), 1.0, 0.1);
}

// An error that lasts for a block counts once, not once a sample.
TEST(DriftRegression, ErrorsThatLastAreNotAveragedAway) {
  DriftRegression regression(Plain(1));
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (int block = 0; block < 50; ++block) {
    const double error = normal(random);
    for (int i = 0; i < 20; ++i) {
      regression.Add(Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Constant(1, error));
      regression.EndSample();
    }
  }
  EXPECT_NEAR(regression.Solve()[0].standard_error, 1.0 / std::sqrt(50.0), 0.03);
}

TEST(DriftRegression, WhatARunDoesNotTellKeepsItsPrior) {
  DriftRegression regression(Plain(2));
  for (int i = 0; i < 100; ++i) {
    regression.Add(Eigen::RowVector2d(1.0, 0.0), Eigen::VectorXd::Constant(1, 3.0));
    regression.EndSample();
  }
  const std::vector<DriftFigure> found = regression.Solve();
  EXPECT_NEAR(found[0].value, 3.0, 0.01);
  EXPECT_DOUBLE_EQ(found[1].value, 0.0);
  EXPECT_DOUBLE_EQ(found[1].standard_error, 10.0);
}

// Parameters 0 to 3: gains of four gauges; 4: the stiffness of their link, which all of them read.
TEST(DriftRegression, ASingleGaugeIsNotMistakenForItsLink) {
  DriftRegression::Settings settings = Plain(5);
  settings.family = {{0, 1, 2, 3}};
  for (const bool single : {true, false}) {
    DriftRegression regression(settings);
    for (int i = 0; i < 400; ++i) {
      const double bent = std::sin(0.1 * i);
      Eigen::MatrixXd x = Eigen::MatrixXd::Zero(4, 5);
      x.diagonal().setConstant(bent);
      x.col(4).setConstant(-bent);
      Eigen::VectorXd residual = Eigen::VectorXd::Zero(4);
      if (single) residual(2) = 0.1 * bent;
      if (!single) residual.setConstant(-0.1 * bent);
      regression.Add(100.0 * x, 100.0 * residual);
      regression.EndSample();
    }
    const std::vector<DriftFigure> found = regression.Solve();
    EXPECT_NEAR(found[2].value, single ? 0.1 : 0.0, 1e-3);
    EXPECT_NEAR(found[0].value, 0.0, 1e-3);
    EXPECT_NEAR(found[4].value, single ? 0.0 : 0.1, 1e-3);
  }
}

TEST(DriftRegression, ALongRunGivesTheSameFigures) {
  DriftRegression regression(Plain(1));
  for (int i = 0; i < 20'000; ++i) {
    regression.Add(Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Constant(1, 2.0));
    regression.EndSample();
  }
  EXPECT_NEAR(regression.Solve()[0].value, 2.0, 1e-3);
}

}  // namespace
}  // namespace flexarm
