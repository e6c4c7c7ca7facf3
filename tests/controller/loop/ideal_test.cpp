// The loop with known state and without delay (estimator.name = "ideal"): equal to the closed loop
// that another program computed, and to be had in a simulation only.

#include <gtest/gtest.h>

#include "controller/tasks/simulated_stack.h"
#include "controller/types/rejected_error.h"
#include "model/units.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/support/golden_data.h"

namespace flexarm {
namespace {

const std::vector<std::string> kIdeal = {"estimator.name=ideal"};

// Rms of the angles of golden.json against its reference, deg.
std::array<double, 2> GoldenRms_deg() {
  const nlohmann::json golden = GoldenFile("golden.json");
  const Eigen::MatrixXd th = AsMatrix(golden["trace_th"]), x_m = AsMatrix(golden["x_m"]);
  std::array<double, 2> rms{};
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    const Eigen::VectorXd error = th.col(joint).head(300) - x_m.col(joint).head(300);
    rms[static_cast<std::size_t>(joint)] = kDegPerRad * std::sqrt(error.squaredNorm() / 300.0);
  }
  return rms;
}

TEST(Ideal, EqualsTheClosedLoopOfAnotherProgram) {
  const RunMetrics m =
      flexarm::Run(0.1, 1, {kIdeal.front(), "sim.motor_lag_ms=[0.0,0.0]", "sim.step_ms=0.1"})
          .metrics;
  const std::array<double, 2> golden = GoldenRms_deg();
  EXPECT_NEAR(m.joint_rms_error_deg[0], golden[0], 0.005);
  EXPECT_NEAR(m.joint_rms_error_deg[1], golden[1], 0.005);
}

TEST(Ideal, DoesNotDependOnNoiseDelayOrLostFrames) {
  const RunMetrics one = flexarm::Run(0.1, 1, kIdeal).metrics;
  const RunMetrics other =
      flexarm::Run(0.1, 2,
                   {kIdeal.front(), "sim.transport_delay_ms=5", "sim.lost_frame_fraction=0.1",
                    "controller.prediction=false"})
          .metrics;
  EXPECT_EQ(one.joint_rms_error_deg, other.joint_rms_error_deg);
}

TEST(Ideal, EndsWithTheFaultOfTheStep) {
  const SimulationResult result =
      flexarm::Run(0.5, 1, {kIdeal.front(), "limits.soft_angle_deg=[31.0,31.0]"});
  EXPECT_FALSE(result.completed);
  EXPECT_EQ(result.trip, TripCause::kSoftLimit2);
}

TEST(Ideal, IsRefusedByEveryLoopOfTasks) {
  const RigConfig config = ShippedRig(kIdeal);
  EXPECT_THROW(SimulatedStack(config, ShippedDesign(), 0.1), RejectedError);
}

TEST(Ideal, IsRefusedWithSimulatedEvents) {
  Experiment experiment = ShippedExperiment();
  experiment.sim_event.push_back(PayloadEvent(1.0, 0.0));
  EXPECT_THROW(
      Simulate(
          {.config = ShippedRig(kIdeal), .experiment = experiment, .payload_kg = 0.1, .log = {}}),
      RejectedError);
}

}  // namespace
}  // namespace flexarm
