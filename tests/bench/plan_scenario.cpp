#include "tests/bench/plan_scenario.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/bench/counted.h"

namespace flexarm {

namespace {

constexpr int kEvery = 10;  // samples from plan to plan, as shipped

// From 0 to 1.
double ShareOf(std::uint32_t word) { return word / 4294967295.0; }
// From -1 to 1.
double AroundZero(std::uint32_t word) { return 2.0 * ShareOf(word) - 1.0; }

PlanProblem ProblemAt(const SepticMove& move, int sample, double payload_kg,
                      const std::vector<RigidPoint>& path) {
  PlanProblem problem{.first_tick = sample,
                      .x = PlanState::Zero(),
                      .payload_kg = payload_kg,
                      .torque_before_nm = Eigen::Vector2d::Zero(),
                      .path = path,
                      .move_samples = static_cast<std::size_t>(std::max(0, move.periods - sample))};
  const RigidPoint now = move.At(sample);
  for (int i = 0; i < 2; ++i) {
    problem.x(i) = now.angle_rad[static_cast<std::size_t>(i)];
    problem.x(6 + i) = now.rate_rad_s[static_cast<std::size_t>(i)];
  }
  return problem;
}

}  // namespace

PlanScenario::PlanScenario(InstructionCounter& counter)
    : counter_(&counter),
      planner_(std::make_unique<HorizonPlanner>(StudyPlanner())),
      plan_(std::make_unique<HorizonPlan>()),
      previous_(std::make_unique<HorizonPlan>()) {}

std::int64_t PlanScenario::PerStage(const PlanProblem& problem, const HorizonPlan* previous) {
  Counted([&] { static_cast<void>(planner_->Plan(problem, previous, plan_.get())); });
  return counter_->Last() / static_cast<std::int64_t>(problem.path.size() - 3);
}

std::int64_t PlanScenario::Median() {
  const SepticMove move = StudyMove();
  std::vector<std::int64_t> counts;
  for (int sample = 0; sample < move.periods; sample += kEvery) {
    const std::vector<RigidPoint> path = move.Ahead(sample);
    const PlanProblem problem = ProblemAt(move, sample, 0.37, path);
    counts.push_back(PerStage(problem, sample == 0 ? nullptr : previous_.get()));
    std::swap(plan_, previous_);
  }
  std::sort(counts.begin(), counts.end());
  return counts[counts.size() / 2];
}

std::int64_t PlanScenario::Cost(const Candidate& candidate) {
  const Words a = WordsOf(candidate, 0), b = WordsOf(candidate, 1), c = WordsOf(candidate, 2);
  const SepticMove move{.from_rad = {AroundZero(a[2]), AroundZero(a[3])},
                        .to_rad = {AroundZero(a[4]), AroundZero(a[5])},
                        .periods = 20 + static_cast<int>(a[6] % 100)};
  const int sample = static_cast<int>(a[7] % static_cast<std::uint32_t>(move.periods + 1));
  const std::vector<RigidPoint> path = move.Ahead(sample);
  PlanProblem problem = ProblemAt(move, sample, ShareOf(b[0]), path);
  const bool continues = b[1] % 2 == 0;
  if (continues) {
    PlanProblem before = problem;
    if (b[1] % 4 == 0) before.payload_kg = ShareOf(b[2]);
    previous_->Begin(0, 0.0);
    // The rest of a run may have been planned before, or not: a refused plan leaves an empty one.
    static_cast<void>(planner_->Plan(before, nullptr, previous_.get()));
  }
  // A tenth of a radian and a radian per second are far beyond the errors of the shipped loop.
  for (int i = 0; i < 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    problem.x(i) += 0.1 * AroundZero(b[3 + at]);
    problem.x(6 + i) += AroundZero(b[5 + at]);
    problem.torque_before_nm(i) = 5.0 * AroundZero(c[4 + at]);
  }
  for (int i = 0; i < 4; ++i) problem.x(2 + i) = 0.03 * AroundZero(c[static_cast<std::size_t>(i)]);
  return PerStage(problem, continues ? previous_.get() : nullptr);
}

}  // namespace flexarm
