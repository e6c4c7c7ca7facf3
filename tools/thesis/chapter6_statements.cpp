#include <algorithm>
#include <cmath>

#include "model/math/dense_decompositions.h"
#include "model/perturbation/perturbation_run.h"
#include "model/units.h"
#include "tools/analysis/reduction_grid.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

constexpr int kReductionModes = 10;  // 6.5: number of modes M of figures 6.3 to 6.9

constexpr double kPerturbedAt_deg = 45.0;
constexpr int kPerturbed_s = 3;

// Largest difference of any coordinate, relative to its largest deviation, between the arm and its
// linearisation at rest, during and after one period of a square wave of 1 s.
double LinearisationError(const ArmParameters& arm, const std::array<double, 2>& torque_nm) {
  const ArmModel model(arm, {2, 2});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dof()), v = q;
  q[kTheta2] = q[kTheta4] = kPerturbedAt_deg * kRadPerDeg;
  const auto none = [](double) { return Eigen::Vector2d(0.0, 0.0); };
  const auto square = [&](double time_s) {
    const double sign = time_s < 0.5 ? 1.0 : time_s < 1.0 ? -1.0 : 0.0;
    return Eigen::Vector2d(sign * torque_nm[0], sign * torque_nm[1]);
  };
  const PerturbationRun run = Perturb(model, q, v, none, square, kPerturbed_s, 2e-4);
  double worst = 0.0;
  for (Eigen::Index i = 0; i < model.dof(); ++i) worst = std::max(worst, run.RelativeError(i));
  return worst;
}

