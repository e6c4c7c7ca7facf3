#include "model/beam_methods/exact_arm.h"

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "model/beam/dynamic_stiffness.h"
#include "model/beam/root_search_error.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kLowestArm_rad_s = 1e-3, kHighestArm_rad_s = 1e9;

// Where the displacements of a node of a link are in the vector of all displacements.
struct LinkNodes {
  Index first;  // [w w'] of the root, then of each node
  Index size;
};

// Dynamic stiffness of a free-free link in the displacements of its nodes.
MatrixXd LinkStiffness(const LinkParameters& link, double omega) {
  const Index n = 2 * static_cast<Index>(link.section.size()) + 2;
  MatrixXd K = MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < link.section.size(); ++i) {
    const Index at = 2 * static_cast<Index>(i);
    K.block<4, 4>(at, at) += SectionStiffness(link.section[i], omega);
  }
  return K;
}

}  // namespace

ExactArm::ExactArm(const ArmParameters& parameters, double theta2_rad)
    : parameters_(parameters), theta2_rad_(theta2_rad) {
  if (const auto problems = parameters.Problems(); !problems.empty()) {
    throw std::invalid_argument("ExactArm: " + problems.front().rule);
  }
}

// Displacements: link 1's nodes, link 2's nodes (root deflection and angle in link 2's own frame),
// then the angles of the rotors 1 and 2, all against the base. The root of link 2 is the end of
// link 1: its deflection across link 2 is w_e cos(theta2), and w_e sin(theta2) moves all of link 2
// along itself.
int ExactArm::CountBelow(double omega, bool motors_held) const {
  const ArmParameters& p = parameters_;
  const MatrixXd K1 = LinkStiffness(p.link[0], omega), K2 = LinkStiffness(p.link[1], omega);
  const LinkNodes one{0, K1.rows()}, two{K1.rows(), K2.rows()};
  const Index rotor1 = one.size + two.size, rotor2 = rotor1 + 1, all = rotor2 + 1;
  const double w2 = omega * omega;
  MatrixXd K = MatrixXd::Zero(all, all);
  K.block(one.first, one.first, one.size, one.size) += K1;
  K.block(two.first, two.first, two.size, two.size) += K2;
  const Index end1 = one.first + one.size - 2, end2 = two.first + two.size - 2;
  const auto spring = [&](Index a, Index b, double k) {
    K(a, a) += k, K(b, b) += k, K(a, b) -= k, K(b, a) -= k;
  };
  spring(rotor1, one.first + 1, p.joint[0].stiffness_nm_per_rad);
  spring(rotor2, two.first + 1, p.joint[1].stiffness_nm_per_rad);
  K(rotor1, rotor1) -= w2 * p.joint[0].rotor_inertia_kgm2;
  K(rotor2, rotor2) -= w2 * p.joint[1].rotor_inertia_kgm2;
  K(one.first + 1, one.first + 1) -= w2 * p.joint[0].hub_inertia_kgm2;
  K(two.first + 1, two.first + 1) -= w2 * p.joint[1].hub_inertia_kgm2;
  const double s = std::sin(theta2_rad_), c = std::cos(theta2_rad_);
  const double along_kg = p.link[1].mass_kg() + p.payload_mass_kg;
  K(end1, end1) -= w2 * (p.motor2_mass_kg + p.hub2_mass_kg + s * s * along_kg);
  K(end1 + 1, end1 + 1) -= w2 * p.motor2_inertia_kgm2;
  K(end2, end2) -= w2 * p.payload_mass_kg;
  K(end2 + 1, end2 + 1) -= w2 * p.payload_inertia_kgm2;
  // The free displacements: all but link 1's root deflection, link 2's, and the held rotors.
  const Index kept = all - 2 - (motors_held ? 2 : 0);
  MatrixXd P = MatrixXd::Zero(all, kept);
  Index column = 0;
  for (Index row = 1; row < all; ++row) {
    if (row == two.first || (motors_held && row >= rotor1)) continue;
    P(row, column++) = 1.0;
  }
  P.row(two.first) = c * P.row(end1);
  if (motors_held) P.row(rotor2) = P.row(end1 + 1);
  int count = CountNegativeEigenvalues(P.transpose() * K * P);
  for (const LinkParameters& link : p.link) {
    for (const BeamSection& section : link.section) count += CountClampedClamped(section, omega);
  }
  return count;
}

double ExactArm::FrequencyHz(int order, bool motors_held) const {
  double high = 1.0;
  while (high < kHighestArm_rad_s && CountBelow(high, motors_held) < order) high *= 2.0;
  double low = high;
  while (low > kLowestArm_rad_s && CountBelow(low, motors_held) >= order) low *= 0.5;
  if (high >= kHighestArm_rad_s || low <= kLowestArm_rad_s) {
    throw RootSearchError("arm", order, kLowestArm_rad_s, kHighestArm_rad_s,
                          "no natural frequency");
  }
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle / kTwoPi;
    (CountBelow(middle, motors_held) < order ? low : high) = middle;
  }
}

std::vector<double> ExactArm::FrequenciesHz(int count, bool motors_held) const {
  const int rigid = motors_held ? 0 : 2;
  std::vector<double> frequency_hz;
  for (int order = 1 + rigid; order <= count + rigid; ++order) {
    frequency_hz.push_back(FrequencyHz(order, motors_held));
  }
  return frequency_hz;
}

}  // namespace flexarm
