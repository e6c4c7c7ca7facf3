#include "model/beam_methods/lumped_beam.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "model/beam/beam_equations.h"
#include "model/beam/root_search_error.h"

namespace flexarm {
namespace {

// Orthonormal columns that span the same, and the triangle that made them: before = after * R.
// R has a positive diagonal, so no sign is lost.
Eigen::Matrix2d Orthonormalise(Eigen::Matrix<double, 4, 2>* z) {
  Eigen::Matrix2d R = Eigen::Matrix2d::Zero();
  R(0, 0) = z->col(0).norm();
  z->col(0) /= R(0, 0);
  R(0, 1) = z->col(0).dot(z->col(1));
  z->col(1) -= R(0, 1) * z->col(0);
  R(1, 1) = z->col(1).norm();
  z->col(1) /= R(1, 1);
  return R;
}

int Negative(const Eigen::Matrix2d& D) {
  const double determinant = D.determinant();
  if (determinant < 0.0) return 1;
  return D.trace() < 0.0 ? 2 : 0;
}

}  // namespace

LumpedBeam::LumpedBeam(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root,
                       int parts, std::string name, LumpInertia lump_inertia)
    : root_(root), name_(std::move(name)) {
  CheckBeam(section, tip, root, 1, name_);
  if (parts < 1)
    throw std::invalid_argument(name_ + ": the number of parts per section must be at least 1");
  station_.push_back({0.0, 0.0, 0.0});
  double start = 0.0;
  for (const BeamSection& s : section) {
    const double l = s.length_m / parts, half = 0.5 * s.mass_per_length_kg_m() * l;
    const double turning = lump_inertia == LumpInertia::kSlab ? half * l * l / 12.0 : 0.0;
    for (int i = 1; i <= parts; ++i) {
      station_.back().mass_kg += half;
      station_.back().inertia_kgm2 += turning;
      station_.push_back({start + i * l, half, turning});
      part_.push_back({l, s.bending_stiffness_nm2()});
      unit_nm2_ = std::max(unit_nm2_, s.bending_stiffness_nm2());
    }
    start += s.length_m;
  }
  station_.back().mass_kg += tip.mass_kg;
  station_.back().inertia_kgm2 += tip.inertia_kgm2;
  unit_m_ = start;
}

// Inertia of K - w^2 M by its 2x2 pivots (Sylvester, Haynsworth), root to tip.
int LumpedBeam::CountBelow(double omega) const {
  const double w2 = omega * omega;
  Eigen::Matrix4d K = StaticStiffness(part_[0].length_m, part_[0].bending_stiffness_nm2);
  // The first station has w = 0; a clamped one has no degree of freedom left.
  Eigen::Matrix2d pivot = K.bottomRightCorner<2, 2>();
  int count = 0;
  if (!root_.clamped()) {
    const double turn = K(1, 1) + root_.stiffness_nm_per_rad - w2 * station_[0].inertia_kgm2;
    if (turn < 0.0) ++count;
    pivot -= K.block<2, 1>(2, 1) * K.block<1, 2>(1, 2) / turn;
  }
  for (std::size_t i = 1; i < station_.size(); ++i) {
    pivot(0, 0) -= w2 * station_[i].mass_kg;
    pivot(1, 1) -= w2 * station_[i].inertia_kgm2;
    if (i < part_.size()) {
      K = StaticStiffness(part_[i].length_m, part_[i].bending_stiffness_nm2);
      pivot += K.topLeftCorner<2, 2>();
    }
    count += Negative(pivot);
    if (i == part_.size()) break;
    const Eigen::Matrix2d next = K.bottomRightCorner<2, 2>() - K.bottomLeftCorner<2, 2>() *
                                                                   pivot.inverse() *
                                                                   K.topRightCorner<2, 2>();
    pivot = next;
  }
  return count;
}

LumpedBeam::Solutions LumpedBeam::RootSolutions() const {
  const double k = root_.stiffness_nm_per_rad * unit_m_ / unit_nm2_;
  Solutions z = Solutions::Zero();
  z(0, 0) = 1.0;  // shear
  if (root_.clamped()) {
    z(1, 1) = 1.0;
  } else {  // M = k theta
    z(1, 1) = k / std::hypot(1.0, k);
    z(2, 1) = 1.0 / std::hypot(1.0, k);
  }
  return z;
}

// (3.4) with -I_m, in states {-V l^2/EI, M l/EI, theta, w/l}.
Eigen::Matrix4d LumpedBeam::PointMatrix(std::size_t station, double omega) const {
  const double w2 = omega * omega, l = unit_m_;
  Eigen::Matrix4d P = Eigen::Matrix4d::Identity();
  P(0, 3) = w2 * station_[station].mass_kg * l * l * l / unit_nm2_;
  P(1, 2) = -w2 * station_[station].inertia_kgm2 * l / unit_nm2_;
  return P;
}

// (3.2)
Eigen::Matrix4d LumpedBeam::FieldMatrix(std::size_t part) const {
  const double l = part_[part].length_m / unit_m_;
  const double soft = unit_nm2_ / part_[part].bending_stiffness_nm2;
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(1, 0) = l;
  F(2, 0) = soft * l * l / 2.0;
  F(2, 1) = soft * l;
  F(3, 0) = soft * l * l * l / 6.0;
  F(3, 1) = soft * l * l / 2.0;
  F(3, 2) = l;
  return F;
}

double LumpedBeam::EndDeterminant(double omega) const {
  Solutions z = PointMatrix(0, omega) * RootSolutions();
  for (std::size_t i = 0; i < part_.size(); ++i) {
    z = PointMatrix(i + 1, omega) * (FieldMatrix(i) * z);
    Orthonormalise(&z);
  }
  return z.topRows<2>().determinant();
}

double LumpedBeam::FindFrequency(int order) const {
  constexpr double kHighest_rad_s = 1e12;
  double low = 0.0, high = 1.0;
  while (high < kHighest_rad_s && CountBelow(high) < order) high *= 2.0;
  const auto fail = [&](const char* reason) {
    throw RootSearchError(name_, order, low, high, reason);
  };
  if (high >= kHighest_rad_s) fail("no natural frequency; more parts are needed");
  const auto split = [&] {
    const double middle = 0.5 * (low + high);
    (CountBelow(middle) < order ? low : high) = middle;
  };
  while (high - low > 1e-3 * high || CountBelow(low) != order - 1 || CountBelow(high) != order) {
    if (high - low < 1e-13 * high) fail("two roots that cannot be distinguished");
    split();
  }
  double at_low = EndDeterminant(low);
  if (!(at_low * EndDeterminant(high) < 0.0)) {
    fail("the determinant of the end conditions does not change sign");
  }
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    const double at_middle = EndDeterminant(middle);
    const bool above = at_middle * at_low > 0.0;
    (above ? low : high) = middle;
    if (above) at_low = at_middle;
  }
}

