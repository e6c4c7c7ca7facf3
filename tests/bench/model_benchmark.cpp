// Speed of the simulated arm: one step, and one simulated second, for 1 to 6 modes a link.

#include <benchmark/benchmark.h>

#include "model/simulation/arm_simulator.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

// A slow square wave keeps the arm moving within its range, with friction sliding and sticking.
Eigen::Vector2d Torque(int step) {
  return step % 2000 < 1000 ? Eigen::Vector2d(3.0, 0.5) : Eigen::Vector2d(-3.0, -0.5);
}

void SimulatorStep(benchmark::State& state) {
  const int modes = static_cast<int>(state.range(0));
  const ArmModel model(ThesisRig(), {modes, modes});
  ArmSimulator simulator(model, {.passes = static_cast<int>(state.range(1))});
  ArmState arm(model.dof());
  int step = 0;
  for (auto _ : state) {
    simulator.Step(arm, Torque(step++), ArmSimulator::kDefaultStep_s);
    benchmark::DoNotOptimize(arm.q.data());
  }
}
BENCHMARK(SimulatorStep)->ArgNames({"modes", "passes"})->ArgsProduct({{1, 2, 3, 4, 5, 6}, {2, 3}});

void SimulatedSecond(benchmark::State& state) {
  const int modes = static_cast<int>(state.range(0));
  const ArmModel model(ThesisRig(), {modes, modes});
  ArmSimulator simulator(model);
  for (auto _ : state) {
    ArmState arm(model.dof());
    for (int step = 0; step < 2000; ++step) {
      simulator.Step(arm, Torque(step), ArmSimulator::kDefaultStep_s);
    }
    benchmark::DoNotOptimize(arm.q.data());
  }
}
BENCHMARK(SimulatedSecond)->ArgName("modes")->Arg(2)->Arg(4)->Arg(6)->Unit(benchmark::kMillisecond);

void DenseAcceleration(benchmark::State& state) {
  const int modes = static_cast<int>(state.range(0));
  const ArmModel model(ThesisRig(), {modes, modes});
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(model.dof(), 1e-3);
  const Eigen::VectorXd force = Eigen::VectorXd::Zero(model.dof());
  for (auto _ : state) benchmark::DoNotOptimize(model.Acceleration(q, q, force));
}
BENCHMARK(DenseAcceleration)->ArgName("modes")->Arg(2)->Arg(4);

}  // namespace
}  // namespace flexarm
