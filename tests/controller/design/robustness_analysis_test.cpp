#include "controller/design/robustness_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "controller/design/design_at_payload.h"
#include "controller/design/design_controller.h"
#include "controller/law/tracking_law.h"
#include "estimator/state_estimator.h"
#include "hal/gauge_filter.h"
#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"
#include "model/simulation/arm_simulator.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using testing::Contains;
using testing::Field;

/// Time-domain loop: the nonlinear arm without friction, a thousandth of a degree from rest, with
/// the parts of the real law. Independent of the robustness analysis.
class LoopInTime {
 public:
  LoopInTime(const RigConfig& config, Design design, double payload_kg, double theta2_rad,
             double gain, double delay_s = 0.0)
      : config_(config),
        design_(std::move(design)),
        model_(Frictionless(config.arm, payload_kg)),
        simulator_(model_),
        state_(model_.dof()),
        theta2_rad_(theta2_rad),
        late_steps_(static_cast<int>(std::lround(delay_s / kStep_s))),
        estimator_(config.estimator,
                   {.layout = design_.layout,
                    .A = design_.filter_A,
                    .B = design_.filter_B,
                    .C = design_.filter_C,
                    .L = design_.filter_L,
                    .A_rate = design_.filter_A_rate,
                    .B_rate = design_.filter_B_rate,
                    .W = design_.filter_W,
                    .P = design_.filter_P,
                    .R = design_.filter_R},
                   config.loop.period_s(), Stiffness()),
        filter_(config.sensors.strain_input, kStep_s, 20),
        fit_(Fit(config)) {
    gain_ = gain * FeedbackGain(design_, config.controller);
    state_.q(1) = state_.q(3) = theta2_rad_;
    state_.q(0) = state_.q(2) = 2e-5;
    filter_.Settle(GaugeFilter::Signals::Zero(20));
  }

  // |x_hat| after `periods` periods.
  double Run(int periods) {
    const auto steps = static_cast<int>(std::lround(config_.loop.period_s() / kStep_s));
    double size = 0.0;
    for (int k = 0; k < periods; ++k) {
      const StateVector x = estimator_.Update(Counters(), Modes(), {before_(0), before_(1)}).x;
      const Eigen::VectorXd next = design_.A * x + design_.B * now_;
      before_ = now_;
      for (int i = 0; i < steps; ++i) {  // the torque of the plant is late by late_steps_
        pipeline_.push_back(before_);
        const auto due = static_cast<std::ptrdiff_t>(pipeline_.size()) - 1 - late_steps_;
        Step(due < 0 ? Eigen::Vector2d(Eigen::Vector2d::Zero())
                     : pipeline_[static_cast<std::size_t>(due)]);
      }
      now_ = -gain_ * next;
      size = x.norm();
    }
    return size;
  }

 private:
  static constexpr double kStep_s = 2e-4;

  static ArmModel Frictionless(ArmParameters arm, double payload_kg) {
    arm.payload_mass_kg = payload_kg;
    for (JointParameters& joint : arm.joint) joint.coulomb_friction_nm = 0.0;
    return ArmModel(arm, ModeCount{.link1 = 4, .link2 = 4});
  }
  std::array<double, 2> Stiffness() const {
    return {config_.arm.joint[0].stiffness_nm_per_rad, config_.arm.joint[1].stiffness_nm_per_rad};
  }
  void Step(const Eigen::Vector2d& torque_nm) {
    simulator_.Step(state_, torque_nm, kStep_s);
    GaugeFilter::Signals strain(20);
    for (Eigen::Index i = 0; i < 20; ++i) {
      const StrainChannelConfig& row = config_.sensors.strain[static_cast<std::size_t>(i)];
      strain(i) = model_.Strain(row.link, row.position_m, state_.q);
    }
    filter_.Step(strain);
  }
  DecodedCounters Counters() const {
    DecodedCounters counters{};
    for (std::size_t i = 0; i < 4; ++i) {
      counters.angle_rad[i] =
          state_.q(static_cast<Eigen::Index>(i)) - (i % 2 == 1 ? theta2_rad_ : 0);
    }
    counters.good = 0b1111;
    return counters;
  }
  // The loop's own fit is quantised in counts of the converter: this one is exact.
  static Eigen::MatrixXd Fit(const RigConfig& config) {
    const ArmModel known(config.arm, ModeCount{.link1 = 2, .link2 = 2});
    Eigen::MatrixXd shape(20, 4);
    for (Eigen::Index j = 0; j < 4; ++j) {
      for (Eigen::Index i = 0; i < 20; ++i) {
        const StrainChannelConfig& row = config.sensors.strain[static_cast<std::size_t>(i)];
        shape(i, j) = known.Strain(row.link, row.position_m, Eigen::VectorXd::Unit(8, 4 + j));
      }
    }
    return (shape.transpose() * shape).llt().solve(shape.transpose());
  }
  FittedModes Modes() const {
    const Eigen::Vector4d f = fit_ * Eigen::VectorXd(filter_.output());
    FittedModes modes{};
    for (std::size_t i = 0; i < 4; ++i) modes.modal_m[i] = f(static_cast<Eigen::Index>(i));
    modes.valid = {true, true};
    return modes;
  }

