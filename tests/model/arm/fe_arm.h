#pragma once

#include <cmath>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Finite-element model of the arm at rest, linear: a reference for the assumed modes that shares
/// nothing with them but the parameters. Hermite elements with consistent mass.
///
/// Unknowns: rotation of hub 1; deflection and slope of link 1's further nodes, across link 1 at
/// rest; rotation of hub 2; deflection and slope of link 2's further nodes, across link 2; both
/// rotors, that of motor 2 against the end of link 1. All but the last are absolute, so it contains
/// no mode shape, no elbow angle and no quadratic term of the model.
class FeArm {
 public:
  FeArm(const ArmParameters& p, double theta2_rad, int elements_per_section)
      : n1_(elements_per_section * static_cast<int>(p.link[0].section.size())),
        n2_(elements_per_section * static_cast<int>(p.link[1].section.size())),
        L1_(p.link[0].length_m()),
        L2_(p.link[1].length_m()),
        cos_(std::cos(theta2_rad)),
        M_(Eigen::MatrixXd::Zero(dof(), dof())),
        K_(M_) {
    const Row elbow = Unit(Deflection1(n1_)), slope = Unit(Slope1(n1_));
    const Row across = cos_ * elbow, along = std::sin(theta2_rad) * elbow;
    AddLink(p.link[0], elements_per_section, [&](int node, bool turn) -> Row {
      if (turn) return Unit(Slope1(node));
      return node == 0 ? Row(Row::Zero(dof())) : Unit(Deflection1(node));
    });
    AddLink(p.link[1], elements_per_section, [&](int node, bool turn) -> Row {
      if (turn) return Unit(Slope2(node));
      return node == 0 ? across : Unit(Deflection2(node));
    });
    const Row hub1 = Unit(Slope1(0)), hub2 = Unit(Slope2(0)), th3 = Unit(Rotor(1)),
              th4 = Unit(Rotor(2));
    AddSquare(&M_, along, p.link[1].mass_kg() + p.payload_mass_kg);
    AddSquare(&M_, elbow, p.motor2_mass_kg + p.hub2_mass_kg);
    AddSquare(&M_, slope, p.motor2_inertia_kgm2);
    AddSquare(&M_, slope + th4, p.joint[1].rotor_inertia_kgm2);
    AddSquare(&M_, th3, p.joint[0].rotor_inertia_kgm2);
    AddSquare(&M_, hub1, p.joint[0].hub_inertia_kgm2);
    AddSquare(&M_, hub2, p.joint[1].hub_inertia_kgm2);
    AddSquare(&M_, Unit(Deflection2(n2_)), p.payload_mass_kg);
    AddSquare(&M_, Unit(Slope2(n2_)), p.payload_inertia_kgm2);
    AddSquare(&K_, th3 - hub1, p.joint[0].stiffness_nm_per_rad);
    AddSquare(&K_, th4 - (hub2 - slope), p.joint[1].stiffness_nm_per_rad);
    tip_ = Eigen::MatrixXd::Zero(2, dof());  // displacement of the tip in frame 1
    const double c = cos_, s = std::sin(theta2_rad);
    const Row own = Unit(Deflection2(n2_));
    tip_.row(0) = c * along - s * own;
    tip_.row(1) = s * along + c * own;
  }

  int dof() const { return 1 + 2 * n1_ + 1 + 2 * n2_ + 2; }

  /// Non-zero frequencies with free motors, Hz, ascending.
  Eigen::VectorXd FreeFrequenciesHz() const {
    return FreeFrequenciesHz(Eigen::MatrixXd::Identity(dof(), dof()));
  }

