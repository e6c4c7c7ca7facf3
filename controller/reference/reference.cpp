#include "controller/reference/reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "controller/reference/identification_torques.h"
#include "controller/reference/motion_check.h"
#include "controller/reference/path_check.h"
#include "controller/reference/reference_model.h"
#include "controller/reference/sampling_grid.h"
#include "controller/reference/shortest_move.h"
#include "controller/reference/trajectory.h"
#include "controller/types/motion_profile.h"
#include "controller/types/rejected_error.h"
#include "model/problem_list.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kHighestShareOfSampling = 0.25;  // of a chirp: four samples per oscillation

// Unit doublet over n samples: each value is held for one period, and the values sum to zero.
std::vector<double> Shape(DoubletShape shape, int n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k) {
    values[static_cast<std::size_t>(k)] = shape == DoubletShape::kSquare
                                              ? (2 * k < n ? 1.0 : -1.0)
                                              : std::sin(2.0 * std::numbers::pi * (k + 0.5) / n);
  }
  return values;
}

// Displacement of a unit inertia from rest at the end of `shape`.
double Displacement(const std::vector<double>& shape, double period_s) {
  double displacement = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    displacement += shape[k] * (static_cast<double>(shape.size() - k) - 0.5) * period_s * period_s;
  }
  return displacement;
}

Eigen::Vector2d Radians(const std::array<double, 2>& deg) {
  return {RadFromDeg(deg[0]), RadFromDeg(deg[1])};
}

/// Adds the torques of the rows, one after another, to the samples of an experiment.
class RowWriter {
 public:
  RowWriter(const Design& design, double period_s, std::vector<ReferenceSample>* samples)
      : design_(design), period_s_(period_s), samples_(samples) {}

  void Add(const Doublet& doublet, const std::string& row) {
    const int first = OnGrid(doublet.start_s, period_s_, row + ".start_s");
    const int count = OnGrid(doublet.duration_s, period_s_, row + ".duration_s");
    if (count < 2 || count % 2 != 0) {
      throw RejectedError(row + ".duration_s = " + NumberText(doublet.duration_s) +
                          " s must be an even number of periods of " + NumberText(period_s_) +
                          " s, so that its two halves cancel");
    }
    const std::vector<double> shape = Shape(doublet.shape, count);
    const Eigen::Vector2d amplitude =
        design_.rigid_inertia_kgm2 * Radians(doublet.move_deg) / Displacement(shape, period_s_);
    AddTorques(amplitude, shape, first, samples_);
  }

  void Add(const PlannedMove& move) {
    AddTorques(TorqueOf(move, design_), ProfileAccelerations(move.profile, move.periods, period_s_),
               move.first, samples_);
  }

  void Add(const Chirp& chirp, const std::string& row) {
    const int first = OnGrid(chirp.start_s, period_s_, row + ".start_s");
    const int count = OnGrid(chirp.duration_s, period_s_, row + ".duration_s");
    const double highest_hz = kHighestShareOfSampling / period_s_;
    for (const double hz : {chirp.from_hz, chirp.to_hz}) {
      if (hz <= highest_hz) continue;
      throw RejectedError(row + " sweeps to " + NumberText(hz) + " Hz: at most " +
                          NumberText(highest_hz) + " Hz, a quarter of the sampling rate");
    }
    if (count < 2) throw RejectedError(row + ".duration_s must be at least two periods");
    AddTorques(design_.rigid_inertia_kgm2 * Radians(chirp.amplitude_deg),
               HeldAccelerations(ChirpAngles(chirp, count, period_s_), period_s_), first, samples_);
  }

  void Add(const Prbs& prbs, const std::string& row) {
    const int first = OnGrid(prbs.start_s, period_s_, row + ".start_s");
    const int hold = OnGrid(prbs.hold_s, period_s_, row + ".hold_s");
    for (int joint = 0; joint < 2; ++joint) {
      const double torque_nm = prbs.torque_nm[static_cast<std::size_t>(joint)];
      AddTorques(torque_nm * Eigen::Vector2d::Unit(joint), PrbsSigns(prbs, hold, joint), first,
                 samples_);
    }
  }