Statement Linearised(const ArmParameters& arm) {
  const std::array<double, 2> weak{0.004, 0.001}, strong{0.4, 0.1};
  const double small = 100.0 * LinearisationError(arm, weak);
  const double whole = 100.0 * LinearisationError(arm, strong);
  const auto torques = [](const std::array<double, 2>& nm) {
    return Figure(nm[0], 1) + " and " + Figure(nm[1], 1) + " N m";
  };
  return {"6.2", "for small perturbations the linear model performs like the nonlinear one",
          "after " + torques(weak) + " at " + Figure(kPerturbedAt_deg, 2) +
              " deg, coordinates differ by at most " + Figure(small, 2) +
              " % of their largest values over " + Count(kPerturbed_s) + " s; after " +
              torques(strong) + " by " + Figure(whole, 2) +
              " %. Without friction: no small torque moves a joint that sticks",
          small < 1.0 ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement BothConditions(const ArmModel& model) {
  const PowerBalance relaxed = BalancePower(UndampedArm(model, {0.5, 0.0, 0.0}));
  const PowerBalance symmetric = BalancePower(UndampedArmAtRest(model, 0.5));
  double worst = 0.0;
  for (std::size_t k = 0; k < std::min(relaxed.mode.size(), symmetric.mode.size()); ++k) {
    worst = std::max(worst, std::abs(relaxed.mode[k].rho / symmetric.mode[k].rho - 1.0));
  }
  const bool holds = relaxed.mode.size() == symmetric.mode.size() && worst < 1e-3 &&
                     relaxed.condition == PowerCondition::kDiagonalisable;
  return {"6.3", "the relaxed condition, with a Q2 that is not symmetric, balances power as well",
          "at rest the arm has both forms; no rho differs by " +
              (worst < 1e-4 ? std::string("0.01 %") : Figure(100.0 * worst, 2) + " %") + " or more",
          holds ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement TimeAverages(const ArmModel& model) {
  const UndampedSystem system = UndampedArm(model, {0.0, 0.0, 0.0});
  const Eigen::VectorXd mu = BalancePower(system).mu;
  constexpr double kAveraged_s = 60.0;
  const Eigen::VectorXd average = TimeAveragedPower(system, kAveraged_s, 3.1830988618e-4);
  double worst = 0.0;
  for (Eigen::Index i = kPhi1; i < model.dof(); ++i) {
    worst = std::max(worst, std::abs(average[i] / mu[i] - 1.0));
  }
  return {"6.4", "mu follows from rho and L: it is the mean power of each original state (6.22)",
          Figure(kAveraged_s, 2) +
              " s of the impulse response, averaged, agree with every modal coordinate's mu to " +
              Figure(100.0 * worst, 2) + " %",
          worst < 0.01 ? Verdict::kHolds : Verdict::kDoesNot};
}

Statement Scaling(const ArmModel& model) {
  std::string text = "first mode of link 1 at rest:";
  double least = 100.0, most = 0.0;
  for (const auto& [scaling, name] : {std::pair{ModalScaling::kMass, " with modes of 1 kg,"},
                                      std::pair{ModalScaling::kLength, " with int psi^2 = L,"},
                                      std::pair{ModalScaling::kTip, " with psi(L) = 1"}}) {
    const double epsilon = ReduceArm(model, {0.0, 0.0, 0.0}, scaling).link[0].epsilon_percent[0];
    text += ' ';
    text += Figure(epsilon, 4) + " %" + name;
    least = std::min(least, epsilon);
    most = std::max(most, epsilon);
  }
  return {"6.4", "the power element of a state has a definite physical meaning", text,
          most - least < 0.1 ? Verdict::kHolds : Verdict::kInPart};
}

Statement LightlyDamped(const ArmParameters& arm) {
  const ArmModel model(arm, {kReductionModes, kReductionModes});
  const Eigen::VectorXcd root = DampedArm(model, {0.0, 0.0, 0.0}).A.eigenvalues();
  double first = 1.0, slowest = 1e300;
  int creeping = 0, all = 0;
  for (const std::complex<double>& lambda : root) {
    if (std::abs(lambda) < 1.0) continue;  // rigid-body motions
    ++all;
    creeping += std::abs(lambda.imag()) == 0.0 ? 1 : 0;
    if (lambda.imag() == 0.0 || std::abs(lambda) > slowest) continue;
    slowest = std::abs(lambda);
    first = -lambda.real() / slowest;
  }
  return {"6.5.1", "the arm is lightly damped, so that damping can be neglected",
          "with the links' damping of this rig the lowest mode has the damping ratio " +
              Figure(first, 2) + ", but " + Count(creeping) + " of " + Count(all) + " roots with " +
              Count(kReductionModes) + " modes a link do not oscillate at all",
          creeping == 0 ? Verdict::kHolds : Verdict::kInPart};
}

Statement CellCentres() {
  const ReductionGrid grid;
  std::string text;
  bool all = true;
  for (const double shown_deg : {28.4, 61.6}) {
    double nearest = 1e300;
    for (int i = 0; i < grid.cells; ++i) {
      const double centre = grid.Centre(i, 0, 0).theta2_rad / kRadPerDeg;
      if (std::abs(centre - shown_deg) < std::abs(nearest - shown_deg)) nearest = centre;
    }
    all = all && std::abs(nearest - shown_deg) < 0.06;
    const double interval = (grid.theta2_deg[1] - grid.theta2_deg[0]) / (grid.cells - 1);
    const double point = std::round(shown_deg / interval) * interval;
    if (!text.empty()) text += "; ";
    text += Figure(shown_deg, 3) + " deg of the figures is not a centre (nearest " +
            Figure(nearest, 4) + "), but one of 20 points from end to end (" + Figure(point, 4) +
            ")";
  }
  return {"6.5.3", "results are for the centres of 20 cells an axis", text,
          all ? Verdict::kHolds : Verdict::kDoesNot};
}

// A figure of each cell, of link 0 or 1.
struct Range {
  double least = 1e300, most = -1e300;

  void Take(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  double Span() const { return most - least; }
  std::string Text() const { return Figure(least, 5) + " .. " + Figure(most, 5) + " %"; }
};

struct GridRanges {
  std::array<Range, 2> first, second;  // eps_1, eps_2 of links 1 and 2
};

GridRanges RangesOf(const std::vector<ReductionCell>& cells) {
  GridRanges ranges;
  for (const ReductionCell& cell : cells) {
    for (const std::size_t link : {0U, 1U}) {
      ranges.first[link].Take(cell.epsilon_1_percent[link]);
      ranges.second[link].Take(cell.epsilon_2_percent[link]);
    }
  }
  return ranges;
}

std::string OfBoth(const std::array<Range, 2>& range) {
  return "link 1 " + range[0].Text() + ", link 2 " + range[1].Text();
}

// The number of pairs of rates for which the first mode's share is largest at the last elbow angle.
int LargestAtRightAngle(const ReductionGrid& grid, const std::vector<ReductionCell>& cells,
                        std::size_t link) {
  const auto cells_an_axis = static_cast<std::size_t>(grid.cells);
  const std::size_t pairs = cells_an_axis * cells_an_axis;
  int count = 0;
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    std::size_t best = pair;
    for (std::size_t cell = pair; cell < cells.size(); cell += pairs) {
      if (cells[cell].epsilon_1_percent[link] > cells[best].epsilon_1_percent[link]) best = cell;
    }
    count += best + pairs >= cells.size() ? 1 : 0;
  }
  return count;
}

Statement Perpendicular(const ReductionGrid& grid, const std::vector<ReductionCell>& cells) {
  const int pairs = grid.cells * grid.cells;
  const int link1 = LargestAtRightAngle(grid, cells, 0),
            link2 = LargestAtRightAngle(grid, cells, 1);
  const auto share = [&](int count) { return Figure(100.0 * count / pairs, 2) + " %"; };
  const bool always = link1 == pairs && link2 == pairs, never = link1 == 0 && link2 == 0;
  return {"6.5.3",
          "with the links at right angles the first mode dominates more than anywhere else",
          "its share is largest at the cells nearest to 90 deg for " + share(link1) +
              " of the pairs of rates (link 1) and " + share(link2) + " (link 2)",
          always  ? Verdict::kHolds
          : never ? Verdict::kDoesNot
                  : Verdict::kInPart};
}

Statement Roots(const ArmModel& model, const std::vector<ReductionCell>& cells) {
  const auto count = [&](const auto& is) { return std::count_if(cells.begin(), cells.end(), is); };
  const auto zero = count([](const ReductionCell& cell) { return cell.zero_roots > 0; });
  const auto slow = count([](const ReductionCell& cell) { return cell.rigid_share_percent > 0.0; });
  const auto negative = count([](const ReductionCell& cell) { return cell.negative_roots > 0; });
  const ReductionCell beyond = ReduceCell(model, {120.0 * kRadPerDeg, -4.0, -6.0});
  return {"6.3", "all roots of the linearised arm are distinct and positive",
          "a rigid-body root is zero in " + Count(zero) + " of " + Count(std::ssize(cells)) +
              " cells and left out; in " + Count(slow) +
              " the elbow's root is a slow oscillation, in " + Count(negative) +
              " it is negative. At 120 deg, -4 and -6 rad/s " + Count(beyond.negative_roots) +
              " root is negative and left out",
          zero + negative == 0 ? Verdict::kHolds : Verdict::kDoesNot};
}

void AddGrid(const ArmModel& model, std::vector<Statement>* out) {
  const ReductionGrid grid;
  const std::vector<NominalMotion> centres = CentresOf(grid);
  const std::vector<ReductionCell> cells = ReduceCells(model, centres, {});
  const GridRanges mass = RangesOf(cells);
  const GridRanges length =
      RangesOf(ReduceCells(model, centres, {.scaling = ModalScaling::kLength}));
  const double least_first = std::min(length.first[0].least, length.first[1].least);
  const double least_second = std::min(length.second[0].least, length.second[1].least);
  out->push_back({"6.5.3", "the first mode's power is stronger than any other's, on both links",
                  "its share over " + Count(std::ssize(cells)) + " cells: " + OfBoth(mass.first) +
                      "; scaled by length: " + OfBoth(length.first),
                  least_first > 50.0 ? Verdict::kHolds : Verdict::kDoesNot});
  out->push_back({"6.5.3", "two modes a link dominate everywhere; the higher ones are negligible",
                  "share of the first two: " + OfBoth(mass.second) +
                      "; scaled by length: " + OfBoth(length.second),
                  least_second > 99.0 ? Verdict::kHolds : Verdict::kDoesNot});
  const bool first = mass.first[1].Span() > mass.first[0].Span();
  const bool second = mass.second[1].Span() > mass.second[0].Span();
  out->push_back({"6.5.3", "the nominal motion matters more to link 2 than to link 1",
                  "over the cells the first mode's share varies by " +
                      Figure(mass.first[0].Span(), 2) + " (link 1) and " +
                      Figure(mass.first[1].Span(), 2) + " % (link 2), the first two modes' by " +
                      Figure(mass.second[0].Span(), 2) + " and " +
                      Figure(mass.second[1].Span(), 2) + " %",
                  first && second   ? Verdict::kHolds
                  : first || second ? Verdict::kInPart
                                    : Verdict::kDoesNot});
  out->push_back(Perpendicular(grid, cells));
  out->push_back(Roots(model, cells));
}

}  // namespace

std::vector<Statement> Chapter6Statements(const RigConfig& config) {
  const ArmModel model(config.arm, {kReductionModes, kReductionModes});
  std::vector<Statement> out = {Linearised(config.arm),    BothConditions(model),
                                TimeAverages(model),       Scaling(model),
                                LightlyDamped(config.arm), CellCentres()};
  AddGrid(model, &out);
  return out;
}

}  // namespace flexarm
