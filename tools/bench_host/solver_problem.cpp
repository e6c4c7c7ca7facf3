#include "tools/bench_host/solver_problem.h"

#include <algorithm>
#include <cmath>

#include "model/simulation/arm_simulator.h"

namespace flexarm {
namespace {

using State = SolverProblem::State;

// Shares of the torque limits: 6.6 and 1.0 N m on the shipped rig.
constexpr std::array<double, 2> kShare = {0.22, 0.16};

// The fastest mode decays with some 1e4 1/s: 0.1 a step, where the error of order 4 is 1e-6 of it.
constexpr double kReferenceStep_s = 1e-5;

int StepsOf(double step_s) {
  return static_cast<int>(std::lround(SolverProblem::kInterval_s / step_s));
}

State Moved(const State& y, double h, const State& rate) noexcept {
  State out;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = y[i] + h * rate[i];
  return out;
}

State RateAt(PlantRate& rate, const State& y) noexcept {
  State out;
  rate(y.data(), out.data());
  return out;
}

State RungeKuttaStep(PlantRate& rate, const State& y, double h) noexcept {
  const State k1 = RateAt(rate, y), k2 = RateAt(rate, Moved(y, 0.5 * h, k1));
  const State k3 = RateAt(rate, Moved(y, 0.5 * h, k2)), k4 = RateAt(rate, Moved(y, h, k3));
  State out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  }
  return out;
}

Eigen::VectorXd AnglesOf(const State& y) { return Eigen::VectorXd::Map(y.data(), PlantRate::kDof); }

}  // namespace

SolverProblem::SolverProblem(const ArmParameters& arm, const std::array<double, 2>& torque_limit_nm)
    : model_(SmoothArm(arm), {PlantRate::kModes, PlantRate::kModes}),
      push_nm_(kShare[0] * torque_limit_nm[0], kShare[1] * torque_limit_nm[1]) {}

Eigen::Vector2d SolverProblem::PushBefore(std::size_t instant) const noexcept {
  return instant < kInstants / 2 ? push_nm_ : Eigen::Vector2d(-push_nm_);
}

SolverProblem::Motion SolverProblem::ByPlant(double step_s) const {
  ArmSimulator simulator(model_, {.coulomb_friction = false});
  ArmState arm(model_.dof());
  Motion motion(kInstants);
  for (std::size_t instant = 0; instant < kInstants; ++instant) {
    const Eigen::Vector2d push = PushBefore(instant);
    for (int i = 0; i < StepsOf(step_s); ++i) simulator.Step(arm, push, step_s);
    std::copy_n(arm.q.data(), PlantRate::kDof, motion[instant].begin());
    std::copy_n(arm.v.data(), PlantRate::kDof, motion[instant].begin() + PlantRate::kDof);
  }
  return motion;
}

SolverProblem::Motion SolverProblem::ByRungeKutta(double step_s) const {
  PlantRate rate(model_);
  State y{};
  Motion motion(kInstants);
  for (std::size_t instant = 0; instant < kInstants; ++instant) {
    rate.Push(PushBefore(instant));
    for (int i = 0; i < StepsOf(step_s); ++i) y = RungeKuttaStep(rate, y, step_s);
    motion[instant] = y;
  }
  return motion;
}

double SolverProblem::TipError_m(const Motion& a, const Motion& b) const {
  double most = 0.0;
  for (std::size_t i = 0; i < kInstants; ++i) {
    const double apart =
        (model_.TipPosition(AnglesOf(a[i])) - model_.TipPosition(AnglesOf(b[i]))).norm();
    if (std::isnan(apart)) return apart;
    most = std::max(most, apart);
  }
  return most;
}

SolverReference MakeReference(const SolverProblem& problem) {
  const SolverProblem::Motion coarse = problem.ByRungeKutta(kReferenceStep_s);
  SolverProblem::Motion fine = problem.ByRungeKutta(0.5 * kReferenceStep_s);
  const double error_m = problem.TipError_m(coarse, fine);
  return {.motion = std::move(fine), .error_m = error_m};
}

}  // namespace flexarm
