#include "controller/law/tracking_law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/math/dense_decompositions.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr std::array<double, 2> kWide = {1e9, 1e9};  // limits without effect

// A state a few degrees and millimetres away from a moving reference.
struct Sample {
  StateVector x = StateVector::Zero(12);
  ReferenceSample reference{};

  Sample() {
    x << 0.11, 0.08, -0.05, 1e-3, -0.04, 1e-3, 0.5, 0.4, -0.3, 0.01, 0.2, -0.01;
    reference.u_m_nm = {6.6, -0.9};
    const VectorXd moving = (VectorXd(12) << 0.12, 0.09, -0.06, 1.2e-3, -0.05, 1.1e-3, 0.55, 0.35,
                             -0.2, 0.02, 0.1, -0.02)
                                .finished();
    for (Eigen::Index i = 0; i < 12; ++i) {
      reference.x_m[static_cast<std::size_t>(i)] = moving(i);
    }
  }
  VectorXd x_m() const { return Eigen::Map<const VectorXd>(reference.x_m.data(), 12); }
  Vector2d u_m() const { return {reference.u_m_nm[0], reference.u_m_nm[1]}; }
  VectorXd r() const {  // [y_e; x_m; u_m]
    VectorXd all(16);
    all << ShippedDesign().K * (x_m() - VectorXd(x)), x_m(), u_m();
    return all;
  }
};

ControllerConfig Controller() { return ShippedRig().controller; }

TrackingLaw LawWith(const ControllerConfig& config, std::array<double, 2> limit_nm = kWide) {
  return {ShippedDesign(), config, limit_nm};
}

Vector2d Torque(const LawOutput& result) { return {result.torque_nm[0], result.torque_nm[1]}; }

// (7.24) and (7.25) as printed in the thesis, independent of the code.
Vector2d UStar(const Sample& s, const ControllerConfig& config) {
  const Design& d = ShippedDesign();
  const MatrixXd pseudo_inverse = (d.B.transpose() * d.B).inverse() * d.B.transpose();
  const double sign = config.feedforward_sign == FeedforwardSign::kPrinted ? -1.0 : 1.0;
  const Vector2d u_f = pseudo_inverse * (sign * (d.Am - d.A) * s.x_m() + d.Bm * s.u_m());
  const Vector2d u_c = d.S21 * s.x_m() + d.S22 * s.u_m();
  return config.vartheta * u_f + (1.0 - config.vartheta) * u_c;
}

MatrixXd KI0() {
  MatrixXd K_I(2, 16);
  K_I << MatrixXd::Identity(2, 2), ShippedDesign().S21, ShippedDesign().S22;
  return K_I;
}

// The algebraic loop of the thesis, with the torque on both sides: z = F e + G (u* + K_e C_p e - u)
// and u = K_I r + z (r' Tbar r). Returns the residual of the second equation with the first
// inserted.
Vector2d LoopMismatch(const Sample& s, const MatrixXd& K_I, const ControllerConfig& config,
                      const Vector2d& u) {
  const Design& d = ShippedDesign();
  const VectorXd x_star = d.S11 * s.x_m() + d.S12 * s.u_m();
  const VectorXd e = x_star - VectorXd(s.x);
  const Vector2d z = d.K * e + d.G * (UStar(s, config) + d.K * e - u);
  const double rho = config.adaptation_gain * s.r().squaredNorm();
  return K_I * s.r() + rho * z - u;
}

// The residual is round-off times G rho, about 1e2; a loop solved with the previous u has residuals
// of newton metres.
TEST(TrackingLaw, TheTorqueSatisfiesTheAlgebraicLoop) {
  for (const double gain : {1e-4, 0.01, 1.0}) {
    for (const FeedforwardSign sign : {FeedforwardSign::kPrinted, FeedforwardSign::kCorrected}) {
      ControllerConfig config = Controller();
      config.adaptation_gain = gain;
      config.feedforward_sign = sign;
      TrackingLaw law = LawWith(config);
      const Sample s;
      const Vector2d u = Torque(law.Compute(s.x, s.reference, true));
      EXPECT_LT(LoopMismatch(s, KI0(), config, u).cwiseAbs().maxCoeff(), 1e-6) << gain;
    }
  }
}