LumpedMode LumpedBeam::ModeAt(double omega) const {
  std::vector<Solutions> at = {PointMatrix(0, omega) * RootSolutions()};
  std::vector<Eigen::Matrix2d> R;
  for (std::size_t i = 0; i < part_.size(); ++i) {
    Solutions z = PointMatrix(i + 1, omega) * (FieldMatrix(i) * at.back());
    R.push_back(Orthonormalise(&z));
    at.push_back(z);
  }
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(at.back().topRows<2>(), Eigen::ComputeFullV);
  Eigen::Vector2d c = svd.matrixV().col(1);
  c /= at.back().row(3).dot(c);
  LumpedMode mode{omega, {}, std::vector<double>(station_.size())};
  for (const Station& s : station_) mode.x_m.push_back(s.x_m);
  for (std::size_t i = station_.size(); i-- > 0;) {
    mode.w[i] = at[i].row(3).dot(c);
    if (i > 0) c = R[i - 1].triangularView<Eigen::Upper>().solve(c);
  }
  return mode;
}

std::vector<LumpedMode> LumpedBeam::Modes(int count) const {
  if (count < 1) throw std::invalid_argument(name_ + ": the number of modes must be at least 1");
  const int rigid = root_.stiffness_nm_per_rad == 0.0 ? 1 : 0;
  std::vector<LumpedMode> mode;
  for (int order = 1 + rigid; order <= count + rigid; ++order) {
    mode.push_back(ModeAt(FindFrequency(order)));
  }
  return mode;
}

}  // namespace flexarm
