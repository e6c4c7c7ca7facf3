// Statements of 3.6, 6.2, 6.5.1 and 7.2 on the linearised arm a second time, with mass_point_arm.h:
// buckling in place of eigenvalues over the rate, Runge-Kutta and the matrix exponential in place
// of the midpoint rule, and the determinant of the system in place of eigenvalues and zeros.
// Expected figures are those of docs/thesis-check.md, as printed: they may differ by half their
// last digit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/math/discretize.h"
#include "model/units.h"
#include "tests/tools/thesis/second_method/mass_point_arm.h"
#include "tests/tools/thesis/second_method/shipped_arm.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using second_method::Complex;
using second_method::MassPointArm;

constexpr int kElements = 20;

VectorXd Elbow(const MassPointArm& arm, double degrees) {
  VectorXd q = VectorXd::Zero(arm.dof());
  q[1] = q[3] = degrees * kRadPerDeg;
  return q;
}

// 3.6: the rate at which the links buckle, K + rate^2 F = singular but for a turn of the whole arm;
// and the lowest frequency at 4 rad/s.
TEST(SecondMethod, TheArmBucklesAtSuchARate) {
  const MassPointArm arm(ShippedArm(), 4, kElements);
  const VectorXd q = Elbow(arm, 0.0);
  VectorXd v = VectorXd::Zero(arm.dof());
  v[0] = v[2] = 1.0;
  const MatrixXd F = arm.BiasByPosition(q, v);
  const Index n = arm.dof() - 1;  // th1 turned against th3: without the turn of the whole arm
  MatrixXd relative = MatrixXd::Identity(arm.dof(), arm.dof()).rightCols(n);
  const MatrixXd K = relative.transpose() * arm.stiffness() * relative;
  const MatrixXd G = relative.transpose() * F * relative;
  const auto determinant_sign = [&](double rate) {
    return (K + rate * rate * G).partialPivLu().determinant() > 0.0;
  };
  double low = 0.1, high = 8.0;
  ASSERT_NE(determinant_sign(low), determinant_sign(high));
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (determinant_sign(middle) == determinant_sign(0.1) ? low : high) = middle;
  }
  EXPECT_NEAR(low, 5.227, 5.1e-4);
  const MatrixXd Q2 = arm.Mass(q).llt().solve(arm.stiffness() + 16.0 * F);
  VectorXd squares = Q2.eigenvalues().real();
  std::sort(squares.begin(), squares.end());
  const auto lowest = std::upper_bound(squares.begin(), squares.end(), 100.0);
  EXPECT_NEAR(std::sqrt(*lowest) / kTwoPi, 5.92, 0.005);
}

// Largest relative difference of a coordinate between the arm and its linear model over 3 s, from
// rest at 45 deg, under a period of a square wave of 1 s.
double LinearError(const MassPointArm& arm, const Eigen::Vector2d& torque_nm) {
  constexpr double kStep_s = 5e-4;
  const Index n = arm.dof();
  const VectorXd q0 = Elbow(arm, 45.0);
  const auto rate = [&](const VectorXd& x, const Eigen::Vector2d& u) {
    const VectorXd q = x.head(n), v = x.tail(n);
    VectorXd out(2 * n);
    out << v, arm.Mass(q).llt().solve(arm.Input() * u - arm.Bias(q, v) - arm.damping() * v -
                                      arm.stiffness() * q);
    return out;
  };
  const Eigen::LLT<MatrixXd> mass(arm.Mass(q0));
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n), B = MatrixXd::Zero(2 * n, 2);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -mass.solve(arm.stiffness());
  A.bottomRightCorner(n, n) = -mass.solve(arm.damping());
  B.bottomRows(n) = mass.solve(arm.Input());
  const DiscreteModel held = ZeroOrderHold(A, B, kStep_s);
  VectorXd x = VectorXd::Zero(2 * n), linear = x;
  x.head(n) = q0;
  VectorXd size = VectorXd::Zero(n), error = size;
  for (int k = 0; k < static_cast<int>(std::lround(3.0 / kStep_s)); ++k) {
    const double time_s = k * kStep_s;
    const double sign = time_s < 0.5 - 1e-9 ? 1.0 : time_s < 1.0 - 1e-9 ? -1.0 : 0.0;
    const Eigen::Vector2d u = sign * torque_nm;
    const VectorXd k1 = rate(x, u), k2 = rate(x + 0.5 * kStep_s * k1, u),
                   k3 = rate(x + 0.5 * kStep_s * k2, u), k4 = rate(x + kStep_s * k3, u);
    x += kStep_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    linear = held.A * linear + held.B * u;
    const VectorXd moved = x.head(n) - q0;
    size = size.cwiseMax(moved.cwiseAbs());
    error = error.cwiseMax((moved - linear.head(n)).cwiseAbs());
  }
  return error.cwiseQuotient(size).maxCoeff();
}