  /// The same for an arm restricted to the columns of `basis`.
  Eigen::VectorXd FreeFrequenciesHz(const Eigen::MatrixXd& basis) const {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        basis.transpose() * K_ * basis, basis.transpose() * M_ * basis, Eigen::EigenvaluesOnly);
    const Eigen::VectorXd squares = eigen.eigenvalues().tail(basis.cols() - 2);
    return squares.cwiseSqrt() / (2.0 * M_PI);
  }

  /// All frequencies with both rotors held, Hz, ascending.
  Eigen::VectorXd HeldFrequenciesHz() const {
    const int kept = dof() - 2;  // the rotors come last
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        K_.topLeftCorner(kept, kept), M_.topLeftCorner(kept, kept), Eigen::EigenvaluesOnly);
    return eigen.eigenvalues().cwiseSqrt() / (2.0 * M_PI);
  }

  /// Unknowns while hubs and rotors turn and uniform links bend by shapes psi(x), psi'(x): columns
  /// th1, th2, th3, th4, shapes of link 1, shapes of link 2.
  template <typename Shape>
  Eigen::MatrixXd Basis(const std::vector<Shape>& psi1, const std::vector<Shape>& psi2) const {
    const auto m1 = static_cast<Eigen::Index>(psi1.size());
    const auto m2 = static_cast<Eigen::Index>(psi2.size());
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(dof(), 4 + m1 + m2);
    T(Slope1(0), 0) = T(Rotor(1), 2) = T(Rotor(2), 3) = 1.0;
    for (int node = 1; node <= n1_; ++node) {
      const double x = L1_ * node / n1_;
      T(Deflection1(node), 0) = x;
      T(Slope1(node), 0) = 1.0;
      for (Eigen::Index j = 0; j < m1; ++j) {
        T(Deflection1(node), 4 + j) = psi1[static_cast<std::size_t>(j)].Value(x);
        T(Slope1(node), 4 + j) = psi1[static_cast<std::size_t>(j)].Slope(x);
      }
    }
    const Row across = cos_ * T.row(Deflection1(n1_));
    const Row hub2 = T.row(Slope1(n1_)) + Row::Unit(T.cols(), 1);
    T.row(Slope2(0)) = hub2;
    for (int node = 1; node <= n2_; ++node) {
      const double x = L2_ * node / n2_;
      T.row(Deflection2(node)) = across + x * hub2;
      T.row(Slope2(node)) = hub2;
      for (Eigen::Index j = 0; j < m2; ++j) {
        T(Deflection2(node), 4 + m1 + j) = psi2[static_cast<std::size_t>(j)].Value(x);
        T(Slope2(node), 4 + m1 + j) = psi2[static_cast<std::size_t>(j)].Slope(x);
      }
    }
    return T;
  }

  /// Displacement of the tip under a small force there, both in frame 1, with both rotors held.
  Eigen::Vector2d TipDisplacement(const Eigen::Vector2d& force_n) const {
    const int kept = dof() - 2;  // the rotors come last
    const Eigen::VectorXd load = tip_.leftCols(kept).transpose() * force_n;
    return tip_.leftCols(kept) * K_.topLeftCorner(kept, kept).ldlt().solve(load);
  }

 private:
  using Row = Eigen::RowVectorXd;

  int Slope1(int node) const { return node == 0 ? 0 : 2 * node; }
  int Deflection1(int node) const { return 2 * node - 1; }
  int Slope2(int node) const { return 1 + 2 * n1_ + (node == 0 ? 0 : 2 * node); }
  int Deflection2(int node) const { return 1 + 2 * n1_ + 2 * node - 1; }
  int Rotor(int motor) const { return dof() - 3 + motor; }
  Row Unit(int i) const { return Row::Unit(dof(), i); }

  static void AddSquare(Eigen::MatrixXd* A, const Row& row, double factor) {
    *A += factor * row.transpose() * row;
  }

  template <typename NodeRow>
  void AddLink(const LinkParameters& link, int elements, const NodeRow& at) {
    int node = 0;
    for (const BeamSection& s : link.section) {
      const double l = s.length_m / elements;
      Eigen::Matrix4d mass, stiffness;
      mass << 156, 22 * l, 54, -13 * l,           //
          22 * l, 4 * l * l, 13 * l, -3 * l * l,  //
          54, 13 * l, 156, -22 * l,               //
          -13 * l, -3 * l * l, -22 * l, 4 * l * l;
      stiffness << 12, 6 * l, -12, 6 * l,       //
          6 * l, 4 * l * l, -6 * l, 2 * l * l,  //
          -12, -6 * l, 12, -6 * l,              //
          6 * l, 2 * l * l, -6 * l, 4 * l * l;
      for (int i = 0; i < elements; ++i, ++node) {
        Eigen::MatrixXd rows(4, dof());
        rows << at(node, false), at(node, true), at(node + 1, false), at(node + 1, true);
        const double rho_A = s.density_kg_m3 * s.area_m2;
        const double EI = s.youngs_modulus_pa * s.second_moment_m4;
        M_ += (rho_A * l / 420.0) * rows.transpose() * mass * rows;
        K_ += (EI / (l * l * l)) * rows.transpose() * stiffness * rows;
      }
    }
  }

  int n1_, n2_;
  double L1_, L2_, cos_;
  Eigen::MatrixXd M_, K_, tip_;
};

}  // namespace flexarm
