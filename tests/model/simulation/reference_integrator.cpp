#include "tests/model/simulation/reference_integrator.h"

#include <stdexcept>
#include <vector>

namespace flexarm {
namespace {

using Eigen::VectorXd;

VectorXd Rate(const ArmModel& model, const VectorXd& y, const VectorXd& force) {
  const Eigen::Index n = model.dof();
  VectorXd rate(2 * n);
  rate << y.tail(n), model.Acceleration(y.head(n), y.tail(n), force);
  return rate;
}

}  // namespace

ReferenceIntegrator::ReferenceIntegrator(const ArmModel& model, int columns)
    : model_(&model), columns_(columns) {
  if (columns < 1 || columns > 8) {
    throw std::invalid_argument("ReferenceIntegrator: 1 to 8 columns");
  }
}

void ReferenceIntegrator::Step(VectorXd* q, VectorXd* v, const Eigen::Vector2d& torque_nm,
                               double h_s) const {
  const Eigen::Index n = model_->dof();
  const VectorXd force = model_->InputMatrix() * torque_nm;
  VectorXd y0(2 * n);
  y0 << *q, *v;
  const VectorXd rate0 = Rate(*model_, y0, force);
  std::vector<VectorXd> table;  // the last row of Aitken and Neville's scheme
  for (int j = 1; j <= columns_; ++j) {
    const int substeps = 2 * j;
    const double h = h_s / substeps;
    VectorXd before = y0, y = y0 + h * rate0;
    for (int i = 1; i < substeps; ++i) {
      const VectorXd next = before + 2.0 * h * Rate(*model_, y, force);
      before = y;
      y = next;
    }
    VectorXd corner = y;  // T(j,1), then T(j,k+1) = T(j,k) + (T(j,k) - T(j-1,k)) / (ratio^2 - 1)
    for (int k = 1; k < j; ++k) {
      const double ratio = static_cast<double>(j) / (j - k);
      const auto at = static_cast<std::size_t>(k - 1);
      const VectorXd better = corner + (corner - table[at]) / (ratio * ratio - 1.0);
      table[at] = corner;
      corner = better;
    }
    table.push_back(corner);
  }
  *q = table.back().head(n);
  *v = table.back().tail(n);
}

}  // namespace flexarm