  const RigConfig& config_;
  Design design_;
  ArmModel model_;
  ArmSimulator simulator_;
  ArmState state_;
  double theta2_rad_;
  int late_steps_;
  std::vector<Eigen::Vector2d> pipeline_;
  StateEstimator estimator_;
  GaugeFilter filter_;
  Eigen::MatrixXd fit_, gain_;
  Eigen::Vector2d now_ = Eigen::Vector2d::Zero(), before_ = Eigen::Vector2d::Zero();
};

// Independent check: the growth rate of the time-domain loop is its largest |eigenvalue|. The mean
// over many periods hides the phase of the oscillation: ln(2) / 250 periods at most, 0.3 %.
TEST(RobustnessAnalysis, TheSpectralRadiusIsTheGrowthRateInTheTimeDomain) {
  const RigConfig config = ShippedRig({"controller.name=lqr-cgt"});
  const Design& design = ShippedDesign();
  const RobustnessAnalysis robustness = AnalyzeRobustness(config, design, {0.0, 1.0});
  struct Case {
    double payload_kg, theta2_deg, gain;
  };
  for (const Case c : {Case{0.0, 90.0, 1.4}, {0.0, 45.0, 1.4}, {1.0, 0.0, 0.7}, {1.0, 90.0, 1.0}}) {
    const auto found = std::find_if(
        robustness.cases.begin(), robustness.cases.end(), [&c](const RobustnessCase& s) {
          return s.payload_kg == c.payload_kg && s.theta2_deg == c.theta2_deg && s.gain == c.gain;
        });
    ASSERT_NE(found, robustness.cases.end());
    LoopInTime loop(config, design, c.payload_kg, c.theta2_deg * std::numbers::pi / 180.0, c.gain);
    const double early = loop.Run(150), late = loop.Run(250);
    EXPECT_NEAR(std::pow(late / early, 1.0 / 250.0), found->spectral_radius, 0.003)
        << c.payload_kg << " kg, " << c.theta2_deg << " deg, x " << c.gain;
  }
}

TEST(RobustnessAnalysis, TheShippedGainsAreStableInEveryRequiredCase) {
  const RobustnessAnalysis robustness =
      AnalyzeRobustness(ShippedRig(), ShippedDesign(), {0.0, 0.01, 0.2, 0.5, 1.0});
  EXPECT_EQ(robustness.cases.size(), 54u) << "five payloads and the design's own";
  EXPECT_LT(robustness.worst_required().spectral_radius, 1.0);
  for (const DesignCheck& check : ChecksOf(robustness)) {
    EXPECT_TRUE(check.passed()) << check.name << " " << check.value;
  }
  // The worst case is reported and not required: no payload, elbow at 90 deg, gains x 1.4.
  EXPECT_EQ(robustness.worst().payload_kg, 0.0);
  EXPECT_EQ(robustness.worst().theta2_deg, 90.0);
  EXPECT_EQ(robustness.worst().gain, 1.4);
  EXPECT_NEAR(robustness.worst().spectral_radius, 1.020, 0.001);
}

// In the design study's runs of the whole loop 0.01 kg diverges without prediction, and every run
// diverges with alpha = 3 and differences behind the gauge filter.
TEST(RobustnessAnalysis, TheDivergingLoopsOfTheStudyAreUnstable) {
  for (const char* change : {"controller.prediction=false", "estimator.name=difference"}) {
    const RigConfig config = ShippedRig({change});
    const RobustnessAnalysis robustness =
        AnalyzeRobustness(config, DesignController(config), {0.01});
    EXPECT_GT(robustness.worst_required().spectral_radius, 1.0) << change;
    EXPECT_THAT(ChecksOf(robustness),
                Contains(Field(&DesignCheck::name, "robustness-spectral-radius")));
    EXPECT_FALSE(ChecksOf(robustness)[0].passed()) << change;
  }
}

// With the gains at its margin the loop neither grows nor decays.
TEST(RobustnessAnalysis, AtTheGainMarginTheLoopIsOnTheStabilityBoundary) {
  const RigConfig config = ShippedRig();
  const LoopMargins margins = AnalyzeRobustness(config, ShippedDesign(), {}).margins;
  Design scaled = ShippedDesign();
  scaled.K *= margins.gain_up;
  EXPECT_NEAR(AnalyzeRobustness(config, scaled, {}).cases[0].spectral_radius, 1.0, 1e-3);
}