// 6.2, with two modes a link.
TEST(SecondMethod, SmallMotionsAreLinear) {
  const MassPointArm arm(ShippedArm(), 2, 8);
  const double small = 100.0 * LinearError(arm, {0.004, 0.001});
  EXPECT_NEAR(small, 0.077, 5e-4);
  const double large = 100.0 * LinearError(arm, {0.4, 0.1});
  EXPECT_NEAR(large, 8.2, 0.05);
}

// The arm at rest as a polynomial in s: M s^2 + D s + K, with two outputs and the torques that hold
// them where there are outputs.
class Pencil {
 public:
  Pencil(const MassPointArm& arm, const VectorXd& q, MatrixXd outputs)
      : M_(arm.Mass(q)),
        D_(arm.damping()),
        K_(arm.stiffness()),
        B_(arm.Input()),
        C_(std::move(outputs)) {}

  MatrixXcd At(Complex s) const {
    const Index n = M_.rows(), m = C_.rows();
    MatrixXcd P = MatrixXcd::Zero(n + m, n + m);
    P.topLeftCorner(n, n) = s * s * M_ + s * D_ + K_.cast<Complex>();
    if (m > 0) {
      P.topRightCorner(n, m) = B_.cast<Complex>();
      P.bottomLeftCorner(m, n) = C_.cast<Complex>();
    }
    return P;
  }
  /// det / |det|.
  Complex Phase(Complex s) const {
    const Eigen::PartialPivLU<MatrixXcd> lu(At(s));
    Complex phase = static_cast<double>(lu.permutationP().determinant());
    for (const Complex& pivot : lu.matrixLU().diagonal()) phase *= pivot / std::abs(pivot);
    return phase;
  }
  /// Power of s with which the determinant vanishes at the origin: the number of poles there.
  int PolesAtOrigin() const {
    constexpr double kSmall = 1e-3;  // far below the first frequency, 6.6 Hz
    const auto log_size = [this](double s) {
      return At(s).partialPivLu().matrixLU().diagonal().cwiseAbs().array().log().sum();
    };
    return static_cast<int>(
        std::lround((log_size(2.0 * kSmall) - log_size(kSmall)) / std::log(2.0)));
  }
  void AddDamping(const MatrixXd& damping) { D_ += damping; }
  /// A root near s, by Newton's method on 1 / trace(P^-1 P').
  Complex Root(Complex s) const {
    for (int i = 0; i < 50; ++i) {
      const Index n = M_.rows();
      MatrixXcd slope = MatrixXcd::Zero(At(s).rows(), At(s).cols());
      slope.topLeftCorner(n, n) = 2.0 * s * M_ + D_.cast<Complex>();
      const Complex step = 1.0 / At(s).partialPivLu().solve(slope).trace();
      s -= step;
      if (std::abs(step) < 1e-12 * std::abs(s)) break;
    }
    return s;
  }

 private:
  MatrixXd M_, D_, K_, B_, C_;
};

// Roots in the right half plane by the argument principle: up the imaginary axis, back by the half
// circle. Roots on the axis have no place here: everything but the turns of the whole arm decays.
int RightHalfRoots(const Pencil& pencil) {
  constexpr double kLow = 1e-3, kHigh = 1e8, kSmallTurn = 0.3;
  double turned = 0.0;
  const auto along = [&](const auto& point, double from, double to, auto&& self) -> void {
    const Complex a = pencil.Phase(point(from)), m = pencil.Phase(point(0.5 * (from + to))),
                  b = pencil.Phase(point(to));
    const double first = std::arg(m / a), second = std::arg(b / m);
    if (std::abs(first) + std::abs(second) < kSmallTurn || to - from < 1e-9) {
      turned += first + second;
      return;
    }
    self(point, from, 0.5 * (from + to), self);
    self(point, 0.5 * (from + to), to, self);
  };
  const auto up = [](double log_w) { return Complex(0.0, std::exp(log_w)); };
  const auto down = [](double log_w) { return Complex(0.0, -std::exp(-log_w)); };
  const auto big = [kHigh](double angle) { return std::polar(kHigh, -angle); };
  const auto small = [kLow](double angle) { return std::polar(kLow, angle); };
  const auto walk = [&](const auto& point, double from, double to) {
    constexpr int kParts = 400;
    for (int i = 0; i < kParts; ++i) {
      along(point, from + (to - from) * i / kParts, from + (to - from) * (i + 1) / kParts, along);
    }
  };
  walk(down, -std::log(kHigh), -std::log(kLow));
  walk(small, -0.5 * M_PI, 0.5 * M_PI);
  walk(up, std::log(kLow), std::log(kHigh));
  walk(big, -0.5 * M_PI, 0.5 * M_PI);
  return static_cast<int>(std::lround(-turned / kTwoPi));
}

