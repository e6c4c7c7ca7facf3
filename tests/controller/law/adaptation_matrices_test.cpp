// The gain matrices of the config: [controller.matrices].

#include "controller/law/adaptation_matrices.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/law/tracking_law.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

constexpr Eigen::Index kEntries = 16;  // of r

// Symmetric, positive, and neither diagonal nor a multiple of I.
Eigen::MatrixXd SomeWeight(double scale) {
  Eigen::MatrixXd T = Eigen::MatrixXd::Constant(kEntries, kEntries, 0.1);
  for (Eigen::Index i = 0; i < kEntries; ++i) T(i, i) += 1.0 + 0.1 * static_cast<double>(i);
  return scale * T;
}

std::vector<double> RowByRow(const Eigen::MatrixXd& matrix) {
  std::vector<double> entries;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) entries.push_back(matrix(i, j));
  }
  return entries;
}

ControllerConfig WithMatrices(const GainMatrixConfig& matrices) {
  ControllerConfig config = ShippedRig().controller;
  config.matrices = matrices;
  return config;
}

// The nominal plant under the law, from a state off the reference.
struct NominalLoop {
  Eigen::VectorXd x_m = Eigen::VectorXd::LinSpaced(12, 0.1, -0.1);
  Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(12, 0.08, -0.05);
  Eigen::Vector2d u_m{0.6, -0.1};

  ReferenceSample Reference() const {
    ReferenceSample reference{};
    for (Eigen::Index i = 0; i < 12; ++i) reference.x_m[static_cast<std::size_t>(i)] = x_m(i);
    reference.u_m_nm = {u_m(0), u_m(1)};
    return reference;
  }
  Eigen::VectorXd Regressor() const {
    Eigen::VectorXd r(kEntries);
    r << ShippedDesign().K * (x_m - x), x_m, u_m;
    return r;
  }
  void Advance(const Eigen::Vector2d& u) {
    const Design& d = ShippedDesign();
    x = d.A * x + d.B * u;
    x_m = d.Am * x_m + d.Bm * u_m;
  }
};

Eigen::Vector2d TorqueOf(const LawOutput& out) { return {out.torque_nm[0], out.torque_nm[1]}; }

TrackingLaw WideLaw(const ControllerConfig& config) {
  return {ShippedDesign(), config, {1e9, 1e9}};
}

TEST(AdaptationMatrices, TheDefaultsWrittenOutChangeNothing) {
  const ControllerConfig plain = ShippedRig().controller;
  const std::vector<double> T(kEntries, plain.adaptation_gain);
  TrackingLaw written =
      WideLaw(WithMatrices({.T = T, .Tbar = T, .S = {1, 1}, .K_e = {1, 0, 0, 1}, .K_I0 = {1}}));
  TrackingLaw law = WideLaw(plain);
  NominalLoop loop;
  for (int k = 0; k < 50; ++k) {
    const Eigen::Vector2d u = TorqueOf(law.Compute(loop.x, loop.Reference(), true));
    const Eigen::Vector2d same = TorqueOf(written.Compute(loop.x, loop.Reference(), true));
    ASSERT_LT((u - same).norm(), 1e-9) << k;
    loop.Advance(u);
  }
}

