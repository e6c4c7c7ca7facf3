#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "estimator/motion_prediction.h"
#include "estimator/payload_covariance.h"
#include "estimator/piecewise_torque.h"
#include "estimator/tip_output.h"
#include "model/rigid_joint/rigid_joint_step.h"
#include "model/rigid_joint/rigid_joint_transition.h"

namespace flexarm {

/// Settings of PayloadFilter. The design study's values: docs/theory/payload.md 2.
struct PayloadFilterConfig {
  std::array<double, 2> joint_stiffness_nm_per_rad;  ///< K1, K2: rotor angles are corrected by u/K
  /// Standard deviations of the generalised process forces on th1 th2 (N m) and the modal
  /// coordinates (N), held over a sample.
  std::array<double, 6> process_force;
  /// Of the outputs: hubs 1 and 2, rotors 1 and 2 (rad), modal coordinates (m).
  std::array<double, 8> output_sigma;
  std::uint32_t outputs;  ///< bit i: the rig measures output i
  /// Of each link, where the gauges are fitted with its first mode alone: the share of phi_f2 in
  /// that coordinate (unfitted_mode.h); otherwise 0.
  std::array<double, 2> second_in_first;
  /// Of the state at the start: q, q' and phi_f, rad and m, and per second.
  std::array<double, 16> start_sigma;

  double payload_start_kg, payload_start_sigma_kg;
  double payload_max_kg;          ///< the estimate stays in 0 .. this
  double payload_max_sigma_kg;    ///< bound on its standard deviation
  double payload_move_sigma_kg;   ///< least standard deviation at the start of a move
  double payload_walk_kg;         ///< standard deviation of its random walk per sample
  double payload_min_rate_rad_s;  ///< with both hubs slower it is not updated, due to backlash

  std::array<double, 2> friction_start_nm, friction_start_sigma_nm;
  std::array<double, 2> friction_max_nm;    ///< the estimates stay in 0 .. this
  std::array<double, 2> friction_walk_nm;   ///< standard deviation of the random walk per sample
  std::array<double, 2> friction_probe_nm;  ///< difference for the derivative, > 0
  double friction_min_rate_rad_s;           ///< the friction of a slower hub has no random walk

  /// Half the width of the band about zero in which the innovation of a hub or rotor counts as
  /// quantisation: it is zero within, and reduced by this beyond.
  std::array<double, 4> count_dead_band_rad;

  double play_threshold_rad;  ///< a larger distance of rotor 2 from hub 2 is backlash
  double play_memory;         ///< share of the largest such distance kept after a sample, 0..1
  double gate_sigmas;         ///< a single output beyond this is an outlier

  /// Of an accelerometer at the tip: standard deviation of its reading about the model's, and the
  /// lag of its analogue filter. Not used without readings.
  double tip_sigma_m_s2, tip_lag_s;
};

/// Extended Kalman filter that estimates state, payload and joint friction while the arm moves.
///
/// 19 states: q and q' of RigidJointArm, the gauges' filters phi_f, the payload m_p, the Coulomb
/// levels F_1, F_2. Outputs y = [th1, th2, th3 - u1/K1, th4 - u2/K2, phi_f]; a rig may lack those
/// of the rotors and of the second modes. A sample:
///   1. state by RigidJointStepper, its derivatives by TransitionOver and by differences;
///   2. P <- F P F' + s G Q G' + random walk, s in 1..30: grows with the normalised innovation
///      squared (NIS), so that with a wrong model old data count less;
///   3. the variance of rotor 2 is raised while joint 2 shows backlash; one or two outputs beyond
///      the gate get less weight; three or more mean a wrong model, and all keep their weight;
///   4. update with the payload's gain row zero at rest, and the friction's too after EndMove: the
///      covariance follows for that gain (PayloadCovariance::Reduce);
///   5. if the tip's acceleration was read, it updates the result of (4), gated and in the same
///      form. It is not part of NIS and innovation.
/// Source: docs/theory/payload.md 2. Real-time: all but the constructor is safe; every loop is
/// bounded.
class PayloadFilter {
 public:
  static constexpr int kStates = PayloadCovariance::kStates;
  static constexpr int kOutputs = 8;
  using Outputs = Eigen::Matrix<double, kOutputs, 1>;
  using Covariance = PayloadCovariance::Matrix;

  /// Measurements at the end of a sample.
  struct Reading {
    Outputs z;           ///< th1 th2 th3 th4 as counted, rad; fitted modal coordinates, m
    std::uint32_t good;  ///< bit i: z[i] was read; none: the frame was lost
    std::optional<double> tip_m_s2{};  ///< of the accelerometer at the tip
  };
  static constexpr std::uint32_t kAllGood = (1u << kOutputs) - 1;