// The second sample must use K_I <- (1 - sigma)(K_I - K_I0) + K_I0 + v (T r)' of the first, v the z
// of the loop above.
TEST(TrackingLaw, TheGainAdaptsByTheOuterProductAndLeaks) {
  const ControllerConfig config = Controller();
  TrackingLaw law = LawWith(config);
  const Sample s;
  MatrixXd K_I = KI0();
  for (int k = 0; k < 5; ++k) {
    const Vector2d u = Torque(law.Compute(s.x, s.reference, true));
    EXPECT_LT(LoopMismatch(s, K_I, config, u).cwiseAbs().maxCoeff(), 1e-6) << "sample " << k;
    const double rho = config.adaptation_gain * s.r().squaredNorm();
    const Vector2d v = (u - K_I * s.r()) / rho;
    K_I = (1.0 - config.sigma) * (K_I - KI0()) + KI0() +
          config.adaptation_gain * v * s.r().transpose();
    EXPECT_NEAR(law.adaptive_gain_change(), (K_I - KI0()).norm(), 1e-9);
  }
  EXPECT_GT(law.adaptive_gain_change(), 1e-3) << "nothing adapted: the test is inconclusive";
}

// T = Tbar = 0 leaves K_I(0) r, whatever vartheta is: LQR around the command generator's
// trajectory.
TEST(TrackingLaw, WithoutAdaptationGainItIsLqrWithCgt) {
  ControllerConfig none = Controller(), lqr = Controller();
  none.adaptation_gain = 0.0;
  lqr.kind = ControllerKind::kLqrCgt;
  TrackingLaw sobel = LawWith(none), cgt = LawWith(lqr);
  const Sample s;
  const Design& d = ShippedDesign();
  const Vector2d expected = d.K * (s.x_m() - VectorXd(s.x)) + d.S21 * s.x_m() + d.S22 * s.u_m();
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT((Torque(sobel.Compute(s.x, s.reference, true)) - expected).norm(), 1e-10);
    EXPECT_LT((Torque(cgt.Compute(s.x, s.reference, true)) - expected).norm(), 1e-10);
  }
  EXPECT_EQ(cgt.adaptive_gain_change(), 0.0);
}

// u = feedforward + feedback, written out here for each law that does not adapt.
TEST(TrackingLaw, EveryNonAdaptiveLawIsFeedforwardPlusFeedback) {
  const Sample s;
  const Design& d = ShippedDesign();
  ControllerConfig config = Controller();
  config.pd_stiffness_nm_per_rad = {7.0, 3.0};
  config.pd_damping_nms_per_rad = {2.0, 0.5};
  const auto torque = [&](ControllerKind kind) {
    config.kind = kind;
    TrackingLaw law = LawWith(config);
    const Vector2d u = Torque(law.Compute(s.x, s.reference, true));
    EXPECT_EQ(law.adaptive_gain_change(), 0.0);
    return u;
  };
  const VectorXd error = s.x_m() - VectorXd(s.x);
  EXPECT_LT((torque(ControllerKind::kLqrUm) - (s.u_m() + d.K * error)).norm(), 1e-10);

  VectorXd hubs_only = VectorXd::Zero(12);  // the links of the goal are straight and at rest
  hubs_only.head(2) = s.x_m().head(2);
  hubs_only.segment(6, 2) = s.x_m().segment(6, 2);
  EXPECT_LT((torque(ControllerKind::kLqg) - d.K * (hubs_only - VectorXd(s.x))).norm(), 1e-10);

  const Vector2d pd(7.0 * error(0) + 2.0 * error(6), 3.0 * error(1) + 0.5 * error(7));
  for (const ControllerKind kind :
       {ControllerKind::kPd, ControllerKind::kPdZv, ControllerKind::kPdZvd}) {
    EXPECT_LT((torque(kind) - (s.u_m() + pd)).norm(), 1e-10);
  }
}

// Sobel as published is the modified law with vartheta = 0 (and, in the design, alpha = 0).
TEST(TrackingLaw, TheOriginalLawIsTheModifiedOneWithoutVartheta) {
  ControllerConfig original = Controller(), modified = Controller();
  original.kind = ControllerKind::kSobelOriginal;
  modified.vartheta = 0.0;
  TrackingLaw a = LawWith(original), b = LawWith(modified);
  const Sample s;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(Torque(a.Compute(s.x, s.reference, true)), Torque(b.Compute(s.x, s.reference, true)));
  }
  EXPECT_GT(a.adaptive_gain_change(), 0.0);
}

