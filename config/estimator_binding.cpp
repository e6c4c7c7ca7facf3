#include "config/rig_sections.h"

namespace flexarm {
namespace {

void ReadPayloadEstimator(TableReader payload, PayloadEstimatorConfig* out) {
  payload.Read(
      "process_force", &out->process_force,
      {"standard deviation of the unknown forces on th1 th2 f11 f12 f21 f22", "N m (2), N (4)"});
  payload.Read("rotor_extra_sigma_rad", &out->rotor_extra_sigma_rad,
               "added to the quantisation of each rotor encoder");
  payload.Read("start_kg", &out->start_kg, "estimated payload before the arm has moved");
  payload.Read("start_sigma_kg", &out->start_sigma_kg, "its standard deviation");
  payload.Read("max_kg", &out->max_kg, "upper bound of the estimate; its lower bound is 0");
  payload.Read(
      "move_sigma_kg", &out->move_sigma_kg,
      "least standard deviation when a move begins: the payload may have changed since the "
      "last one");
  payload.Read("walk_kg", &out->walk_kg, "standard deviation of the payload's change in a sample");
  payload.Read("min_rate_rad_s", &out->min_rate_rad_s,
               "while both hubs are slower, the payload is not estimated: backlash would bias it");
  payload.Read("friction_start_sigma_nm", &out->friction_start_sigma_nm,
               "standard deviation of the Coulomb friction of joint 1, 2 at the start");
  payload.Read("friction_max_nm", &out->friction_max_nm, "upper bound of the estimated friction");
  payload.Read("friction_walk_nm", &out->friction_walk_nm,
               "standard deviation of the friction's change in a sample");
  payload.Read("friction_min_rate_rad_s", &out->friction_min_rate_rad_s,
               "while a hub is slower, its friction is taken as constant");
  payload.Read("play_threshold_counts", &out->play_threshold_counts,
               "counts of hub 2; where rotor 2 is farther from its hub, that is backlash");
  payload.Read("play_memory", &out->play_memory,
               {"share of the largest such distance that is kept after a sample", "1"});
  payload.Read("gate_sigmas", &out->gate_sigmas,
               "a reading farther from its prediction is an outlier");
  payload.ReadIfGiven("tip_extra_sigma_m_s2", &out->tip_extra_sigma_m_s2,
                      "error of the model of the tip accelerometer's reading; needed with "
                      "[sensors.tip_accelerometer]");
  payload.ReadIfGiven("detect_delay", &out->detect_delay,
                      "true: an undeclared delay of whole samples is detected and compensated; "
                      "docs/timing.md");
}

void ReadChecks(TableReader estimator, EstimatorConfig* out) {
  estimator.Read("max_joint_rate_rad_s", &out->max_joint_rate_rad_s,
                 "a counter that changes faster has jumped: trip encoder-jump");
  estimator.Read("hub_rotor_limit_rad", &out->hub_rotor_limit_rad,
                 "largest angle between hub and rotor beyond the twist due to the torque: trip "
                 "hub-against-rotor; without a rotor encoder, between a hub and its reading that "
                 "repeats itself: trip estimator-residual");
  estimator.Read("strain_family_limit", &out->strain_family_limit,
                 {"a channel farther from the fit to its link is left out: trip "
                  "strain-out-of-family",
                  "strain"});
  estimator.Read("strain_stuck_limit", &out->strain_stuck_limit,
                 {"a channel that is constant while the fit changes by this is stuck: trip "
                  "strain-stuck",
                  "strain"});
  estimator.Read("innovation_limit_rad", &out->innovation_limit_rad,
                 "a hub angle farther from its prediction: trip estimator-residual");
  estimator.Read("fault_ticks", &out->fault_ticks,
                 {"samples in a row for which a check must fail to be a fault", "samples"});
}

}  // namespace

void ReadEstimator(TableReader estimator, EstimatorConfig* out) {
  estimator.Read("name", &out->kind,
                 {{"kalman", EstimatorKind::kKalman},
                  {"difference", EstimatorKind::kDifference},
                  {"polynomial", EstimatorKind::kPolynomial},
                  {"ekf-payload", EstimatorKind::kPayload},
                  {"ideal", EstimatorKind::kIdeal}},
                 "the state estimator; laws that follow the payload use \"ekf-payload\" whatever "
                 "stands here, \"ideal\" is for `flexarm simulate` only");
  estimator.Read("modes_per_link", &out->modes_per_link,
                 {"bending modes that are fitted to the gauges of a link", "modes"});
  estimator.Read("process_force", &out->process_force,
                 {"of \"kalman\": standard deviation of the unknown forces on th1 th2 f11 f12 f21 "
                  "f22; larger: the filter follows its sensors faster",
                  "N m (2), N (4)"});
  estimator.Read("rotor_extra_sigma_rad", &out->rotor_extra_sigma_rad,
                 "added to the quantisation of each rotor encoder");
  estimator.Read("hub_extra_sigma_rad", &out->hub_extra_sigma_rad,
                 "added to the quantisation of each hub encoder: what a hub does beyond the model");
  estimator.Read("modal_sigma_m", &out->modal_sigma_m,
                 "standard deviation of the modal coordinates f11 f12 f21 f22 that are fitted to "
                 "the gauges");
  ReadChecks(estimator, out);
  if (estimator.Has("payload")) {
    ReadPayloadEstimator(
        estimator.Table("payload",
                        "the estimator \"ekf-payload\", which the laws that follow the payload "
                        "need; docs/theory/payload.md"),
        &out->payload.emplace());
  }
}

}  // namespace flexarm
