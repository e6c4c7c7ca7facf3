#include "controller/health/drift_regression.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

constexpr double kFirm = 1e4;  // weight of a held mean against all that a run tells of it
constexpr int kRounds = 4;     // in which the middle half of a family settles

Eigen::MatrixXd Whole(const Eigen::MatrixXd& lower) {
  return lower.selfadjointView<Eigen::Lower>();
}

// Of a family, the half whose values lie nearest to its median.
std::vector<std::size_t> MiddleHalf(std::vector<std::size_t> family, const Eigen::VectorXd& value) {
  const auto at = [&value](std::size_t i) { return value(static_cast<Eigen::Index>(i)); };
  std::ranges::sort(family, [&at](std::size_t a, std::size_t b) { return at(a) < at(b); });
  const std::size_t drop = family.size() / 4;
  return {family.begin() + static_cast<std::ptrdiff_t>(drop),
          family.end() - static_cast<std::ptrdiff_t>(drop)};
}

}  // namespace

DriftRegression::DriftRegression(Settings settings)
    : settings_(std::move(settings)),
      prior_(Eigen::Map<const Eigen::VectorXd>(settings_.prior.data(),
                                               static_cast<Eigen::Index>(settings_.prior.size()))) {
  block_.push_back(EmptyBlock());
}

DriftRegression::Block DriftRegression::EmptyBlock() const {
  const Eigen::Index n = prior_.size();
  return {.information = Eigen::MatrixXd::Zero(n, n), .score = Eigen::VectorXd::Zero(n)};
}

// In units of the prior.
void DriftRegression::Add(const Eigen::MatrixXd& sensitivity, const Eigen::VectorXd& residual) {
  const Eigen::MatrixXd x = sensitivity * prior_.asDiagonal();
  Block& block = block_.back();
  block.information.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose());
  block.score.noalias() += x.transpose() * residual;
  squares_ += residual.squaredNorm();
  rows_ += static_cast<double>(residual.size());
}

void DriftRegression::EndSample() {
  if (++block_.back().samples < settings_.block_samples) return;
  if (block_.size() == kMostBlocks) MergePairs();
  block_.push_back(EmptyBlock());
}

void DriftRegression::MergePairs() {
  std::vector<Block> merged;
  for (std::size_t i = 0; i + 1 < block_.size(); i += 2) {
    Block& first = merged.emplace_back(std::move(block_[i]));
    first.information += block_[i + 1].information;
    first.score += block_[i + 1].score;
    first.samples += block_[i + 1].samples;
  }
  block_ = std::move(merged);
  settings_.block_samples *= 2;
}

Eigen::MatrixXd DriftRegression::Held(Eigen::MatrixXd information,
                                      const std::vector<std::size_t>& held) const {
  double largest = 1.0;
  for (const std::size_t i : held) {
    const auto at = static_cast<Eigen::Index>(i);
    largest = std::max(largest, information(at, at));
  }
  for (const std::size_t i : held) {
    for (const std::size_t j : held) {
      information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += kFirm * largest;
    }
  }
  return information;
}

DriftRegression::Solution DriftRegression::Minimise() const {
  const Eigen::Index n = prior_.size();
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(n, n);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
  for (const Block& block : block_) {
    information += Whole(block.information);
    score += block.score;
  }
  std::vector<std::vector<std::size_t>> held = settings_.family;
  Solution solution;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd firm = information;
    for (const std::vector<std::size_t>& family : held) firm = Held(std::move(firm), family);
    solution.normal.compute(firm);
    solution.x = solution.normal.solve(score);
    for (std::size_t i = 0; i < held.size(); ++i) {
      held[i] = MiddleHalf(settings_.family[i], solution.x);
    }
  }
  solution.explained = solution.x.dot(2.0 * score - information * solution.x);
  return solution;
}

double DriftRegression::Misfit() const {
  return rows_ > 0.0 ? (squares_ - Minimise().explained) / rows_ : 0.0;
}

std::vector<DriftFigure> DriftRegression::Solve() const {
  const Eigen::Index n = prior_.size();
  const Solution solution = Minimise();
  const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd white = solution.normal.solve(unit);
  Eigen::MatrixXd scores(n, static_cast<Eigen::Index>(block_.size()));
  for (std::size_t b = 0; b < block_.size(); ++b) {
    scores.col(static_cast<Eigen::Index>(b)) =
        block_[b].score - Whole(block_[b].information) * solution.x;
  }
  const Eigen::MatrixXd scattered = solution.normal.solve(scores);
  const auto blocks = static_cast<double>(block_.size());
  const double unbiased = blocks / std::max(1.0, blocks - 1.0);
  std::vector<DriftFigure> figures;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double variance = std::max(white(i, i), unbiased * scattered.row(i).squaredNorm());
    figures.push_back(
        {.value = prior_(i) * solution.x(i), .standard_error = prior_(i) * std::sqrt(variance)});
  }
  return figures;
}

}  // namespace flexarm
