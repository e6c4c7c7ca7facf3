#include "estimator/filter_covariance.h"

namespace flexarm {

FilterCovariance::FilterCovariance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                   const Eigen::MatrixXd& W, const Eigen::VectorXd& R,
                                   const Eigen::MatrixXd& steady)
    : A_(A), C_(C), W_(W), steady_(steady), R_(R), P_(steady) {}

void FilterCovariance::Correct(const Outputs& y, std::uint32_t good, bool complete,
                               State* x) noexcept {
  if (steady()) P_ = steady_;
  settled_ = complete ? settled_ + 1 : 0;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if ((good >> i & 1u) == 0) continue;
    const State Pc = P_.lazyProduct(C_.row(i).transpose());
    const double variance = C_.row(i).dot(Pc) + R_(i);
    const State gain = Pc / variance;
    *x += gain * (y(i) - C_.row(i).dot(*x));
    P_ -= gain.lazyProduct(Pc.transpose());
  }
  const Square AP = A_.lazyProduct(P_);
  P_ = AP.lazyProduct(A_.transpose());
  if (complete) P_ += W_;
  P_ = (0.5 * (P_ + P_.transpose())).eval();  // symmetric in spite of rounding
}

}  // namespace flexarm
