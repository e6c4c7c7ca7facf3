#include "model/beam/beam_modes.h"

#include <cmath>
#include <stdexcept>

#include "model/beam/beam_basis.h"
#include "model/beam/beam_equations.h"
#include "model/beam/dynamic_stiffness.h"
#include "model/beam/root_search_error.h"
#include "model/math/dense_decompositions.h"
#include "model/units.h"

namespace flexarm {
namespace {

// Frequencies beyond these bounds mean that the beam's parameters are wrong.
constexpr double kLowest_rad_s = 1e-9, kHighest_rad_s = 1e12;

double FindFrequency(const std::vector<BeamSection>& section, const BeamTip& tip, int order,
                     BeamRoot root, const std::string& name) {
  const auto count = [&](double omega) { return CountFrequenciesBelow(section, tip, omega, root); };
  double high = 1.0;
  while (high < kHighest_rad_s && count(high) < order) high *= 2.0;
  double low = high;
  while (low > kLowest_rad_s && count(low) >= order) low *= 0.5;
  if (high >= kHighest_rad_s || low <= kLowest_rad_s) {
    throw RootSearchError(name, order, kLowest_rad_s, kHighest_rad_s, "no natural frequency");
  }
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    (count(middle) < order ? low : high) = middle;
  }
}

// Newton on the smallest singular value of the matching matrix. Counting cannot miss a root, but
// with very short sections their stiffness (12 EI/l^3) loses digits; matching does not. A step
// larger than the uncertainty of counting means two roots that close: the counted value is kept.
double Polished(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root,
                double counted) {
  constexpr double kDelta = 1e-4;  // difference step: its error only slows the convergence
  double omega = counted;
  for (int i = 0; i < 3; ++i) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(MatchingMatrix(section, tip, omega, root),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Index last = svd.singularValues().size() - 1;
    const Eigen::VectorXd u = svd.matrixU().col(last), v = svd.matrixV().col(last);
    const double above = u.dot(MatchingMatrix(section, tip, omega * (1.0 + kDelta), root) * v);
    const double below = u.dot(MatchingMatrix(section, tip, omega * (1.0 - kDelta), root) * v);
    omega -= svd.singularValues()[last] * 2.0 * kDelta * omega / (above - below);
  }
  return std::abs(omega / counted - 1.0) < 1e-6 ? omega : counted;
}

BeamMode ModeAt(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root,
                double omega) {
  const Eigen::MatrixXd A = MatchingMatrix(section, tip, omega, root);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  Eigen::VectorXd c = svd.matrixV().col(A.cols() - 1);
  c /= BasisRow(section.back(), omega, section.back().length_m, 0).dot(c.tail<4>());
  std::vector<BeamMode::Piece> piece;
  double start = 0.0;
  for (std::size_t i = 0; i < section.size(); ++i) {
    const BeamSection& s = section[i];
    const double beta = Beta(s, omega);
    const Eigen::Vector4d k = c.segment<4>(4 * static_cast<Eigen::Index>(i));
    piece.push_back(
        {start, s.length_m, beta, UseDecayingBasis(beta * s.length_m), {k[0], k[1], k[2], k[3]}});
    start += s.length_m;
  }
  return BeamMode(omega, std::move(piece));
}

}  // namespace

BeamMode::BeamMode(double frequency_rad_s, std::vector<Piece> piece)
    : frequency_rad_s_(frequency_rad_s),
      length_m_(piece.back().start_m + piece.back().length_m),
      piece_(std::move(piece)) {}

double BeamMode::Derivative(double x_m, int order) const {
  std::size_t i = piece_.size() - 1;
  while (i > 0 && x_m < piece_[i].start_m) --i;
  const Piece& p = piece_[i];
  const auto f = BeamBasis(p.decaying, p.beta_per_m, p.length_m, x_m - p.start_m, order);
  const double sum = p.c[0] * f[0] + p.c[1] * f[1] + p.c[2] * f[2] + p.c[3] * f[3];
  return sum * std::pow(p.beta_per_m, order);
}

int CountFrequenciesBelow(const std::vector<BeamSection>& section, const BeamTip& tip,
                          double frequency_rad_s, BeamRoot root) {
  const Eigen::Index n = 2 * static_cast<Eigen::Index>(section.size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + 2, n + 2);
  int count = 0;
  for (std::size_t i = 0; i < section.size(); ++i) {
    const Eigen::Index at = 2 * static_cast<Eigen::Index>(i);
    K.block<4, 4>(at, at) += SectionStiffness(section[i], frequency_rad_s);
    count += CountClampedClamped(section[i], frequency_rad_s);
  }
  const double w2 = frequency_rad_s * frequency_rad_s;
  K(n, n) -= w2 * tip.mass_kg;
  K(n + 1, n + 1) -= w2 * tip.inertia_kgm2;
  if (!root.clamped()) K(1, 1) += root.stiffness_nm_per_rad;
  const Eigen::Index free = root.clamped() ? n : n + 1;  // w(0) = 0 in any case
  return count + CountNegativeEigenvalues(K.bottomRightCorner(free, free));
}

void CheckBeam(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root,
               int count, const std::string& name) {
  const auto require = [&](bool ok, const char* rule) {
    if (!ok) throw std::invalid_argument(name + ": " + rule);
  };
  require(!section.empty(), "a beam needs at least one section");
  require(count >= 1, "the number of modes must be at least 1");
  require(tip.mass_kg >= 0.0 && tip.inertia_kgm2 >= 0.0,
          "tip mass and inertia must not be negative");
  require(root.stiffness_nm_per_rad >= 0.0, "the root's stiffness must not be negative");
  for (const BeamSection& s : section) {
    require(s.length_m > 0.0 && s.mass_per_length_kg_m() > 0.0 && s.bending_stiffness_nm2() > 0.0,
            "length, rho A and EI must be positive");
  }
}

double PinnedFrequency(const std::vector<BeamSection>& section, const BeamTip& tip, int order) {
  CheckBeam(section, tip, BeamRoot::Pinned(), order, "pinned beam");
  if (order == 1) return 0.0;
  return NaturalModes(section, tip, BeamRoot::Pinned(), order - 1, "pinned beam")
      .back()
      .frequency_rad_s();
}

std::vector<BeamMode> NaturalModes(const std::vector<BeamSection>& section, const BeamTip& tip,
                                   BeamRoot root, int count, const std::string& name) {
  CheckBeam(section, tip, root, count, name);
  const int rigid = root.stiffness_nm_per_rad == 0.0 ? 1 : 0;
  std::vector<BeamMode> mode;
  for (int order = 1 + rigid; order <= count + rigid; ++order) {
    const double counted = FindFrequency(section, tip, order, root, name);
    mode.push_back(ModeAt(section, tip, root, Polished(section, tip, root, counted)));
  }
  return mode;
}

std::vector<BeamMode> ClampedModes(const std::vector<BeamSection>& section, const BeamTip& tip,
                                   int count, const std::string& name) {
  return NaturalModes(section, tip, BeamRoot::Clamped(), count, name);
}

}  // namespace flexarm