  void Add(const CsvTrajectory& csv, const std::array<double, 2>& from_rad) {
    const int first = OnGrid(csv.start_s, period_s_, "csv.start_s");
    const auto angle_rad = TrajectoryOnGrid(csv, from_rad, period_s_);
    const std::size_t end = static_cast<std::size_t>(first) + angle_rad[0].size();
    if (end >= samples_->size()) {
      throw RejectedError(csv.file + ": the trajectory ends one period after its last row, at " +
                          NumberText(static_cast<double>(end) * period_s_) +
                          " s: the experiment must last that long");
    }
    for (Eigen::Index i = 0; i < 2; ++i) {
      AddTorques(design_.rigid_inertia_kgm2.col(i),
                 HeldAccelerations(angle_rad[static_cast<std::size_t>(i)], period_s_), first,
                 samples_);
    }
  }

 private:
  const Design& design_;
  double period_s_;
  std::vector<ReferenceSample>* samples_;
};

template <typename Row>
void AddRows(const std::vector<Row>& rows, const std::string& kind, RowWriter* writer) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    writer->Add(rows[i], ProblemList::Element(kind, i));
  }
}

// The row that began last before `time_s`.
std::string RowAt(const Experiment& experiment, double time_s) {
  std::string row = "duration_s";
  for (const Motion& motion : experiment.Motions()) {
    if (motion.start_s > time_s) break;
    row = motion.row;
  }
  return row;
}

// Text with the duration that would keep the limits, if there is one.
// @param moves  the moves up to and including the one that breaks a limit
std::string Remedy(std::span<const PlannedMove> moves, const Design& design, double period_s,
                   const MotionLimits& limits) {
  const PlannedMove& move = moves.back();
  const auto shortest = ShortestPeriods(moves, design, period_s, limits, 1.0);
  if (!shortest) {
    return std::string("; no duration_s up to ") + NumberText(kLongestChosen_s) +
           " keeps the limits" + (move.retargets ? " where the move retargets" : "");
  }
  if (!move.retargets && *shortest <= move.periods) return {};
  return std::string("; the shortest duration_s within the limits is ") +
         NumberText(InSeconds(*shortest, period_s));
}

}  // namespace

ReferenceTable::ReferenceTable(const Experiment& experiment, const Design& design, double period_s,
                               const std::array<double, 2>& start_rad, const MotionLimits& limits,
                               const std::stop_token& stop)
    : period_s_(period_s),
      moves_(PlanMoves(experiment, design, period_s, start_rad, limits, stop)),
      segments_(MotionSegmentsOf(moves_)) {
  const Experiment planned = WithChosenDurations(experiment, moves_, period_s);
  const int periods = OnGrid(planned.duration_s, period_s, "duration_s");
  samples_.resize(static_cast<std::size_t>(periods) + 1);
  // A law that follows a path needs one at rest as well.
  if (design.scheduled || !moves_.empty()) path_.emplace(moves_, start_rad, periods, period_s);
  if (design.scheduled) {
    plan_ = {.moves = moves_,
             .start_rad = start_rad,
             .end = static_cast<double>(periods),
             .time = PathTime(1.0)};
    FollowPath(planned, design, period_s);
  } else {
    FollowModel(planned, design, period_s, start_rad);
  }
  rest_.x_m = samples_.front().x_m;
  if (design.shaper.size() > 1) Shape(design.shaper, period_s);
  CheckLimits(planned, design, period_s, limits);
}

