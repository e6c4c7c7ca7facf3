#include "model/beam_methods/link_torsion.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/beam/beam_equations.h"
#include "model/beam/dynamic_stiffness.h"
#include "model/beam/root_search_error.h"
#include "model/math/dense_decompositions.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kLowestTwist_rad_s = 1e-4, kHighestTwist_rad_s = 1e9;

// The frequency of the given order of a count that grows by one at each.
template <typename F>
double FrequencyOf(const F& count, int order) {
  double high = 1.0;
  while (high < kHighestTwist_rad_s && count(high) < order) high *= 2.0;
  double low = high;
  while (low > kLowestTwist_rad_s && count(low) >= order) low *= 0.5;
  if (high >= kHighestTwist_rad_s || low <= kLowestTwist_rad_s) {
    throw RootSearchError("twisting link", order, kLowestTwist_rad_s, kHighestTwist_rad_s,
                          "no natural frequency");
  }
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (count(middle) < order ? low : high) = middle;
  }
}

}  // namespace

RectangularSection::RectangularSection(const BeamSection& s)
    : thickness_m(std::sqrt(12.0 * s.second_moment_m4 / s.area_m2)) {
  width_m = s.area_m2 / thickness_m;
}

double RectangularSection::TorsionConstant_m4() const {
  const double h = std::min(width_m, thickness_m), b = std::max(width_m, thickness_m);
  double sum = 0.0;
  for (int n = 1; n < 40; n += 2) {
    sum += std::tanh(n * kPi * b / (2.0 * h)) / std::pow(n, 5);
  }
  return b * h * h * h / 3.0 * (1.0 - 192.0 / std::pow(kPi, 5) * h / b * sum);
}

double RectangularSection::SecondMomentAcross_m4() const {
  return thickness_m * width_m * width_m * width_m / 12.0;
}

TwistingLink::TwistingLink(const std::vector<BeamSection>& section, double poisson) {
  if (section.empty()) throw std::invalid_argument("TwistingLink: no section");
  if (!(poisson > -1.0 && poisson < 0.5)) {
    throw std::invalid_argument("TwistingLink: Poisson's ratio between -1 and 0.5");
  }
  for (const BeamSection& s : section) {
    const RectangularSection shape(s);
    const double G = s.youngs_modulus_pa / (2.0 * (1.0 + poisson));
    part_.push_back({s, G * shape.TorsionConstant_m4(),
                     s.density_kg_m3 * (s.second_moment_m4 + shape.SecondMomentAcross_m4())});
    length_m_ += s.length_m;
  }
}

double TwistingLink::Stiffness_nm_per_rad() const {
  double compliance = 0.0;
  for (const Part& part : part_) compliance += part.bending.length_m / part.shaft_nm2;
  return 1.0 / compliance;
}

double TwistingLink::StiffnessAcross_n_per_m() const {
  // int (L - x)^2 / (E I_across) dx
  double compliance = 0.0, x = 0.0;
  for (const Part& part : part_) {
    const double EI =
        part.bending.youngs_modulus_pa * RectangularSection(part.bending).SecondMomentAcross_m4();
    const double from = length_m_ - x, to = from - part.bending.length_m;
    compliance += (from * from * from - to * to * to) / (3.0 * EI);
    x += part.bending.length_m;
  }
  return 1.0 / compliance;
}

// Nodes: the outboard end of each part; w and w' of the nodes first if the link bends, then phi.
int TwistingLink::CountBelow(double omega, const TwistTip& tip, bool bends) const {
  const Index parts = static_cast<Index>(part_.size()), phi = bends ? 2 * parts : 0;
  const double w2 = omega * omega;
  MatrixXd K = MatrixXd::Zero(phi + parts, phi + parts);
  int count = 0;
  for (Index i = 0; i < parts; ++i) {
    const Part& part = part_[static_cast<std::size_t>(i)];
    if (bends) {
      const Eigen::Matrix4d section = SectionStiffness(part.bending, omega);
      count += CountClampedClamped(part.bending, omega);
      K.block<2, 2>(2 * i, 2 * i) += section.bottomRightCorner<2, 2>();
      if (i > 0) {
        K.block<2, 2>(2 * i - 2, 2 * i - 2) += section.topLeftCorner<2, 2>();
        K.block<2, 2>(2 * i - 2, 2 * i) += section.topRightCorner<2, 2>();
        K.block<2, 2>(2 * i, 2 * i - 2) += section.bottomLeftCorner<2, 2>();
      }
    }
    // A shaft: G I_t b [cot bl, -1/sin bl; .., cot bl], b = omega sqrt(rho I_p / (G I_t)).
    const double b = omega * std::sqrt(part.inertia_kgm / part.shaft_nm2);
    const double bl = b * part.bending.length_m, scale = part.shaft_nm2 * b;
    count += static_cast<int>(std::floor(bl / kPi));
    K(phi + i, phi + i) += scale / std::tan(bl);
    if (i > 0) {
      K(phi + i - 1, phi + i - 1) += scale / std::tan(bl);
      K(phi + i - 1, phi + i) -= scale / std::sin(bl);
      K(phi + i, phi + i - 1) -= scale / std::sin(bl);
    }
  }
  const Index end = phi + parts - 1;
  K(end, end) -= w2 * tip.axial_inertia_kgm2;
  if (bends) {
    const Index w = 2 * parts - 2;
    const double m = tip.bending.mass_kg, e = tip.offset_m;
    K(w, w) -= w2 * m;
    K(w + 1, w + 1) -= w2 * tip.bending.inertia_kgm2;
    K(end, end) -= w2 * m * e * e;
    K(w, end) -= w2 * m * e;
    K(end, w) -= w2 * m * e;
  }
  return count + CountNegativeEigenvalues(K);
}

double TwistingLink::TorsionHz(double axial_inertia_kgm2) const {
  const TwistTip tip{{0.0, 0.0}, 0.0, axial_inertia_kgm2};
  return FrequencyOf([&](double omega) { return CountBelow(omega, tip, false); }, 1) / kTwoPi;
}

std::vector<double> TwistingLink::CoupledHz(const TwistTip& tip, int count) const {
  std::vector<double> frequency_hz;
  for (int order = 1; order <= count; ++order) {
    frequency_hz.push_back(
        FrequencyOf([&](double omega) { return CountBelow(omega, tip, true); }, order) / kTwoPi);
  }
  return frequency_hz;
}

// Torque at the tip for a twist there of 1 rad that oscillates; the sections before it are reduced
// to their outboard ends one by one.
double TwistingLink::TorsionEnd(double omega) const {
  double inboard = 0.0;
  bool clamped = true;
  for (const Part& part : part_) {
    const double b = omega * std::sqrt(part.inertia_kgm / part.shaft_nm2);
    const double bl = b * part.bending.length_m, scale = part.shaft_nm2 * b;
    const double own = scale / std::tan(bl), across = scale / std::sin(bl);
    inboard = clamped ? own : own - across * across / (inboard + own);
    clamped = false;
  }
  return inboard;
}

// The row of the tip's twist: (k(w) - w^2 (I + m e^2)) phi = w^2 m e w.
double TwistingLink::TwistPerDeflection_rad_per_m(const TwistTip& tip, double frequency_hz) const {
  const double omega = kTwoPi * frequency_hz, w2 = omega * omega;
  const double m = tip.bending.mass_kg, e = tip.offset_m;
  return w2 * m * e / (TorsionEnd(omega) - w2 * (tip.axial_inertia_kgm2 + m * e * e));
}

}  // namespace flexarm