  /// The estimate after a sample.
  struct Estimate {
    GaugedState state;
    double payload_kg, payload_sigma_kg;
    std::array<double, 2> friction_nm;
    /// Of this sample, scaled to 8 outputs where the rig has fewer: 8 expected; 0 without a frame.
    double nis;
    Outputs innovation;
    double tip_innovation_m_s2;  ///< of the accelerometer; 0 without its reading
  };

  /// First-order copy of this filter for another delay hypothesis: same gains and readings, another
  /// torque. The states differ by the effect of the torques that differed.
  struct Hypothesis {
    PiecewiseTorque torque;           ///< during the sample
    PayloadCovariance::Vector apart;  ///< its state minus this filter's
    Outputs innovation;               ///< of the last reading
    double nis;                       ///< of that innovation, by the covariance of this filter
  };

  PayloadFilter(RigidJointStepper stepper, const PayloadFilterConfig& config);

  /// Restarts at rest at q, with payload and friction at their start values.
  void Reset(const RigidJointArm::Vector& q) noexcept;

  /// The same, with P as the covariance of the state.
  void Reset(const RigidJointArm::Vector& q, const Covariance& P) noexcept;

  /// The covariance that rest with a straight elbow leads to after a Reset. Not for the loop: it
  /// takes as long as a hundred samples.
  Covariance CovarianceAfterRest() const noexcept;

  /// A move starts: the payload is updated again.
  /// @param same_load  it is that of the move before; otherwise PayloadMayChange
  void BeginMove(bool same_load) noexcept;

  /// The payload is another from now on: the estimate is at least that of the start, and its
  /// standard deviation that of the start of a move.
  void PayloadMayChange() noexcept;

  /// Resets the payload estimate to 0 kg after the readings contradicted the model. A lost payload
  /// is the likely cause, and the safe assumption: a torque for an empty arm does little to a
  /// loaded one.
  /// @param hypotheses  reset in the same way
  void AssumePayloadLost(std::span<Hypothesis> hypotheses = {}) noexcept;

  /// The arm is at rest: payload and friction are not updated until the next move. Encoder
  /// quantisation looks like motion to a filter whose covariance has grown, and would move both.
  void EndMove() noexcept { learns_ = false; }

  /// Switches to this delay hypothesis: copies its motion state and resets payload, friction and
  /// covariance to their start values, as they were estimated with wrong torques.
  void SwitchTo(const Hypothesis& hypothesis) noexcept;

  /// @param torque      applied during the sample that ends with the reading
  /// @param hypotheses  updated as well
  const Estimate& Update(const PiecewiseTorque& torque, const Reading& reading,
                         std::span<Hypothesis> hypotheses = {}) noexcept;

  const Estimate& estimate() const noexcept { return estimate_; }

  /// Prediction of the state after `torque`, with the current payload and friction estimates. Ends
  /// of pieces are rounded to the nearest step_s().
  GaugedState After(const PiecewiseTorque& torque) const noexcept;

  const RigidJointStepper& stepper() const noexcept { return stepper_; }
  /// NIS, smoothed: 8 for a right model.
  double mean_nis() const noexcept { return mean_nis_; }

 private:
  using Vector = PayloadCovariance::Vector;

  /// Row of the output matrix: x[state] + share x[second].
  struct Row {
    int state, second;
    double share;
  };

  static std::array<Row, kOutputs> RowsOf(const PayloadFilterConfig& config) noexcept;
  void ForgetAllButMotion() noexcept;
  void Add(const Vector& dx) noexcept;
  Eigen::Vector2d Torsion(const PiecewiseTorque& torque) const noexcept;
  void Predict(const PiecewiseTorque& torque, std::span<Hypothesis> hypotheses) noexcept;
  void PropagateCovariance(const PayloadCovariance::Change& change,
                           const Transition& transition) noexcept;
  MotionStart Start() const noexcept;
  Outputs OutputVariance(const Outputs& y, const Outputs& innovation, const Outputs& spread,
                         std::uint32_t good) noexcept;
  void CorrectByOutputs(const PiecewiseTorque& torque, const Outputs& z, std::uint32_t good,
                        std::span<Hypothesis> hypotheses) noexcept;
  void CorrectByTip(double reading_m_s2, const PiecewiseTorque& torque,
                    std::span<Hypothesis> hypotheses) noexcept;
  bool learns_payload() const noexcept;
  int Frozen() const noexcept;  // how many states are not updated: PayloadCovariance::Reduce

  RigidJointStepper stepper_;
  PayloadFilterConfig config_;
  std::array<Row, kOutputs> row_;
  double nis_scale_;  // 8 over the outputs of the rig
  Estimate estimate_;
  Covariance P_;
  double mean_nis_;
  bool learns_;
  double play_rad_;  // largest distance of rotor 2 from hub 2, decays slowly
};

}  // namespace flexarm
