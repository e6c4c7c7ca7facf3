#include "tools/report/published_results.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "config/config.h"
#include "model/arm/arm_model.h"
#include "model/beam/link_modes.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Quantity = PublishedQuantity;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kArmModes = 10;  // modes a link; the frequencies of the cases are then exact to 1e-4

// One mode, of a link or of the whole arm, scaled to a modal mass of 1 kg.
struct UnitMode {
  double frequency_rad_s, beta_l;
  double tip, tip_slope, root_slope;      // 1/sqrt(kg), 1/(m sqrt(kg)) twice
  double mass_integral, moment_integral;  // sqrt(kg), m sqrt(kg)
};

const LinkParameters& LinkOf(const ArmParameters& arm, PublishedPart part) {
  return arm.link[part == PublishedPart::kLink2 ? 1 : 0];
}

BeamTip TipOf(const ArmParameters& arm, PublishedPart part) {
  if (part == PublishedPart::kLink2) return Link2Tip(arm);
  BeamTip tip = Link1Tip(arm);
  if (part == PublishedPart::kLink1Locked) {
    const ArmConstants c(arm, {1, 1});
    tip.inertia_kgm2 = c.Ir2 + c.J2 + c.I2 + c.Ip;
  }
  return tip;
}

UnitMode LinkMode(const ArmParameters& arm, const PublishedFigure& figure) {
  const LinkParameters& link = LinkOf(arm, figure.part);
  const BeamTip tip = TipOf(arm, figure.part);
  const BeamRoot root = figure.pinned ? BeamRoot::Pinned() : BeamRoot::Clamped();
  const BeamMode psi = NaturalModes(link.section, tip, root, figure.mode).back();
  const double L = link.length_m();
  const auto integral = [&](const auto& weight) {
    return IntegrateAlong(link.section, 2.0 * L / psi.beta_length(),
                          [&](double x, const BeamSection& s) {
                            return s.mass_per_length_kg_m() * weight(x) * psi.Value(x);
                          });
  };
  const double slope = psi.Slope(L);
  const double modal_mass_kg = integral([&](double x) { return psi.Value(x); }) + tip.mass_kg +
                               tip.inertia_kgm2 * slope * slope;
  const double start = figure.pinned ? psi.Slope(0.0) : psi.Curvature(0.0);
  const double scale = std::copysign(1.0 / std::sqrt(modal_mass_kg), start);
  return {.frequency_rad_s = psi.frequency_rad_s(),
          .beta_l = psi.beta_length(),
          .tip = scale,
          .tip_slope = scale * slope,
          .root_slope = scale * psi.Slope(0.0),
          .mass_integral = scale * integral([](double) { return 1.0; }),
          .moment_integral = scale * integral([](double x) { return x; })};
}

// Elastic mode of the arm at rest. The tip is that of link 2 against the end of link 1.
UnitMode ArmMode(const ArmParameters& arm, const PublishedFigure& figure) {
  const ArmModel model(arm, {kArmModes, kArmModes});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dof());
  q[kTheta2] = q[kTheta4] = figure.elbow_deg * kRadPerDeg;
  const bool held = figure.part == PublishedPart::kShoulderHeld;
  std::vector<int> kept;
  for (int i = 0; i < model.dof(); ++i) {
    if (!held || (i != kTheta1 && i != kTheta3)) kept.push_back(i);
  }
  const Eigen::MatrixXd M = model.MassMatrix(q)(kept, kept), K = model.stiffness()(kept, kept);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(K, M);
  const Eigen::Index at = figure.mode - 1 + (held ? 1 : 2);     // behind the rigid-body modes
  const Eigen::VectorXd shape = solver.eigenvectors().col(at);  // of unit modal mass
  const double hub2 = shape[held ? 0 : 1];
  const double sign = std::copysign(1.0, hub2);
  const double tip = hub2 * model.constants().L2 + shape.tail(kArmModes).sum();
  return {.frequency_rad_s = std::sqrt(solver.eigenvalues()[at]),
          .beta_l = 0.0,
          .tip = sign * tip,
          .tip_slope = 0.0,
          .root_slope = sign * hub2,
          .mass_integral = 0.0,
          .moment_integral = 0.0};
}

