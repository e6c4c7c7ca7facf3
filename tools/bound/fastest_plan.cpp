#include "tools/bound/fastest_plan.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "tools/bound/linear_program.h"
#include "tools/bound/plan_rows.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostPrograms = 200;
// More than a violation saves of the time. With 3 the search ends outside the limits, with 40 it
// takes shorter steps.
constexpr double kViolationWeight = 12.0;
constexpr double kFirstRegion = 0.5;  // of the torque limits
constexpr double kLeastRegion = 2e-3;
constexpr double kLargestRegion = 2.0;
constexpr double kPeriodRegion = 0.3;  // of the period, with a region of 1
constexpr double kKeptPeriod = 1e-9;   // the method needs an interior
constexpr double kEnd = 2e-5;          // predicted gain of the merit at which it ends
constexpr int kCorrections = 4;
constexpr double kGood = 0.7, kPoor = 0.3, kTaken = 0.1;  // gain over the predicted one

// One side of a row of PlanRows: sign (value + by_plan change) <= bound.
struct Side {
  Index row;
  double sign;
};

// The sides that a change within the region may reach. The others need no place in the program.
std::vector<Side> ReachableSides(const PlanRows& rows, const VectorXd& largest_change) {
  const VectorXd reach = rows.by_plan.cwiseAbs() * largest_change;
  std::vector<Side> sides;
  for (Index i = 0; i < rows.value.size(); ++i) {
    for (const double sign : {1.0, -1.0}) {
      if (sign * rows.value[i] + reach[i] >= rows.bound[i]) sides.push_back({i, sign});
    }
  }
  return sides;
}

VectorXd RoomOf(const PlanRows& rows, const std::vector<Side>& sides, const VectorXd& value) {
  VectorXd room(static_cast<Index>(sides.size()));
  for (Index j = 0; j < room.size(); ++j) {
    const auto [row, sign] = sides[static_cast<std::size_t>(j)];
    room[j] = rows.bound[row] - sign * value[row];
  }
  return room;
}

class PlanSearch {
 public:
  PlanSearch(const ArmMotion& arm, const TorquePlan& start, PeriodChoice choice)
      : arm_(arm),
        choice_(choice),
        first_period_s_(start.period_s),
        best_{.plan = start, .x = StatesOf(arm, start), .violation = 0.0, .iterations = 0} {
    best_.violation = ViolationOf(arm, best_.x);
  }

  FastestPlan Run(const std::function<void()>& progress) {
    while (best_.iterations < kMostPrograms && region_ > kLeastRegion) {
      if (choice_ == PeriodChoice::kKept && best_.found()) break;
      if (!Improve(progress)) break;
    }
    return std::move(best_);
  }

 private:
  struct Trial {
    VectorXd change;
    TorquePlan plan;
    MatrixXd x;
    double violation, gained;
  };

  double Merit(const TorquePlan& plan, double violation) const {
    const double time = choice_ == PeriodChoice::kShortest ? plan.period_s / first_period_s_ : 0.0;
    return time + kViolationWeight * violation;
  }

  // Variables: the changes of PlanRows, and the violation.
  LinearProgram VariablesOf() const {
    const Index torques = 2 * best_.plan.periods(), n = torques + 2;
    LinearProgram program;
    program.cost = program.low = program.high = VectorXd::Zero(n);
    for (Index i = 0; i < torques; ++i) {
      const double share = best_.plan.torque_nm(i % 2, i / 2) / arm_.torque_limit_nm()[i % 2];
      program.low[i] = std::max(-region_, -1.0 - share);
      program.high[i] = std::min(region_, 1.0 - share);
    }
    const bool free = choice_ == PeriodChoice::kShortest;
    program.high[n - 2] = free ? kPeriodRegion * std::min(region_, 1.0) : kKeptPeriod;
    program.low[n - 2] = -program.high[n - 2];
    program.cost[n - 2] = free ? best_.plan.period_s / first_period_s_ : 0.0;
    program.high[n - 1] = 2.0 * best_.violation + 1.0;
    program.cost[n - 1] = kViolationWeight;
    return program;
  }