MatrixXd Rows(const MassPointArm& arm, Index first, bool with_deflection) {
  MatrixXd C = MatrixXd::Zero(2, arm.dof());
  const Index modes = (arm.dof() - 4) / 2;
  for (const Index i : {0, 1}) {
    C(i, first + i) = 1.0;
    if (!with_deflection) continue;
    C.row(i)
        .segment(4 + i * modes, modes)
        .setConstant(1.0 / arm.link(static_cast<std::size_t>(i)).length_m);
  }
  return C;
}

// 7.2: zeros in the right half plane and the nearest of them to 0.
TEST(SecondMethod, ZerosInTheRightHalfPlane) {
  const MassPointArm arm(ShippedArm(), 4, kElements);
  const VectorXd straight = Elbow(arm, 0.0), bent = Elbow(arm, 45.0);
  const Pencil ends(arm, straight, Rows(arm, 0, true)), hubs(arm, straight, Rows(arm, 0, false)),
      rotors(arm, straight, Rows(arm, 2, false)), tip(arm, bent, arm.TipByPosition(bent));
  EXPECT_EQ(RightHalfRoots(ends), 3);
  EXPECT_EQ(RightHalfRoots(tip), 7);
  EXPECT_EQ(RightHalfRoots(hubs), 0);
  EXPECT_EQ(RightHalfRoots(rotors), 0);
  EXPECT_NEAR(std::abs(ends.Root(280.0)), 282.0, 0.5);
  EXPECT_NEAR(std::abs(tip.Root(75.0)), 75.5, 0.05);
}

// 7.2: without friction and with that of 6.2, smoothed by 50 s/rad.
TEST(SecondMethod, PolesAtTheOrigin) {
  const ArmParameters shipped = ShippedArm();
  const MassPointArm arm(shipped, 4, kElements);
  Pencil pencil(arm, Elbow(arm, 0.0), MatrixXd(0, arm.dof()));
  EXPECT_EQ(pencil.PolesAtOrigin(), 4);
  MatrixXd friction = MatrixXd::Zero(arm.dof(), arm.dof());
  for (const Index i : {0, 1}) {
    friction(i, i) = 50.0 * shipped.joint[static_cast<std::size_t>(i)].coulomb_friction_nm;
  }
  pencil.AddDamping(friction);
  EXPECT_EQ(pencil.PolesAtOrigin(), 2);
}

// 6.5.1: roots that do not oscillate are changes of the determinant's sign along the negative axis.
TEST(SecondMethod, RootsThatDoNotOscillate) {
  const MassPointArm arm(ShippedArm(), 10, 40);
  const VectorXd q = Elbow(arm, 0.0);
  const Pencil pencil(arm, q, MatrixXd(0, arm.dof()));
  // The slow roots of the higher modes of a link pile up at K / D: points are dense there.
  std::vector<double> points;
  for (int i = 0; i <= 4000; ++i) points.push_back(std::pow(10.0, i / 400.0));
  for (const Index phi : {4, 14}) {
    const double pile = arm.stiffness()(phi, phi) / arm.damping()(phi, phi);
    for (int i = 0; i <= 2000; ++i) {
      const double off = std::pow(10.0, -6.0 + i / 400.0);
      points.insert(points.end(), {pile * (1.0 + off), pile / (1.0 + off)});
    }
  }
  std::sort(points.begin(), points.end());
  int changes = 0;
  double before = pencil.Phase(-points.front()).real();
  for (const double point : points) {
    const double now = pencil.Phase(-point).real();
    changes += now * before < 0.0 ? 1 : 0;
    before = now;
  }
  EXPECT_EQ(changes, 28);
  const Complex lowest = pencil.Root(Complex(-4.0, 41.0));
  EXPECT_NEAR(-lowest.real() / std::abs(lowest), 0.11, 0.005);
}

}  // namespace
}  // namespace flexarm
