#include "model/beam_methods/friction_root.h"

#include <cmath>
#include <stdexcept>

#include "model/beam/beam_equations.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

// |EI w''(0)| of the beam that hangs on w(0) = 0, satisfies its tip and has w(L) = 1 at omega.
double RootMoment(const std::vector<BeamSection>& section, const BeamTip& tip, double omega) {
  Eigen::MatrixXd A = MatchingMatrix(section, tip, omega);
  const BeamSection& last = section.back();
  A.row(1).setZero();  // the slope at the root is free; the tip deflection is given instead
  A.row(1).tail<4>() = BasisRow(last, omega, last.length_m, 0);
  const Eigen::VectorXd c = A.fullPivLu().solve(Eigen::VectorXd::Unit(A.rows(), 1));
  const double curvature = BasisRow(section.front(), omega, 0.0, 2).dot(c.head<4>());
  return std::fabs(section.front().bending_stiffness_nm2() * curvature);
}

}  // namespace

FrictionRoot FrictionRootMode(const std::vector<BeamSection>& section, const BeamTip& tip,
                              int order, double amplitude_m, double friction_nm) {
  if (!(amplitude_m > 0.0) || !(friction_nm >= 0.0)) {
    throw std::invalid_argument("FrictionRootMode: amplitude > 0 and friction >= 0");
  }
  const BeamMode clamped = ClampedModes(section, tip, order).back();
  const double EI = section.front().bending_stiffness_nm2();
  const double moment = std::fabs(EI * clamped.Curvature(0.0)) * amplitude_m;
  if (moment <= friction_nm) return {true, clamped.frequency_rad_s(), moment};
  double low = PinnedFrequency(section, tip, order), high = clamped.frequency_rad_s();
  if (friction_nm == 0.0) return {false, low, moment};
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return {false, middle, moment};
    const bool slips_less = RootMoment(section, tip, middle) * amplitude_m > friction_nm;
    (slips_less ? high : low) = middle;
  }
}

}  // namespace flexarm