ReferenceTable::ReferenceTable(const ReferenceTable& before, int from, PathPlan plan,
                               const Design& design, const MotionLimits& limits)
    : period_s_(before.period_s_),
      arm_(before.arm_),
      reference_kg_(before.reference_kg_),
      rest_(before.rest_),
      plan_(std::move(plan)) {
  int end = 0;
  if (plan_->time.speed() == 0.0) {
    holds_at_ = std::max(plan_->time.settled(), from);
    end = holds_at_ + kChangeLead;
  } else {
    end = plan_->FirstSampleAt(plan_->end, from);
  }
  if (end * period_s_ > kLongestRun_s) {
    throw RejectedError("the run would take longer than " + NumberText(kLongestRun_s) + " s");
  }
  std::vector<RigidPoint> points;
  for (int k = 0; k <= end; ++k) {
    points.push_back(k < from ? before.path_->At(k) : plan_->At(k, period_s_));
  }
  path_.emplace(std::move(points));
  for (const PlannedMove& move : before.moves_) {
    if (move.first < from) moves_.push_back(move);
  }
  const double behind = plan_->time.At(from).periods;
  for (PlannedMove move : plan_->moves) {
    if (move.first < behind) continue;
    move.first = plan_->FirstSampleAt(move.first, from);
    if (move.first <= end) moves_.push_back(move);
  }
  samples_ = QuasiStaticReference(*path_, *arm_, reference_kg_, period_s_, 0, end);
  CheckPath(design, limits);
}

void ReferenceTable::FollowModel(const Experiment& planned, const Design& design, double period_s,
                                 const std::array<double, 2>& start_rad) {
  RowWriter writer(design, period_s, &samples_);
  AddRows(planned.doublet, "doublet", &writer);
  for (const PlannedMove& move : moves_) writer.Add(move);
  AddRows(planned.chirp, "chirp", &writer);
  AddRows(planned.prbs, "prbs", &writer);
  if (planned.csv) {
    writer.Add(*planned.csv, PlaceBefore(planned, moves_, start_rad, planned.csv->start_s));
  }
  RunReferenceModel(design, start_rad, &samples_);
}

void ReferenceTable::FollowPath(const Experiment& planned, const Design& design, double period_s) {
  for (const Motion& motion : planned.Motions()) {
    if (motion.row.starts_with("move[")) continue;
    throw RejectedError(
        motion.row +
        ": a law that estimates the payload follows [[move]] rows only, whose acceleration "
        "is continuous; use another controller.name, or moves");
  }
  arm_ = MakeRigidJointArm(design);
  reference_kg_ = design.scheduled->reference_kg;
  samples_ = QuasiStaticReference(*path_, *arm_, reference_kg_, period_s, 0, periods());
}

ReferenceSample ReferenceTable::Along(const std::array<RigidPoint, 3>& path) const noexcept {
  return QuasiStaticSample(*arm_, reference_kg_, path, period_s_);
}

void ReferenceTable::CheckPath(const Design& design, const MotionLimits& limits) const {
  const auto broken =
      PathCheck(design, limits, LimitShares::Of(1.0), period_s_).First(*path_, 0, periods());
  if (broken) throw RejectedError("the changed path: " + broken->text);
}

void ReferenceTable::CheckLimits(const Experiment& planned, const Design& design, double period_s,
                                 const MotionLimits& limits) const {
  const int states = static_cast<int>(design.Am.rows());
  const auto broken =
      design.scheduled
          ? PathCheck(design, limits, LimitShares::Of(1.0), period_s).First(*path_, 0, periods())
          : FirstBrokenLimit(samples_, states, limits, LimitShares::Of(1.0), period_s);
  if (!broken) return;
  const std::string row = RowAt(planned, broken->sample * period_s);
  std::string remedy;
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    if (row != ProblemList::Element("move", moves_[i].row)) continue;
    remedy = Remedy(std::span(moves_).first(i + 1), design, period_s, limits);
  }
  throw RejectedError(row + ": " + broken->text + remedy);
}

// The weights sum to one and are not negative: the shaped reference stays between the extremes of
// the unshaped one and keeps the same limits.
void ReferenceTable::Shape(const Eigen::RowVectorXd& shaper, double period_s) {
  const auto moving = std::find_if(samples_.rbegin(), samples_.rend(), [](const auto& sample) {
    return sample.u_m_nm[0] != 0.0 || sample.u_m_nm[1] != 0.0;
  });
  const auto last_move = samples_.rend() - moving;
  const Eigen::Index end = last_move + shaper.size() - 1;
  if (end > periods()) {
    throw RejectedError("duration_s: the shaped reference takes " +
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