// Element of the mass matrix of the unbent arm whose rotors turn with their hubs.
double RigidInertia_kgm2(const ArmParameters& arm, const PublishedFigure& figure) {
  const ArmModel model(arm, {1, 1});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dof());
  q[kTheta2] = q[kTheta4] = figure.elbow_deg * kRadPerDeg;
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(model.dof(), 2);
  T(kTheta1, 0) = T(kTheta3, 0) = T(kTheta2, 1) = T(kTheta4, 1) = 1.0;
  const Eigen::Matrix2d M = T.transpose() * model.MassMatrix(q) * T;
  if (figure.quantity == Quantity::kInertia11) return M(0, 0);
  return figure.quantity == Quantity::kInertia12 ? M(0, 1) : M(1, 1);
}

double StripStiffness_nm_per_rad(const ArmParameters& arm, const PublishedFigure& figure) {
  const BeamSection& strip = LinkOf(arm, figure.part).section.back();
  return 3.0 * strip.bending_stiffness_nm2() / strip.length_m;
}

double Computed(const ArmParameters& arm, const PublishedFigure& figure) {
  const auto mode = [&] {
    const bool of_arm =
        figure.part == PublishedPart::kArm || figure.part == PublishedPart::kShoulderHeld;
    return of_arm ? ArmMode(arm, figure) : LinkMode(arm, figure);
  };
  const double scale = std::sqrt(figure.modal_mass_kg);
  switch (figure.quantity) {
    case Quantity::kFrequencyHz:
      return mode().frequency_rad_s / kTwoPi;
    case Quantity::kFrequencyRadS:
      return mode().frequency_rad_s;
    case Quantity::kBetaL:
      return mode().beta_l;
    case Quantity::kTip:
      return scale * mode().tip;
    case Quantity::kTipSlope:
      return scale * mode().tip_slope;
    case Quantity::kRootSlope:
      return scale * mode().root_slope;
    case Quantity::kMassIntegral:
      return scale * mode().mass_integral;
    case Quantity::kMomentIntegral:
      return scale * mode().moment_integral;
    case Quantity::kStripStiffness:
      return StripStiffness_nm_per_rad(arm, figure);
    case Quantity::kInertia11:
    case Quantity::kInertia12:
    case Quantity::kInertia22:
      return RigidInertia_kgm2(arm, figure);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

const char* NameOfQuantity(Quantity quantity) {
  constexpr std::array kNames = {"frequency, Hz",
                                 "frequency, rad/s",
                                 "beta L",
                                 "deflection at the tip",
                                 "slope at the tip",
                                 "slope at the root",
                                 "int rho A psi",
                                 "int rho A x psi",
                                 "3 EI/L of the strip, N m/rad",
                                 "inertia about joint 1, kg m2",
                                 "coupling of the joints, kg m2",
                                 "inertia about joint 2, kg m2"};
  return kNames[static_cast<std::size_t>(quantity)];
}

const char* NameOfPart(PublishedPart part) {
  constexpr std::array kNames = {"link 1", "link 1, joint 2 locked", "link 2", "arm",
                                 "arm, shoulder held"};
  return kNames[static_cast<std::size_t>(part)];
}

}  // namespace

bool PublishedResult::within_tolerance() const {
  return std::fabs(computed - figure.published) <= figure.tolerance;
}

std::vector<PublishedComparison> ComparePublished(const std::filesystem::path& file) {
  std::vector<PublishedComparison> all;
  for (PublishedCase& one : LoadPublishedCases(file)) {
    PublishedComparison comparison{.of = std::move(one), .result = {}};
    const ArmParameters arm = LoadConfig(comparison.of.config).arm;
    for (const PublishedFigure& figure : comparison.of.figure) {
      comparison.result.push_back({.figure = figure, .computed = Computed(arm, figure)});
    }
    all.push_back(std::move(comparison));
  }
  return all;
}

std::string LabelOf(const PublishedFigure& figure) {
  std::string text = NameOfPart(figure.part);
  if (figure.pinned) text += ", pinned";
  if (figure.mode > 0) text += ", mode " + std::to_string(figure.mode);
  return text + ": " + NameOfQuantity(figure.quantity);
}

}  // namespace flexarm
