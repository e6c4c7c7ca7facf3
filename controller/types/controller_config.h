#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/types/law_table.h"
#include "estimator/state_layout.h"
#include "model/problem.h"

namespace flexarm {

enum class FeedforwardSign : std::uint8_t {
  kPrinted,    ///< (7.25) as printed: u_f = (B'B)^-1 B' (-(A_m - A) x_m + B_m u_m)
  kCorrected,  ///< the sign that follows from the derivation
};

/// Table [controller.payload]: settings of the laws that use the estimated payload.
struct PayloadLawConfig {
  double max_kg;                        ///< heaviest payload that moves are planned for
  std::array<double, 2> fast_fraction;  ///< share of the limits for moves of the shortest duration:
                                        ///< without payload, with max_kg
  double fast_least_s;                  ///< no such move is shorter
  double reference_kg;                  ///< the reference is the motion of an arm with this payload
  std::vector<double> gain_payload_kg;  ///< grid of the gain table, ascending from 0
  std::vector<double> gain_elbow_deg;   ///< |theta2|, ascending from 0
};

/// Table [controller.settling], optional: how `sobel` brings the arm to rest
/// (docs/theory/control-law.md 14). Distances are amplitudes of the tip: TipSway.
struct SettlingConfig {
  double alpha;                    ///< degree of stability of the gains at rest, 1/s
  double payload_filter_below_mm;  ///< the state is that of the payload filter
  double acts_below_mm;            ///< gains of the estimated payload, friction is compensated
  double hold_below_mm;            ///< the friction holds the arm again ..
  double release_above_mm;         ///< .. until the tip swings by more
  /// Of estimator.payload.process_force: less noise in the rates that are fed back.
  std::array<double, 6> process_force_share;
  double dead_band_counts;  ///< band about zero in which an encoder's innovation is no motion
};

inline constexpr int kMostReadyPeriods = 20;  ///< 0.4 s: shortest move, docs/theory/payload.md 3.1

/// Table [controller.plan]: settings of the receding-horizon planner;
/// controller/planner/plan_cost.h has the cost.
struct PlanAheadConfig {
  std::array<double, 12> moving_weight;   ///< diagonal of Q during a move, without payload
  std::array<double, 12> resting_weight;  ///< diagonal of Q from the end of the move on
  std::array<double, 2> torque_weight;    ///< diagonal of R
  double light_kg;      ///< Q during a move decreases as 1 / (1 + (payload / this)^2)
  double torque_share;  ///< share of the torque limits that a plan may use
  double start_alpha;   ///< degree of stability of the gains for a cold start, 1/s
  int every_periods;    ///< from one plan to the next
  int ready_periods;    ///< from the request of a plan to its first sample
  int rest_periods;     ///< part of a plan after the end of the move
  double roughness;     ///< see HorizonPlannerConfig, also for the next two
  double payload_change_kg;
  double payload_change_share;
};

/// Table [controller.matrices], optional: the gain matrices of Sobel's law, thesis (7.11) to (7.14)
/// and Appendix E. p = n + 4 entries of r = [y_e; x_m; u_m], 16 with R12. A key left out keeps the
/// default in brackets.
struct GainMatrixConfig {
  std::vector<double> T;     ///< p: diagonal; p p: row by row; symmetric [adaptation_gain I]
  std::vector<double> Tbar;  ///< likewise
  std::vector<double> S;     ///< 2: diagonal; 4: row by row [I]
  std::vector<double> K_e;   ///< likewise [I]
  std::vector<double> K_I0;  ///< 1: share of [K_e S21 S22]; 2 p: row by row [1]
};

/// Section [controller]. Symbols as in the thesis, chapter 7.
struct ControllerConfig {
  ControllerKind kind;  ///< key `name`
  StateLayout nominal;  ///< nominal model for law and filter, by its name: "R12"
  double alpha;         ///< prescribed degree of stability, 1/s, 0..10; see design_alpha
  double vartheta;      ///< weight of (7.24) against the CGT feedforward, 0..1
  double sigma;         ///< leakage of the adaptive gains per sample, 0..1
  FeedforwardSign feedforward_sign;
  std::array<double, 2> hub_angle_weight;  ///< Q on th1 th2
  std::array<double, 2> hub_rate_weight;   ///< Q on their rates
  /// Key `state_weight`, optional: the diagonal of Q, one number per state; replaces the two above.
  std::vector<double> state_weight;
  double torque_weight;                           ///< R = rho I
  double passivity_margin;                        ///< G = J + margin I, > 0
  double adaptation_gain;                         ///< T = Tbar = gain I_16, >= 0
  double adaptation_dead_zone_nm;                 ///< no adaptation while |y_e| is below this, >= 0
  double adaptation_bound;                        ///< largest |K_I - K_I(0)|, Frobenius, > 0
  std::array<double, 2> pd_stiffness_nm_per_rad;  ///< of the PD laws, on th1 th2
  std::array<double, 2> pd_damping_nms_per_rad;   ///< on their rates
  std::array<double, 2> payload_range_kg;  ///< least and greatest payload that the arm may carry:
                                           ///< the loop must be stable with each between them
  bool prediction;                         ///< one-sample open-loop prediction
  bool adaptation;  ///< false: u = u* + y_e, the same feedforward and feedback

  /// The degree of stability used in the design: 0 for sobel-original and lqg.
  double design_alpha() const {
    return kind == ControllerKind::kSobelOriginal || kind == ControllerKind::kLqg ? 0.0 : alpha;
  }

  std::optional<GainMatrixConfig> matrices{};  ///< of the adaptive laws
  std::optional<PayloadLawConfig> payload{};   ///< only for the laws that use the payload
  std::optional<PlanAheadConfig> plan{};       ///< only for `receding-horizon`
  std::optional<SettlingConfig> settling{};    ///< only for `sobel`; see ControlConfig::settles

  std::string
      gains_file;  ///< key `gains`, optional: written by `flexarm design`; empty: design at start

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