TEST(TrackingLaw, WithAdaptationOffItIsTheSameFeedforwardAndFeedback) {
  ControllerConfig config = Controller();
  config.adaptation = false;
  TrackingLaw law = LawWith(config);
  const Sample s;
  const Vector2d expected = UStar(s, config) + ShippedDesign().K * (s.x_m() - VectorXd(s.x));
  EXPECT_LT((Torque(law.Compute(s.x, s.reference, true)) - expected).norm(), 1e-9);
  EXPECT_EQ(law.adaptive_gain_change(), 0.0);
}

// rho -> infinity: u -> u* + (I + G^-1) C_p e, from v -> 0 in the loop. The remainder falls as 1 /
// rho: at a gain of 1e8 it is 1e-8 of some newton metres.
TEST(TrackingLaw, TheProportionalPartRaisesTheLoopGainUpToOnePlusOneOverG) {
  ControllerConfig config = Controller();
  config.adaptation_gain = 1e8;
  TrackingLaw law = LawWith(config);
  const Sample s;
  const Design& d = ShippedDesign();
  const Vector2d y_e = d.K * (s.x_m() - VectorXd(s.x));
  const Vector2d limit = UStar(s, config) + y_e + d.G.inverse() * y_e;
  const Vector2d u = Torque(law.Compute(s.x, s.reference, false));
  EXPECT_LT((u - limit).norm(), 1e-5 * limit.norm());
}

// At rest on a zero reference r vanishes: only the leakage remains.
TEST(TrackingLaw, TheLeakageReturnsTheGainToItsInitialValue) {
  const ControllerConfig config = Controller();
  TrackingLaw law = LawWith(config);
  const Sample s;
  for (int k = 0; k < 20; ++k) law.Compute(s.x, s.reference, true);
  double before = law.adaptive_gain_change();
  ASSERT_GT(before, 1e-3);
  const StateVector rest = StateVector::Zero(12);
  for (int k = 0; k < 50; ++k) {
    law.Compute(rest, ReferenceSample{}, true);
    EXPECT_NEAR(law.adaptive_gain_change(), (1.0 - config.sigma) * before, 1e-12);
    before = law.adaptive_gain_change();
  }
}

// An error just below the dead zone does not adapt, the leakage continues; one just above it
// adapts.
TEST(TrackingLaw, AnErrorInsideTheDeadZoneDoesNotAdapt) {
  const Sample s;
  const double y_e = s.r().head(2).norm();
  ControllerConfig config = Controller();
  for (const bool inside : {true, false}) {
    config.adaptation_dead_zone_nm = y_e * (inside ? 1.001 : 0.999);
    TrackingLaw law = LawWith(config);
    EXPECT_EQ(law.Compute(s.x, s.reference, true).limits, 0u);
    EXPECT_EQ(law.adaptive_gain_change() == 0.0, inside);
  }
}

// Under a constant error the gain stays on the ball around its initial value, in the direction of
// the update without a bound.
TEST(TrackingLaw, TheGainNeverLeavesItsBound) {
  const Sample s;
  ControllerConfig config = Controller();
  config.sigma = 0.0;
  TrackingLaw free = LawWith(config);
  for (int k = 0; k < 200; ++k) free.Compute(s.x, s.reference, true);
  config.adaptation_bound = 0.3 * free.adaptive_gain_change();
  TrackingLaw bounded = LawWith(config);
  double largest = 0.0;
  for (int k = 0; k < 200; ++k) {
    bounded.Compute(s.x, s.reference, true);
    largest = std::max(largest, bounded.adaptive_gain_change());
  }
  EXPECT_NEAR(largest, config.adaptation_bound, 1e-12)
      << "the bound was not reached, or was exceeded";
}

