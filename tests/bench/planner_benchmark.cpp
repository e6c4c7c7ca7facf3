// Cost of planning the rest of a move: 109 stages, as in docs/theory/payload.md 5.5, and the cost
// of its parts.

#include <benchmark/benchmark.h>

#include <memory>

#include "controller/planner/forward_rollout.h"
#include "tests/support/study_planner.h"

namespace flexarm {
namespace {

constexpr double kPeriod_s = SepticMove::kPeriod_s;

struct Bench {
  std::vector<RigidPoint> path = StudyMove().Ahead(0);
  PlanProblem problem{.first_tick = 0,
                      .x = PlanState::Zero(),
                      .payload_kg = 0.37,
                      .torque_before_nm = Eigen::Vector2d::Zero(),
                      .path = path,
                      .move_samples = static_cast<std::size_t>(StudyMove().periods)};
  RigidJointStepper linear{RigidJointArm(ThesisRig()), kPeriod_s, 1.0};
  RigidJointStepper rolling{RigidJointArm(ThesisRig()), kPeriod_s, 1.0, 4};
  PlanCost targets;
  PlanTrajectory track;
  PlanPolicy policy;
};

void Targets(benchmark::State& state) {
  const auto bench = std::make_unique<Bench>();
  for (auto _ : state) {
    bench->targets.Set(bench->linear.arm(), kPeriod_s, StudyPlannerConfig().weights,
                       bench->problem);
    benchmark::DoNotOptimize(bench->targets.stages());
  }
}
BENCHMARK(Targets)->Unit(benchmark::kMillisecond);

void BackwardSweep(benchmark::State& state) {
  const auto bench = std::make_unique<Bench>();
  bench->targets.Set(bench->linear.arm(), kPeriod_s, StudyPlannerConfig().weights, bench->problem);
  const PlanTrajectory& track = bench->targets.quasi_static();
  for (auto _ : state) {
    BackwardPass(bench->linear, 0.37, bench->targets, track, &bench->policy);
    benchmark::DoNotOptimize(bench->policy.K.data());
  }
}
BENCHMARK(BackwardSweep)->Unit(benchmark::kMillisecond);

void PlanRollOut(benchmark::State& state) {
  const auto bench = std::make_unique<Bench>();
  bench->targets.Set(bench->linear.arm(), kPeriod_s, StudyPlannerConfig().weights, bench->problem);
  bench->track.x[0].setZero();
  const auto law = [&](std::size_t k, const PlanState&) -> Eigen::Vector2d {
    return bench->targets.quasi_static().torque_nm[k];
  };
  for (auto _ : state) {
    RollOut(bench->rolling, 0.37, bench->targets.stages(), {28.0, 5.6}, law, &bench->track);
    benchmark::DoNotOptimize(bench->track.x.data());
  }
}
BENCHMARK(PlanRollOut)->Unit(benchmark::kMillisecond);

void Plan(benchmark::State& state) {
  const bool warm = state.range(0) != 0;
  const auto bench = std::make_unique<Bench>();
  const auto planner = std::make_unique<HorizonPlanner>(StudyPlanner());
  const auto first = std::make_unique<HorizonPlan>(), plan = std::make_unique<HorizonPlan>();
  if (!planner->Plan(bench->problem, nullptr, first.get())) state.SkipWithError("no plan");
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        planner->Plan(bench->problem, warm ? first.get() : nullptr, plan.get()));
  }
}
BENCHMARK(Plan)->ArgName("warm")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace flexarm
