#include "model/perturbation/perturbation_run.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

double PerturbationRun::RelativeError(Eigen::Index i) const {
  double difference = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    difference = std::max(difference, std::fabs(linear[k][i] - nonlinear[k][i]));
    largest = std::max(largest, std::fabs(nonlinear[k][i]));
  }
  return largest > 0.0 ? difference / largest : 0.0;
}

PerturbationRun Perturb(const ArmModel& model, const VectorXd& q, const VectorXd& v,
                        const TorqueAt& nominal, const TorqueAt& delta, double duration_s,
                        double step_s) {
  if (!(step_s > 0.0) || !(duration_s > 0.0)) {
    throw std::invalid_argument("Perturb: step and duration must be positive");
  }
  const SimulatorOptions options{.passes = 4, .substeps = 1, .coulomb_friction = false};
  ArmSimulator simulator(model, options), perturbed(model, options);
  ArmState x(model.dof());
  x.q = q, x.v = v;
  ArmState y = x;
  const Eigen::Index n = model.dof();
  VectorXd d = VectorXd::Zero(2 * n);
  PerturbationRun run;
  const MatrixXd one = MatrixXd::Identity(2 * n, 2 * n);
  const auto steps = static_cast<long>(std::lround(duration_s / step_s));
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * step_s, middle = t + 0.5 * step_s;
    run.time_s.push_back(t);
    run.nominal.emplace_back(x.q);
    run.nonlinear.emplace_back(y.q - x.q);
    run.linear.emplace_back(d.head(n));
    if (k == steps) break;
    const Vector2d u = nominal(middle), du = delta(middle);
    const VectorXd q0 = x.q, v0 = x.v;
    simulator.Step(x, u, step_s);
    perturbed.Step(y, u + du, step_s);
    const LinearModel linear = Linearize(model, 0.5 * (q0 + x.q), 0.5 * (v0 + x.v), u);
    const MatrixXd half = 0.5 * step_s * linear.A;
    d = (one - half).partialPivLu().solve((one + half) * d + step_s * (linear.B * du));
  }
  return run;
}

}  // namespace flexarm
