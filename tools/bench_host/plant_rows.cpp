#include "tools/bench_host/plant_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "controller/host/simulation.h"
#include "model/simulation/arm_simulator.h"
#include "tools/bench_host/plant_rate.h"
#include "tools/bench_host/solver_problem.h"

namespace flexarm {
namespace {

// Bent links that turn: no term is zero.
constexpr double kMovingFor_s = 0.3;

// Processor time of a simulation without its design: between the first and the last call of its
// progress, which come from the thread that simulates.
class LoopWatch {
 public:
  void See(double simulated_s) {
    if (calls_++ == 0) first_ = {simulated_s, ThreadTime_s()};
    last_ = {simulated_s, ThreadTime_s()};
  }
  /// Over simulated time. @throws std::runtime_error if there were less than two calls
  double ProcessorTimeShare() const {
    if (calls_ < 2) throw std::runtime_error("the simulation told no progress");
    return (last_.processor_s - first_.processor_s) / (last_.simulated_s - first_.simulated_s);
  }

 private:
  struct Seen {
    double simulated_s, processor_s;
  };
  int calls_ = 0;
  Seen first_{}, last_{};
};

}  // namespace

BenchRow RateRow(const BenchSetting& setting) {
  BenchRow row{.name = "right-hand-side", .what = "Right-hand side of the plant, 4 modes a link"};
  const SolverProblem problem(setting.config.arm, setting.config.safety.torque_limit_nm);
  PlantRate rate(problem.model());
  rate.Push(problem.PushBefore(0));
  const SolverProblem::State y = problem.ByPlant(1e-3 * setting.config.sim.step_ms)[5];
  SolverProblem::State y_dot{};
  const auto work = [&] { rate(y.data(), y_dot.data()); };
  row.time = TimeWork(work, setting.short_work());
  AddCount(&row, CountWork(work, setting.most_counted()));
  return row;
}

BenchRow IntegratorRow(const BenchSetting& setting) {
  const SimConfig& sim = setting.config.sim;
  BenchRow row{.name = "integrator-step",
               .what = fmt::format("Integrator step of the plant, {:g} ms, {} modes a link",
                                   sim.step_ms, sim.plant_modes)};
  const ArmModel model(setting.config.arm, {sim.plant_modes, sim.plant_modes});
  ArmSimulator simulator(model);
  ArmState arm(model.dof());
  const Eigen::Vector2d push_nm =
      0.1 * Eigen::Vector2d::Map(setting.config.safety.torque_limit_nm.data());
  const double step_s = 1e-3 * sim.step_ms;
  // To and fro, so that any number of steps stays in the range of the arm.
  const int half_period = static_cast<int>(std::lround(kMovingFor_s / step_s));
  int step = 0;
  const auto work = [&] {
    const bool back = (step++ + half_period / 2) / half_period % 2 == 1;
    simulator.Step(arm, back ? Eigen::Vector2d(-push_nm) : push_nm, step_s);
  };
  row.time = TimeWork(work, setting.short_work());
  AddCount(&row, CountWork(work, setting.most_counted()));
  return row;
}

BenchRow ExperimentRow(const BenchSetting& setting, const BenchRow& integrator,
                       const BenchRow& step) {
  const RigConfig& config = setting.config;
  std::vector<double> taken_s;
  double simulated_s = 0.0;
  for (std::size_t i = 0; i < setting.long_count(); ++i) {
    LoopWatch watch;
    const SimulationResult result =
        Simulate({.config = config, .experiment = setting.experiment, .payload_kg = {}, .log = {}},
                 [&watch](double now_s) { watch.See(now_s); });
    simulated_s = 1e-9 * static_cast<double>(config.loop.period_ns() * result.ticks);
    taken_s.push_back(simulated_s * watch.ProcessorTimeShare());
  }
  BenchRow row{.name = "experiment",
               .what = fmt::format("{:g} s of an experiment in lock step: loop, safety and plant",
                                   simulated_s)};
  row.time = TimingOf(taken_s);
  row.ratio = {.name = "realtime_factor",
               .unit = "times real time",
               .value = simulated_s / row.time->median_s,
               .bar = {}};
  if (!integrator.work || !step.work) {
    row.counted = "not counted: needs the counts of step and integrator";
    return row;
  }
  const auto samples = static_cast<std::int64_t>(
      std::llround(1e9 * simulated_s / static_cast<double>(config.loop.period_ns())));
  const auto steps =
      static_cast<std::int64_t>(std::llround(1e3 * simulated_s / config.sim.step_ms));
  row.work = {
      .flops = samples * step.work->flops + steps * integrator.work->flops,
      .instructions = samples * step.work->instructions + steps * integrator.work->instructions};
  row.counted = "at least: " + std::to_string(samples) + " samples and " + std::to_string(steps) +
                " integrator steps at their counts";
  return row;
}

}  // namespace flexarm
