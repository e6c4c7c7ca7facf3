#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "controller/law/gain_table.h"
#include "estimator/state_layout.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// Result of one check of a design.
struct DesignCheck {
  std::string name;  ///< e.g. "cgt-residual"
  double value;
  double limit;
  bool below;           ///< true: the value must be below the limit; false: above it
  bool waived = false;  ///< it failed and was overridden with `flexarm design --force`

  bool passed() const { return below ? value < limit : value > limit; }
};

/// Design of the laws that use the payload estimate (scheduled_law.h).
struct ScheduledDesign {
  GainTable gains;
  std::optional<GainTable> start_gains;  ///< of receding-horizon: for the start of a cold plan
  double max_kg;                         ///< moves keep the limits with this payload
  double reference_kg;                   ///< payload of the quasi-static reference
};

/// All matrices of the loop that are computed before it runs. SI, psi(L) = 1.
///
/// Names as in docs/theory/control-law.md 3 to 6 and thesis chapter 7. n states, 2 inputs.
struct Design {
  StateLayout layout{};            ///< of the nominal model, and so of x, x_m and all gains
  Eigen::MatrixXd A, B;            ///< nominal model, discrete
  Eigen::MatrixXd A_rate, B_rate;  ///< the same continuous, x' = A_rate x + B_rate u, 1/s
  Eigen::MatrixXd Am, Bm;          ///< reference model, discrete
  Eigen::MatrixXd K;  ///< 2 x n: LQR with degree of stability alpha; also the output matrix C_p
  Eigen::MatrixXd
      K_stop;  ///< 2 x n: LQR with alpha = 0 of the same weights, damps the arm while Stopping
  Eigen::MatrixXd P;                   ///< n x n: P' = e^(2 alpha Ts) P of the lemma (7.16)
  Eigen::MatrixXd J, G;                ///< 2 x 2: J = B'P'B/2, G = J + margin I
  Eigen::MatrixXd S11, S12, S21, S22;  ///< command generator: x* = S11 x_m + S12 u_m, u_c likewise
  Eigen::MatrixXd Ufx, Ufu;            ///< (7.25): u_f = -+Ufx x_m + Ufu u_m
  Eigen::MatrixXd filter_A, filter_B, filter_C, filter_L;  ///< estimator/kalman_design.h
  Eigen::MatrixXd filter_A_rate, filter_B_rate;            ///< the same, continuous
  Eigen::MatrixXd filter_W, filter_P, filter_R;            ///< covariances; R: one column
  Eigen::RowVectorXd
      shaper;  ///< weights of the samples of an input shaper (input_shaper.h); [1]: none
  std::vector<double> payload_model;         ///< of `ekf-payload`: PayloadModelConstants; or empty
  std::optional<GainTable> settle_gains;     ///< of `sobel` at rest (settle_term.h)
  std::optional<ScheduledDesign> scheduled;  ///< of the laws that use the payload estimate
  Eigen::Matrix2d rigid_inertia_kgm2;  ///< M_r at theta2 = 0: a doublet moves by M_r^-1 a T^2/4
  std::vector<DesignCheck> checks;

  bool sound() const;  ///< every check passed or was waived
};

/// The arm model of the payload estimator of `design` and of its planner.
RigidJointArm MakeRigidJointArm(const Design& design);

}  // namespace flexarm
