// The closed loop that another program computed: perfect state, no delay, no motor lag, payload
// 0.1 kg, four-mode plant. Bars: 0.02 deg and 0.02 N m at h = 1e-4, 0.25 deg and 0.2 N m at the
// default step (integration error against the converged trace). For scale, from golden.json: one
// sample of delay changes it by 2.3 deg, no friction by 0.66, a two-mode plant by 1.7. Measured,
// with and without friction: 0.003 and 0.007 deg, 0.003 and 0.007 N m at h = 1e-4; 0.11 and 0.17
// deg, 0.10 and 0.15 N m at the default step.

#include <gtest/gtest.h>

#include "controller/law/tracking_law.h"
#include "model/simulation/arm_simulator.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/golden_data.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr int kModes = 4;

StateVector NominalState(const ArmState& arm) {
  StateVector x(12);
  const auto pick = [](const ArmVector& full) {
    Eigen::Matrix<double, 6, 1> part;
    part << full(kTheta1), full(kTheta2), full(kPhi1), full(kPhi1 + 1), full(kPhi1 + kModes),
        full(kPhi1 + kModes + 1);
    return part;
  };
  x.head<6>() = pick(arm.q);
  x.tail<6>() = pick(arm.v);
  return x;
}

struct Difference {
  double angle_deg = 0.0, torque_nm = 0.0;
};

Difference AgainstGolden(double step_s, bool friction) {
  const nlohmann::json golden = GoldenFile("golden.json");
  const std::string name = friction ? "trace" : "trace_nofriction";
  const Eigen::MatrixXd th = AsMatrix(golden[name + "_th"]), u = AsMatrix(golden[name + "_u"]);
  const Eigen::MatrixXd u_m = AsMatrix(golden["u_m"]), x_m = AsMatrix(golden["x_m"]);

  const ArmModel model(ThesisRig(), ModeCount{.link1 = kModes, .link2 = kModes});
  ArmSimulator plant(model, {.coulomb_friction = friction});
  ArmState state(model.dof());
  TrackingLaw law(ShippedDesign(), ShippedRig().controller, {30.0, 6.0});
  const int steps = static_cast<int>(std::lround(0.02 / step_s));
  Difference worst;
  for (int k = 0; k < 300; ++k) {
    ReferenceSample reference{};
    for (int i = 0; i < 12; ++i) reference.x_m[static_cast<std::size_t>(i)] = x_m(k, i);
    reference.u_m_nm = {u_m(k, 0), u_m(k, 1)};
    const LawOutput result = law.Compute(NominalState(state), reference, true);
    EXPECT_EQ(result.limits, 0u) << "the golden trace never saturates";
    for (int i = 0; i < 2; ++i) {
      const double torque = result.torque_nm[static_cast<std::size_t>(i)];
      worst.angle_deg = std::max(worst.angle_deg, std::abs(state.q(i) - th(k, i)) * kDegPerRad);
      worst.torque_nm = std::max(worst.torque_nm, std::abs(torque - u(k, i)));
    }
    const Eigen::Vector2d torque(result.torque_nm[0], result.torque_nm[1]);
    for (int step = 0; step < steps; ++step) plant.Step(state, torque, step_s);
  }
  std::printf("h = %g, friction %d: %.4f deg, %.4f N m\n", step_s, friction, worst.angle_deg,
              worst.torque_nm);
  return worst;
}

TEST(GoldenTrace, AtAFineStepIsReproducedWithFriction) {
  const Difference worst = AgainstGolden(1e-4, true);
  EXPECT_LT(worst.angle_deg, 0.02);
  EXPECT_LT(worst.torque_nm, 0.02);
}

TEST(GoldenTrace, AtAFineStepIsReproducedWithoutFriction) {
  const Difference worst = AgainstGolden(1e-4, false);
  EXPECT_LT(worst.angle_deg, 0.02);
  EXPECT_LT(worst.torque_nm, 0.02);
}

TEST(GoldenTrace, AtTheDefaultStepIsReproducedWithFriction) {
  const Difference worst = AgainstGolden(ArmSimulator::kDefaultStep_s, true);
  EXPECT_LT(worst.angle_deg, 0.25);
  EXPECT_LT(worst.torque_nm, 0.2);
}

TEST(GoldenTrace, AtTheDefaultStepIsReproducedWithoutFriction) {
  const Difference worst = AgainstGolden(ArmSimulator::kDefaultStep_s, false);
  EXPECT_LT(worst.angle_deg, 0.25);
  EXPECT_LT(worst.torque_nm, 0.2);
}

}  // namespace
}  // namespace flexarm
