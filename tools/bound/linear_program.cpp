#include "tools/bound/linear_program.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace flexarm {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostIterations = 60;
constexpr double kGap = 1e-9, kResidual = 1e-8;
constexpr double kToBoundary = 0.995;  // of the step to the nearest zero slack or multiplier

// All inequalities G x <= g, in the order rows, upper bounds, lower bounds, with slacks s and
// multipliers y; G is [rows; I; -I].
class InteriorPoint {
 public:
  explicit InteriorPoint(const LinearProgram& program)
      : p_(program), n_(program.cost.size()), m_(program.limit.size()) {
    g_.resize(m_ + 2 * n_);
    g_ << p_.limit, p_.high, -p_.low;
    x_ = 0.5 * (p_.low + p_.high);
    scale_ = std::max(p_.cost.cwiseAbs().maxCoeff(), 1e-12);
    s_ = (g_ - Times(x_)).cwiseMax(1e-2);
    y_ = (0.1 * scale_) * s_.cwiseInverse();
  }

  std::optional<VectorXd> Solve() {
    for (int i = 0; i < kMostIterations; ++i) {
      r_dual_ = p_.cost + Transposed(y_);
      r_primal_ = Times(x_) + s_ - g_;
      const double gap = Gap();
      if (!std::isfinite(gap)) return std::nullopt;
      if (gap < kGap * scale_ && r_primal_.cwiseAbs().maxCoeff() < kResidual &&
          r_dual_.cwiseAbs().maxCoeff() < kResidual * scale_) {
        return x_;
      }
      Iterate(gap);
    }
    return std::nullopt;
  }

 private:
  struct Step {
    VectorXd x, s, y;
  };

  VectorXd Times(const VectorXd& x) const {
    VectorXd out(m_ + 2 * n_);
    out << p_.rows * x, x, -x;
    return out;
  }
  VectorXd Transposed(const VectorXd& y) const {
    return p_.rows.transpose() * y.head(m_) + y.segment(m_, n_) - y.tail(n_);
  }
  double Gap() const { return s_.dot(y_) / static_cast<double>(s_.size()); }

  // Newton's step towards s y = target.
  Step Towards(const VectorXd& target) const {
    const VectorXd weight = y_.cwiseQuotient(s_);
    const VectorXd missing = (s_.cwiseProduct(y_) - target).cwiseQuotient(s_);
    Step step;
    step.x = factor_.solve(-r_dual_ + Transposed(missing - weight.cwiseProduct(r_primal_)));
    step.s = -r_primal_ - Times(step.x);
    step.y = -missing - weight.cwiseProduct(step.s);
    return step;
  }

  static double Share(const VectorXd& value, const VectorXd& step) {
    double share = 1.0;
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      if (step[i] < 0.0) share = std::min(share, -value[i] / step[i]);
    }
    return share;
  }

  void Factorise() {
    const VectorXd weight = y_.cwiseQuotient(s_);
    const MatrixXd scaled = weight.head(m_).cwiseSqrt().asDiagonal() * p_.rows;
    MatrixXd H = MatrixXd::Zero(n_, n_);
    H.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
    H.diagonal() += weight.segment(m_, n_) + weight.tail(n_);
    factor_.compute(H);
  }

  void Iterate(double gap) {
    Factorise();
    const Step predicted = Towards(VectorXd::Zero(s_.size()));
    const double primal = Share(s_, predicted.s), dual = Share(y_, predicted.y);
    const double next =
        (s_ + primal * predicted.s).dot(y_ + dual * predicted.y) / static_cast<double>(s_.size());
    const double centre = std::pow(next / gap, 3);
    const VectorXd target =
        VectorXd::Constant(s_.size(), centre * gap) - predicted.s.cwiseProduct(predicted.y);
    const Step step = Towards(target);
    const double s_share = std::min(1.0, kToBoundary * Share(s_, step.s));
    const double y_share = std::min(1.0, kToBoundary * Share(y_, step.y));
    x_ += s_share * step.x;
    s_ += s_share * step.s;
    y_ += y_share * step.y;
  }

  const LinearProgram& p_;
  Eigen::Index n_, m_;
  double scale_ = 1.0;
  VectorXd g_, x_, s_, y_, r_dual_, r_primal_;
  Eigen::LLT<MatrixXd> factor_;
};

}  // namespace

std::optional<VectorXd> SolveLinearProgram(const LinearProgram& program) {
  return InteriorPoint(program).Solve();
}

}  // namespace flexarm