// Undeclared delay, 0.3 ms to either side of the margin: with time steps of 0.2 ms the nearest
// delays that are certainly beyond and certainly within.
TEST(RobustnessAnalysis, TheDelayMarginIsThatOfTheTimeDomainLoop) {
  const RigConfig config = ShippedRig();
  const double margin_s = AnalyzeRobustness(config, ShippedDesign(), {}).margins.delay_s;
  const auto growth = [&config](double delay_s) {
    LoopInTime loop(config, ShippedDesign(), config.arm.payload_mass_kg, 0.0, 1.0, delay_s);
    const double early = loop.Run(1500);
    return std::pow(loop.Run(1500) / early, 1.0 / 1500.0);
  };
  EXPECT_LT(growth(margin_s - 0.0003), 1.0);
  EXPECT_GT(growth(margin_s + 0.0003), 1.0);
}

// The same where the margin is longer than five periods of the loop, more of which the analysis
// once could not represent. Measured: 99.4 ms at a period of 10 ms.
TEST(RobustnessAnalysis, ADelayMarginOfManyPeriodsIsThatOfTheTimeDomainLoop) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/thesis-rig-printed.toml",
                                      {"loop.period_ms=10", "loop.acquire_before_ms=2",
                                       "loop.step_deadline_ms=2", "controller.name=lqr-cgt"});
  const Design design = DesignController(config);
  const double margin_s = AnalyzeRobustness(config, design, {}).margins.delay_s;
  ASSERT_GT(margin_s, 5.0 * config.loop.period_s());
  ASSERT_LT(margin_s, 0.1) << "the end of the search is no margin";
  const auto growth = [&](double delay_s) {
    LoopInTime loop(config, design, config.arm.payload_mass_kg, 0.0, 1.0, delay_s);
    const double early = loop.Run(1500);
    return std::pow(loop.Run(1500) / early, 1.0 / 1500.0);
  };
  EXPECT_LT(growth(margin_s - 0.002), 1.0);
  EXPECT_GT(growth(margin_s + 0.002), 1.0);
}

// A torque that acts a microsecond before or after a sampling instant is another case in the
// analysis, but the same loop: radius and margin are continuous. A loop with a longer prediction
// tolerates less additional delay. Measured: 27.2, 27.3 and 27.3 ms, with 20 ms declared 9.1 ms.
TEST(RobustnessAnalysis, TheMarginsAreContinuousWhereTheDelayPassesAWholePeriod) {
  const auto with = [](double late_ms) {
    RigConfig config = ShippedRig();
    config.loop.output = late_ms < 0.0 ? OutputTiming::kAtOnce : OutputTiming::kNextTick;
    config.loop.output_after_ms = config.loop.period_ms + late_ms;
    config.loop.actuation_delay_ms = std::max(late_ms, 0.0);
    const RobustnessAnalysis robustness = AnalyzeRobustness(config, ShippedDesign(), {});
    return std::pair(robustness.worst_required().spectral_radius, robustness.margins.delay_s);
  };
  constexpr double kShort_ms = 1e-3;
  const auto own = with(0.0), before = with(-kShort_ms), after = with(kShort_ms);
  for (const auto& near : {before, after}) {
    EXPECT_NEAR(own.first, near.first, 1e-3);
    EXPECT_NEAR(own.second, near.second, 2e-2 * own.second);  // the boundary is found to 1 %
  }
  EXPECT_LT(with(20.0).second, own.second);
}

// At the design's own payload and a straight elbow the model of the scheduled law is the nominal
// one: both are reduced from the same arm.
TEST(DesignAtPayload, IsTheNominalModelForThePayloadOfTheDesign) {
  const RigConfig config = ShippedRig({"controller.name=gain-scheduled"});
  const Design design = DesignController(config);
  const Design own = DesignAtPayload(config, design, config.arm.payload_mass_kg, 0.0);
  EXPECT_LT((own.A - design.A).norm(), 1e-9 * design.A.norm());
  EXPECT_LT((own.B - design.B).norm(), 1e-9 * design.B.norm());
  const Design heavy = DesignAtPayload(config, design, 1.0, 0.0);
  EXPECT_GT((heavy.B - design.B).norm(), 5e-3 * design.B.norm());
}

// A law that follows the payload is judged with the gains of each payload: with those of 0.1 kg
// alone the loop of the same config is nearer to its limit.
TEST(RobustnessAnalysis, JudgesAScheduledLawWithTheGainsOfEachPayload) {
  const RigConfig config = ShippedRig({"controller.name=gain-scheduled"});
  Design design = DesignController(config);
  const double scheduled =
      AnalyzeRobustness(config, design, {0.0, 1.0}).worst_required().spectral_radius;
  design.scheduled.reset();
  const double fixed =
      AnalyzeRobustness(config, design, {0.0, 1.0}).worst_required().spectral_radius;
  EXPECT_LT(scheduled, fixed - 0.01) << "0.949 and 0.990 measured";
}

}  // namespace
}  // namespace flexarm
