#include "tools/analysis/reduction_grid.h"

#include "model/units.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

double CentreOf(double low, double high, int i, int cells) {
  return low + (high - low) * (i + 0.5) / cells;
}

}  // namespace

NominalMotion ReductionGrid::Centre(int i, int j, int k) const {
  return {CentreOf(theta2_deg[0], theta2_deg[1], i, cells) * kRadPerDeg,
          CentreOf(-theta1_rate_rad_s, theta1_rate_rad_s, j, cells),
          CentreOf(-theta2_rate_rad_s, theta2_rate_rad_s, k, cells)};
}

ReductionCell ReduceCell(const ArmModel& model, const NominalMotion& motion,
                         const ReductionOptions& options) {
  const ArmReduction reduction =
      ReduceArm(model, motion, options.scaling, options.rigid_below_rad2_s2);
  ReductionCell cell{motion, {}, {}, 0.0, 0, 0};
  for (std::size_t link = 0; link < 2; ++link) {
    const Eigen::VectorXd& epsilon = reduction.link[link].epsilon_percent;
    cell.epsilon_1_percent[link] = epsilon[0];
    cell.epsilon_2_percent[link] = epsilon.size() > 1 ? epsilon[1] : epsilon[0];
  }
  double sum = 0.0;
  for (const PowerMode& mode : reduction.balance.mode) {
    sum += mode.rho;
    if (mode.rigid_origin) cell.rigid_share_percent += mode.rho;
  }
  cell.rigid_share_percent *= 100.0 / sum;
  for (const DroppedRoot& root : reduction.balance.dropped) {
    ++(root.reason == DroppedRoot::Reason::kRigid ? cell.zero_roots : cell.negative_roots);
  }
  return cell;
}

std::vector<ReductionCell> ReduceCells(const ArmModel& model,
                                       const std::vector<NominalMotion>& motions,
                                       const ReductionOptions& options,
                                       const std::function<void(std::size_t)>& progress) {
  std::vector<ReductionCell> cells(motions.size());
  ParallelFor(
      motions.size(), [&](std::size_t i) { cells[i] = ReduceCell(model, motions[i], options); },
      progress);
  return cells;
}

std::vector<NominalMotion> CentresOf(const ReductionGrid& grid) {
  std::vector<NominalMotion> motions;
  for (int i = 0; i < grid.cells; ++i) {
    for (int j = 0; j < grid.cells; ++j) {
      for (int k = 0; k < grid.cells; ++k) motions.push_back(grid.Centre(i, j, k));
    }
  }
  return motions;
}

}  // namespace flexarm