  void AddRows(const PlanRows& rows, const std::vector<Side>& sides, LinearProgram* program) const {
    const Index n = program->cost.size();
    program->rows.resize(static_cast<Index>(sides.size()), n);
    for (Index j = 0; j < program->rows.rows(); ++j) {
      const auto [row, sign] = sides[static_cast<std::size_t>(j)];
      program->rows.row(j).head(n - 1) = sign * rows.by_plan.row(row);
      program->rows(j, n - 1) = -1.0;
    }
    program->limit = RoomOf(rows, sides, rows.value);
  }

  Trial TrialOf(const VectorXd& change) const {
    Trial trial{.change = change, .plan = best_.plan, .x = {}, .violation = 0.0, .gained = 0.0};
    const Eigen::Vector2d& limit = arm_.torque_limit_nm();
    for (Index k = 0; k < trial.plan.periods(); ++k) {
      const Eigen::Vector2d torque_nm =
          trial.plan.torque_nm.col(k) + limit.cwiseProduct(change.segment<2>(2 * k));
      trial.plan.torque_nm.col(k) = torque_nm.cwiseMin(limit).cwiseMax(-limit);
    }
    if (choice_ == PeriodChoice::kShortest) {
      trial.plan.period_s *= 1.0 + change[2 * trial.plan.periods()];
    }
    trial.x = StatesOf(arm_, trial.plan);
    trial.violation = ViolationOf(arm_, trial.x);
    trial.gained = Merit(best_.plan, best_.violation) - Merit(trial.plan, trial.violation);
    return trial;
  }

  // Second-order correction: the same program with the values that the trial has beyond the linear
  // ones.
  void Correct(const PlanRows& rows, const std::vector<Side>& sides, LinearProgram program,
               double predicted, Trial* trial, const std::function<void()>& progress) {
    for (int i = 0; i < kCorrections && trial->gained < kGood * predicted; ++i) {
      const VectorXd linear = rows.by_plan * trial->change.head(rows.by_plan.cols());
      program.limit = RoomOf(rows, sides, PlanRows::ValuesOf(arm_, trial->x) - linear);
      const std::optional<VectorXd> change = Solve(program, progress);
      if (!change) return;
      Trial next = TrialOf(*change);
      if (next.gained <= trial->gained) return;
      *trial = std::move(next);
    }
  }

  std::optional<VectorXd> Solve(const LinearProgram& program,
                                const std::function<void()>& progress) {
    ++best_.iterations;
    if (progress) progress();
    return SolveLinearProgram(program);
  }

  // False where no change promises a gain.
  bool Improve(const std::function<void()>& progress) {
    const PlanRows rows(arm_, best_.plan, best_.x);
    LinearProgram program = VariablesOf();
    const Index changes = rows.by_plan.cols();
    const std::vector<Side> sides =
        ReachableSides(rows, program.high.head(changes).cwiseMax(-program.low.head(changes)));
    AddRows(rows, sides, &program);
    const std::optional<VectorXd> change = Solve(program, progress);
    if (!change) {
      region_ *= 0.5;
      return true;
    }
    const double predicted = kViolationWeight * best_.violation - program.cost.dot(*change);
    if (predicted < kEnd) return false;
    Trial trial = TrialOf(*change);
    Correct(rows, sides, program, predicted, &trial, progress);
    const double share = trial.gained / predicted;
    if (share > kGood) region_ = std::min(2.0 * region_, kLargestRegion);
    if (share < kPoor) region_ *= share < 0.0 ? 0.35 : 0.6;
    if (share > kTaken) {
      best_.plan = std::move(trial.plan);
      best_.x = std::move(trial.x);
      best_.violation = trial.violation;
    }
    return true;
  }

  const ArmMotion& arm_;
  PeriodChoice choice_;
  double first_period_s_;
  double region_ = kFirstRegion;
  FastestPlan best_;
};

}  // namespace

FastestPlan FindFastestPlan(const ArmMotion& arm, const TorquePlan& start, PeriodChoice choice,
                            const std::function<void()>& progress) {
  return PlanSearch(arm, start, choice).Run(progress);
}

}  // namespace flexarm
