#include "controller/law/reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "controller/law/motion_profile.h"
#include "controller/law/refused.h"

namespace flexarm {
namespace {

constexpr int kShortestMove = 10;        // periods: fewer are no smooth profile any more
constexpr double kGridTolerance = 1e-6;  // of a period: decimal times added in binary

int OnGrid(double time_s, double period_s, const std::string& what) {
  const double periods = time_s / period_s;
  if (std::fabs(periods - std::round(periods)) > kGridTolerance) {
    throw Refused(what + " = " + std::to_string(time_s) +
                  " s does not lie on the sampling grid: it must be a multiple of " +
                  std::to_string(period_s) + " s");
  }
  return static_cast<int>(std::lround(periods));
}

// Unit doublet over n samples: each value is held for one period, the sum is zero.
std::vector<double> Shape(DoubletShape shape, int n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    values[static_cast<std::size_t>(k)] = shape == DoubletShape::kSquare
                                              ? (2 * k < n ? 1.0 : -1.0)
                                              : std::sin(2.0 * std::numbers::pi * (k + 0.5) / n);
  }
  return values;
}

// Displacement of a unit inertia from rest under `shape`, at its end.
double Displacement(const std::vector<double>& shape, double period_s) {
  double displacement = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    displacement += shape[k] * (static_cast<double>(shape.size() - k) - 0.5) * period_s * period_s;
  }
  return displacement;
}

// Holds amplitude(i) * shape[k] from sample `first` on.
void Write(const Eigen::Vector2d& amplitude, const std::vector<double>& shape, int first,
           std::vector<ReferenceSample>* samples) {
  for (std::size_t k = 0; k < shape.size(); ++k) {
    ReferenceSample& sample = (*samples)[static_cast<std::size_t>(first) + k];
    for (std::size_t i = 0; i < 2; ++i) {
      sample.u_m_nm[i] = amplitude(static_cast<Eigen::Index>(i)) * shape[k];
    }
  }
}

Eigen::Vector2d Radians(const std::array<double, 2>& deg) {
  return Eigen::Vector2d(deg[0], deg[1]) * std::numbers::pi / 180.0;
}

void AddDoublet(const Doublet& doublet, std::size_t row, const Design& design, double period_s,
                std::vector<ReferenceSample>* samples) {
  const std::string name = "doublet[" + std::to_string(row) + "]";
  const int first = OnGrid(doublet.start_s, period_s, name + ".start_s");
  const int count = OnGrid(doublet.duration_s, period_s, name + ".duration_s");
  if (count < 2 || count % 2 != 0) {
    throw Refused(name + ".duration_s = " + std::to_string(doublet.duration_s) +
                  " s must be an even number of periods of " + std::to_string(period_s) +
                  " s, so that its two halves cancel");
  }
  const std::vector<double> shape = Shape(doublet.shape, count);
  const Eigen::Vector2d amplitude =
      design.rigid_inertia_kgm2 * Radians(doublet.move_deg) / Displacement(shape, period_s);
  Write(amplitude, shape, first, samples);
}

// A move by `by_rad`, with its row's number for messages.
void AddMove(const Move& move, std::size_t row, const Eigen::Vector2d& by_rad, const Design& design,
             double period_s, std::vector<ReferenceSample>* samples) {
  const std::string name = "move[" + std::to_string(row) + "]";
  const int first = OnGrid(move.start_s, period_s, name + ".start_s");
  const int count = OnGrid(move.duration_s, period_s, name + ".duration_s");
  if (count < kShortestMove) {
    throw Refused(name + ".duration_s = " + std::to_string(move.duration_s) +
                  " s must be at least " + std::to_string(kShortestMove) + " periods of " +
                  std::to_string(period_s) + " s");
  }
  Write(design.rigid_inertia_kgm2 * by_rad, QuinticAccelerations(count, period_s), first, samples);
}

void AddMoves(const Experiment& experiment, const Design& design, double period_s,
              const std::array<double, 2>& start_rad, std::vector<ReferenceSample>* samples) {
  Eigen::Vector2d place(start_rad[0], start_rad[1]);
  std::size_t doublets = 0;  // so many came before the move
  for (std::size_t row = 0; row < experiment.move.size(); ++row) {
    const Move& move = experiment.move[row];
    for (; doublets < experiment.doublet.size(); ++doublets) {
      if (experiment.doublet[doublets].start_s > move.start_s) break;
      place += Radians(experiment.doublet[doublets].move_deg);
    }
    AddMove(move, row, Radians(move.to_deg) - place, design, period_s, samples);
    place = Radians(move.to_deg);
  }
}

}  // namespace

