#pragma once

#include <array>
#include <cmath>

namespace flexarm {

/// Contact state of dry friction at a hub during a step.
enum class Contact : signed char { kBackward = -1, kStuck = 0, kForward = 1 };

/// Hub accelerations of a step and their contact states.
struct FrictionSolution {
  std::array<double, 2> acceleration;  ///< rad/s^2
  std::array<Contact, 2> contact;
};

/// Two-contact linear complementarity problem of Coulomb friction (3.12) at the midpoint velocity
/// of a step, solved exactly.
///
///   Z a = r + lambda,  v_m = v + h/2 a,
///   lambda_i = -F_i sign(v_m,i) if v_m,i != 0, else |lambda_i| <= F_i.
/// Z is symmetric positive definite, so there is one solution; the nine combinations of
/// stuck/forward/backward are tried, the most likely first. A stuck hub gets a = -2 v / h: exactly
/// zero midpoint velocity, and exactly zero acceleration if it was at rest.
/// Real-time: safe.
class CoulombFrictionLcp {
 public:
  CoulombFrictionLcp(double z11, double z12, double z22, double r1, double r2) noexcept
      : z11_(z11), z12_(z12), z22_(z22), r1_(r1), r2_(r2) {}

  /// Without friction: Z a = r.
  FrictionSolution SolveFree() const noexcept {
    return {Slide(0.0, 0.0), {Contact::kForward, Contact::kForward}};
  }

  /// @param v  hub rates at the start of the step, rad/s
  /// @param F  friction torques, N m, >= 0
  /// @param h  step, s, > 0
  FrictionSolution Solve(const std::array<double, 2>& v, const std::array<double, 2>& F,
                         double h) const noexcept {
    FrictionSolution best = Try({Sign(v[0]), Sign(v[1])}, v, F, h);
    if (Holds(best, v, F, h)) return best;
    double least = Violation(best, v, F, h);
    for (const Contact c1 : {Contact::kStuck, Contact::kForward, Contact::kBackward}) {
      for (const Contact c2 : {Contact::kStuck, Contact::kForward, Contact::kBackward}) {
        const FrictionSolution trial = Try({c1, c2}, v, F, h);
        const double violation = Violation(trial, v, F, h);
        if (violation >= least) continue;
        best = trial;
        least = violation;
        if (least <= 0.0) return best;
      }
    }
    return best;  // at the boundary of two combinations: the smallest violation, which is round-off
  }

 private:
  static Contact Sign(double v) noexcept {
    return v > 0.0 ? Contact::kForward : v < 0.0 ? Contact::kBackward : Contact::kStuck;
  }

  std::array<double, 2> Slide(double lambda1, double lambda2) const noexcept {
    const double b1 = r1_ + lambda1, b2 = r2_ + lambda2;
    const double scale = 1.0 / (z11_ * z22_ - z12_ * z12_);
    return {scale * (z22_ * b1 - z12_ * b2), scale * (z11_ * b2 - z12_ * b1)};
  }

  FrictionSolution Try(const std::array<Contact, 2>& c, const std::array<double, 2>& v,
                       const std::array<double, 2>& F, double h) const noexcept {
    const double lambda1 = -F[0] * static_cast<double>(c[0]);
    const double lambda2 = -F[1] * static_cast<double>(c[1]);
    const double stop1 = -2.0 * v[0] / h, stop2 = -2.0 * v[1] / h;
    const bool stuck1 = c[0] == Contact::kStuck, stuck2 = c[1] == Contact::kStuck;
    if (stuck1 && stuck2) return {{stop1, stop2}, c};
    if (stuck1) return {{stop1, (r2_ + lambda2 - z12_ * stop1) / z22_}, c};
    if (stuck2) return {{(r1_ + lambda1 - z12_ * stop2) / z11_, stop2}, c};
    return {Slide(lambda1, lambda2), c};
  }

  // True if Violation is at most zero, without its divisions: nearly always of the first trial.
  bool Holds(const FrictionSolution& s, const std::array<double, 2>& v,
             const std::array<double, 2>& F, double h) const noexcept {
    const double a1 = s.acceleration[0], a2 = s.acceleration[1];
    const auto holds = [h](Contact contact, double rate, double a, double lambda, double most) {
      if (contact == Contact::kStuck) return std::fabs(lambda) <= most;
      return static_cast<double>(contact) * (rate + 0.5 * h * a) >= 0.0;
    };
    return holds(s.contact[0], v[0], a1, z11_ * a1 + z12_ * a2 - r1_, F[0]) &&
           holds(s.contact[1], v[1], a2, z12_ * a1 + z22_ * a2 - r2_, F[1]);
  }

  // Largest violation of a trial's own assumption, N m; <= 0 if there is none.
  double Violation(const FrictionSolution& s, const std::array<double, 2>& v,
                   const std::array<double, 2>& F, double h) const noexcept {
    const double a1 = s.acceleration[0], a2 = s.acceleration[1];
    const std::array<double, 2> lambda = {z11_ * a1 + z12_ * a2 - r1_, z12_ * a1 + z22_ * a2 - r2_};
    const std::array<double, 2> inertia = {z11_, z22_};
    double worst = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const double rate = v[i] + 0.5 * h * s.acceleration[i];
      const double broken = s.contact[i] == Contact::kStuck
                                ? std::fabs(lambda[i]) - F[i]
                                : -static_cast<double>(s.contact[i]) * rate * inertia[i] / h;
      worst = broken > worst ? broken : worst;
    }
    return worst;
  }

  double z11_, z12_, z22_, r1_, r2_;
};

}  // namespace flexarm
