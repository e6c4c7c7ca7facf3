#pragma once

#include <array>
#include <limits>
#include <optional>
#include <stop_token>
#include <vector>

#include "controller/law/design.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/motion_plan.h"
#include "controller/reference/path_plan.h"
#include "controller/reference/path_reference.h"
#include "controller/types/experiment.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// A path that is changed while it is followed stays as it is for this many samples: the torque is
/// computed for an instant some samples ahead.
inline constexpr int kChangeLead = 10;

/// The reference of one experiment, computed when it is accepted, then constant.
///
/// Sample k holds at k Ts after the experiment's start. There is one sample more than the
/// experiment has periods, with u_m = 0: it holds after the end.
class ReferenceTable {
 public:
  /// Runs the reference model over the experiment's rows, from rest at `start_rad`.
  ///
  /// Each row is a command u_m; all but a PRBS are M_r times angular accelerations of the rigid
  /// arm:
  ///  - a doublet's amplitude is a = M_r dtheta / d, d the displacement of a unit inertia under its
  ///    sampled shape (T^2/4 for a square, thesis 7.5); its area is zero
  ///  - a move's are M_r (to - from) times ProfileAccelerations, a chirp's and a CSV trajectory's
  ///    HeldAccelerations of their angles
  /// so the reference model, a double integrator, ends at rest. A design with an input shaper
  /// convolves all that with its weights: every row then ends later by the length of the shaper.
  /// A design for a law that uses the estimated payload has QuasiStaticReference instead, for the
  /// reference payload; PathCheck checks the limits, and all rows must be moves, which may retarget
  /// each other.
  /// @throws RejectedError naming the row and key whose times do not lie on the grid of `period_s`,
  ///         the row, joint, instant and limit that the reference would break (FirstBrokenLimit),
  ///         or that the shaped rows would end after the experiment; or that a stop was requested
  ReferenceTable(const Experiment& experiment, const Design& design, double period_s,
                 const std::array<double, 2>& start_rad, const MotionLimits& limits,
                 const std::stop_token& stop = {});

  /// A reference whose path changes while it is followed: that of `before` until sample `from`,
  /// and along `plan` afterwards. It ends where the plan does; at rest on the path (speed 0) it
  /// holds and has a few samples more.
  /// @pre before.path_plan() is there; plan.time is as it was until `from`
  /// @throws RejectedError as above, or for a run longer than kLongestRun_s
  ReferenceTable(const ReferenceTable& before, int from, PathPlan plan, const Design& design,
                 const MotionLimits& limits);

  /// Open-loop torques without a reference model, for LoopMode::kOpenLoop.
  /// @param torque_nm  sample by sample, not empty; zero follows
  explicit ReferenceTable(const std::vector<std::array<double, 2>>& torque_nm);

  int periods() const noexcept { return static_cast<int>(samples_.size()) - 1; }

  /// The moves as data, in order of time; the path is that of the last move that has begun.
  const std::vector<PlannedMove>& moves() const noexcept { return moves_; }

  /// Where the path moves, in order of time. Real-time: safe.
  const std::vector<MotionSegment>& segments() const noexcept { return segments_; }

  /// The reference of a law that follows a path, for another motion than the table's: the sample
  /// that belongs to the path at k - 1, k and k + 1. Real-time: safe.
  /// @pre there is a move, and the law follows a path
  ReferenceSample Along(const std::array<RigidPoint, 3>& path) const noexcept;

  double period_s() const noexcept { return period_s_; }

  /// The path of a law that follows one, and the progress along it; else nothing.
  const std::optional<PathPlan>& path_plan() const noexcept { return plan_; }

  /// Sample at which a run stays until its path is changed: it is paused. INT_MAX: none. Real-time:
  /// safe.
  int holds_at() const noexcept { return holds_at_; }

  /// Sample k; before 0 the state of rest at the start, after the end the last sample. Real-time:
  /// safe.
  const ReferenceSample& At(int k) const noexcept;

  /// The rigid coordinate at k - 1, k and k + 1 by the moves, for any law; other rows are not
  /// included. Zero if there is no move and no law that follows a path. Real-time: safe.
  std::array<RigidPoint, 3> PathAround(int k) const noexcept {
    return path_ ? path_->Around(k) : std::array<RigidPoint, 3>{};
  }

 private:
  void Shape(const Eigen::RowVectorXd& shaper, double period_s);

  void CheckLimits(const Experiment& planned, const Design& design, double period_s,
                   const MotionLimits& limits) const;

  void CheckPath(const Design& design, const MotionLimits& limits) const;

  void FollowModel(const Experiment& planned, const Design& design, double period_s,
                   const std::array<double, 2>& start_rad);
  void FollowPath(const Experiment& planned, const Design& design, double period_s);

  double period_s_ = 0.0;
  std::optional<RigidJointArm> arm_;  ///< of a law that follows a path, with reference_kg_
  double reference_kg_ = 0.0;
  ReferenceSample rest_{};
  std::optional<RigidPath> path_;
  std::optional<PathPlan> plan_;
  int holds_at_ = std::numeric_limits<int>::max();
  std::vector<PlannedMove> moves_;
  std::vector<MotionSegment> segments_;
  std::vector<ReferenceSample> samples_;
};

}  // namespace flexarm