ReferenceTable::ReferenceTable(const Experiment& experiment, const Design& design, double period_s,
                               const std::array<double, 2>& start_rad,
                               const std::array<double, 2>& limit_rad) {
  const int periods = OnGrid(experiment.duration_s, period_s, "duration_s");
  samples_.resize(static_cast<std::size_t>(periods) + 1);
  for (std::size_t row = 0; row < experiment.doublet.size(); ++row) {
    AddDoublet(experiment.doublet[row], row, design, period_s, &samples_);
  }
  AddMoves(experiment, design, period_s, start_rad, &samples_);
  rest_.x_m[0] = start_rad[0];
  rest_.x_m[1] = start_rad[1];
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(design.Am.rows());
  x_m.head<2>() << start_rad[0], start_rad[1];
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    ReferenceSample& sample = samples_[k];
    for (Eigen::Index i = 0; i < x_m.size(); ++i) sample.x_m[static_cast<std::size_t>(i)] = x_m(i);
    for (std::size_t i = 0; i < 2; ++i) {
      if (std::fabs(sample.x_m[i]) <= limit_rad[i]) continue;
      throw Refused("the reference of joint " + std::to_string(i + 1) + " reaches " +
                    std::to_string(sample.x_m[i] * 180.0 / std::numbers::pi) + " deg after " +
                    std::to_string(static_cast<double>(k) * period_s) + " s: the soft limit is " +
                    std::to_string(limit_rad[i] * 180.0 / std::numbers::pi) + " deg");
    }
    x_m = design.Am * x_m + design.Bm * Eigen::Vector2d(sample.u_m_nm[0], sample.u_m_nm[1]);
  }
  if (design.shaper.size() > 1) Shape(design.shaper, period_s);
}

// Weights that sum to one and are not negative: the shaped reference stays between the extremes of
// the unshaped one, so its limits hold.
void ReferenceTable::Shape(const Eigen::RowVectorXd& shaper, double period_s) {
  const auto moving = std::find_if(samples_.rbegin(), samples_.rend(), [](const auto& sample) {
    return sample.u_m_nm[0] != 0.0 || sample.u_m_nm[1] != 0.0;
  });
  const auto last_move = samples_.rend() - moving;
  const Eigen::Index end = last_move + shaper.size() - 1;
  if (end > periods()) {
    throw Refused("duration_s: the shaped reference takes " +
                  std::to_string(static_cast<double>(shaper.size() - 1) * period_s) +
                  " s longer than the moves and ends after " +
                  std::to_string(static_cast<double>(end) * period_s) +
                  " s: the experiment must last that long");
  }
  const std::vector<ReferenceSample> plain = samples_;
  const auto plain_at = [&](Eigen::Index k) -> const ReferenceSample& {
    return k < 0 ? rest_ : plain[static_cast<std::size_t>(k)];
  };
  for (Eigen::Index k = 0; k <= periods(); ++k) {
    ReferenceSample shaped{};
    for (Eigen::Index i = 0; i < shaper.size(); ++i) {
      const ReferenceSample& before = plain_at(k - i);
      for (std::size_t j = 0; j < 2; ++j) shaped.u_m_nm[j] += shaper(i) * before.u_m_nm[j];
      for (std::size_t j = 0; j < kMaxNominalStates; ++j) {
        shaped.x_m[j] += shaper(i) * before.x_m[j];
      }
    }
    samples_[static_cast<std::size_t>(k)] = shaped;
  }
}

ReferenceTable::ReferenceTable(const std::vector<std::array<double, 2>>& torque_nm)
    : samples_(torque_nm.size() + 1) {
  for (std::size_t k = 0; k < torque_nm.size(); ++k) samples_[k].u_m_nm = torque_nm[k];
}

const ReferenceSample& ReferenceTable::At(int k) const noexcept {
  if (k < 0) return rest_;
  return samples_[static_cast<std::size_t>(std::min(k, periods()))];
}

}  // namespace flexarm
