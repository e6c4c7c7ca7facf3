#include "controller/law/adaptation_matrices.h"

#include "controller/law/design.h"

namespace flexarm {
namespace {

// A diagonal of `size` numbers, or all entries row by row.
Eigen::MatrixXd Square(const std::vector<double>& entries, Eigen::Index size) {
  if (static_cast<Eigen::Index>(entries.size()) == size) {
    return Eigen::VectorXd::Map(entries.data(), size).asDiagonal();
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return RowMajor::Map(entries.data(), size, size);
}

Eigen::MatrixXd SquareOr(const std::vector<double>& entries, Eigen::Index size, double otherwise) {
  if (entries.empty()) return otherwise * Eigen::MatrixXd::Identity(size, size);
  return Square(entries, size);
}

}  // namespace

Eigen::Matrix2d OutputFeedback(const ControllerConfig& config) {
  return SquareOr(config.matrices ? config.matrices->K_e : std::vector<double>{}, 2, 1.0);
}

AdaptationMatrices MatricesOf(const ControllerConfig& config, const Design& design) {
  const GainMatrixConfig given = config.matrices.value_or(GainMatrixConfig{});
  const Eigen::Index p = design.A.rows() + 4;
  AdaptationMatrices out{.T = SquareOr(given.T, p, config.adaptation_gain),
                         .Tbar = SquareOr(given.Tbar, p, config.adaptation_gain),
                         .S = SquareOr(given.S, 2, 1.0),
                         .K_e = OutputFeedback(config),
                         .K_I0 = {},
                         .Kbar = Eigen::MatrixXd(2, p)};
  out.Kbar << out.K_e, design.S21, design.S22;
  if (given.K_I0.size() > 1) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    out.K_I0 = RowMajor::Map(given.K_I0.data(), 2, p);
    return out;
  }
  out.K_I0 = given.K_I0.empty() ? out.Kbar : Eigen::MatrixXd(given.K_I0.front() * out.Kbar);
  return out;
}

}  // namespace flexarm