// (7.13), (7.14) with F = (S'S)^-1 C_p, written out here; K_I follows the recursion.
TEST(AdaptationMatrices, TheTorqueSatisfiesTheEquationsOfTheThesis) {
  const Eigen::MatrixXd T = SomeWeight(0.02), Tbar = SomeWeight(0.03);
  const Eigen::Matrix2d S = (Eigen::Matrix2d() << 1.5, 0.2, -0.1, 1.2).finished();
  const Eigen::Matrix2d K_e = (Eigen::Matrix2d() << 0.9, 0.1, 0.0, 1.1).finished();
  ControllerConfig config = WithMatrices({.T = RowByRow(T),
                                          .Tbar = RowByRow(Tbar),
                                          .S = RowByRow(S),
                                          .K_e = RowByRow(K_e),
                                          .K_I0 = {0.8}});
  config.vartheta = 0.0;
  config.adaptation_bound = 1e6;
  const Design& d = ShippedDesign();
  TrackingLaw law = WideLaw(config);
  Eigen::MatrixXd K_I0(2, kEntries);
  K_I0 << K_e, d.S21, d.S22;
  K_I0 *= 0.8;
  Eigen::MatrixXd K_I = K_I0;
  NominalLoop loop;
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd r = loop.Regressor();
    const Eigen::Vector2d u = TorqueOf(law.Compute(loop.x, loop.Reference(), true));
    const Eigen::VectorXd e = d.S11 * loop.x_m + d.S12 * loop.u_m - loop.x;
    const Eigen::Vector2d z = d.S21 * loop.x_m + d.S22 * loop.u_m - u + K_e * d.K * e;
    const Eigen::Vector2d v = (S.transpose() * S).inverse() * d.K * e + d.G * z;
    EXPECT_LT((u - K_I * r - v * r.dot(Tbar * r)).norm(), 1e-6) << k;
    K_I = (1.0 - config.sigma) * (K_I - K_I0) + K_I0 + v * (T * r).transpose();
    loop.Advance(u);
  }
  EXPECT_NEAR(law.adaptive_gain_change(), (K_I - K_I0).norm(), 1e-9);
}

// Appendix E with general T, Tbar and S: V of (7.11) decreases in every sample.
TEST(AdaptationMatrices, TheLyapunovFunctionFallsOnTheNominalPlant) {
  ControllerConfig config = WithMatrices({.T = RowByRow(SomeWeight(0.5)),
                                          .Tbar = RowByRow(SomeWeight(0.3)),
                                          .S = {1.5, 0.2, -0.1, 1.2},
                                          .K_e = {},
                                          .K_I0 = {0.9}});
  config.vartheta = config.sigma = 0.0;
  config.adaptation_bound = 1e6;
  TrackingLaw law = WideLaw(config);
  NominalLoop loop;
  double before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 200; ++k) {
    const LawOutput result = law.Compute(loop.x, loop.Reference(), true);
    EXPECT_LT(result.lyapunov_nm2, before) << k;
    before = result.lyapunov_nm2;
    loop.Advance(TorqueOf(result));
  }
  EXPECT_GT(law.adaptive_gain_change(), 1e-3);
}

std::string FirstFailed(const std::vector<std::string>& overrides) {
  for (const DesignCheck& check : DesignController(ShippedRig(overrides)).checks) {
    if (!check.passed()) return check.name;
  }
  return "";
}

TEST(AdaptationMatrices, AreRefusedByNameOutsideTheConditionsOfAppendixE) {
  EXPECT_EQ(FirstFailed({"controller.matrices.S=[1.0,1.0]"}), "");
  EXPECT_EQ(FirstFailed({"controller.matrices.S=[0.2,0.2]"}), "ssg-minus-j-min-eigenvalue");
  EXPECT_EQ(FirstFailed({"controller.matrices.K_e=[-1.0,-1.0]"}), "ke-spectral-radius");
  EXPECT_EQ(FirstFailed({"controller.matrices.T=[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1]"}),
            "2tbar-minus-t-min-eigenvalue");
  EXPECT_EQ(FirstFailed({"controller.matrices.T=[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,-1]"}),
            "t-min-eigenvalue");
}

TEST(AdaptationMatrices, OfTheWrongSizeAreRefused) {
  EXPECT_THROW(ShippedRig({"controller.matrices.T=[1.0,1.0]"}), ConfigError);
  EXPECT_THROW(ShippedRig({"controller.matrices.K_I0=[1.0,1.0]"}), ConfigError);
}

}  // namespace
}  // namespace flexarm