// Sobel's theorem on the nominal plant, where u_c is the ideal torque: V of (7.11) decreases in
// every sample. T = 1, a hundred times the shipped one, so that the gains contribute to V.
TEST(TrackingLaw, TheLyapunovFunctionFallsOnTheNominalPlant) {
  const Design& d = ShippedDesign();
  ControllerConfig config = Controller();
  config.vartheta = config.sigma = 0.0;
  config.adaptation_gain = 1.0;
  TrackingLaw law = LawWith(config);
  const Vector2d u_m(0.6, -0.1);
  VectorXd x_m = Sample().x_m(), x = Sample().x;
  double before = 0.0, first = 0.0;
  for (int k = 0; k < 200; ++k) {
    ReferenceSample reference{};
    for (Eigen::Index i = 0; i < 12; ++i) reference.x_m[static_cast<std::size_t>(i)] = x_m(i);
    reference.u_m_nm = {u_m(0), u_m(1)};
    const VectorXd e = d.S11 * x_m + d.S12 * u_m - x;
    const double share = law.adaptive_gain_change() * law.adaptive_gain_change();
    const LawOutput result = law.Compute(x, reference, true);
    EXPECT_NEAR(result.lyapunov_nm2, e.dot(d.P * e) + share / config.adaptation_gain,
                1e-9 * (1.0 + result.lyapunov_nm2));
    if (k == 0) first = result.lyapunov_nm2;
    if (k > 0) {
      EXPECT_LT(result.lyapunov_nm2, before) << k;
    }
    before = result.lyapunov_nm2;
    x = d.A * x + d.B * Torque(result);
    x_m = d.Am * x_m + d.Bm * u_m;
  }
  EXPECT_GT(law.adaptive_gain_change(), 1e-3) << "nothing adapted: the test is inconclusive";
  EXPECT_LT(before, 0.2 * first);
}

TEST(TrackingLaw, ALawWithoutTheCommandGeneratorsTrajectoryHasNoLyapunovValue) {
  const Sample s;
  ControllerConfig config = Controller();
  for (const ControllerKind kind :
       {ControllerKind::kLqrCgt, ControllerKind::kSobelOriginal, ControllerKind::kLqrUm,
        ControllerKind::kLqg, ControllerKind::kPd}) {
    config.kind = kind;
    TrackingLaw law = LawWith(config);
    const bool defined = kind == ControllerKind::kLqrCgt || kind == ControllerKind::kSobelOriginal;
    EXPECT_EQ(std::isfinite(law.Compute(s.x, s.reference, true).lyapunov_nm2), defined);
  }
}

TEST(TrackingLaw, AdaptationIsHeldWhileSaturatedOrNotAllowed) {
  const Sample s;
  TrackingLaw saturated = LawWith(Controller(), {0.5, 1e9});
  const LawOutput clipped = saturated.Compute(s.x, s.reference, true);
  EXPECT_EQ(clipped.limits, kLimitTorque1 | kAdaptationHeld);
  EXPECT_EQ(saturated.adaptive_gain_change(), 0.0);

  TrackingLaw forbidden = LawWith(Controller());
  EXPECT_EQ(forbidden.Compute(s.x, s.reference, false).limits, kAdaptationHeld);
  EXPECT_EQ(forbidden.adaptive_gain_change(), 0.0);

  TrackingLaw free = LawWith(Controller());
  EXPECT_EQ(free.Compute(s.x, s.reference, true).limits, 0u);
  EXPECT_GT(free.adaptive_gain_change(), 0.0);
}

TEST(TrackingLaw, TorqueIsClippedToEachLimitWithItsFlag) {
  const Sample s;
  TrackingLaw wide = LawWith(Controller());
  const Vector2d free = Torque(wide.Compute(s.x, s.reference, true));
  for (int i = 0; i < 2; ++i) {
    std::array<double, 2> limit = kWide;
    limit[static_cast<std::size_t>(i)] = 0.5 * std::abs(free(i));
    TrackingLaw narrow = LawWith(Controller(), limit);
    const LawOutput result = narrow.Compute(s.x, s.reference, true);
    EXPECT_EQ(result.limits & (kLimitTorque1 | kLimitTorque2),
              i == 0 ? kLimitTorque1 : kLimitTorque2);
    EXPECT_DOUBLE_EQ(result.torque_nm[static_cast<std::size_t>(i)], 0.5 * free(i));
    EXPECT_DOUBLE_EQ(result.torque_nm[static_cast<std::size_t>(1 - i)], free(1 - i));
  }
}

TEST(TrackingLaw, ResetRestoresTheInitialGains) {
  TrackingLaw law = LawWith(Controller());
  const Sample s;
  const Vector2d first = Torque(law.Compute(s.x, s.reference, true));
  for (int k = 0; k < 5; ++k) law.Compute(s.x, s.reference, true);
  law.Reset();
  EXPECT_EQ(law.adaptive_gain_change(), 0.0);
  EXPECT_EQ(Torque(law.Compute(s.x, s.reference, true)), first);
}

}  // namespace
}  // namespace flexarm
