#include "estimator/estimator_config.h"

#include "model/problem_list.h"

namespace flexarm {

namespace {

void CheckPayload(const PayloadEstimatorConfig& p, ProblemList* list) {
  list->EachPositive("payload.process_force", p.process_force, 1e4,
                     "without process noise on every coordinate the filter ignores its sensors");
  list->EachWithin("payload.rotor_extra_sigma_rad", p.rotor_extra_sigma_rad, 0.0, 0.1,
                   "added to the quantisation of the rotor encoders");
  list->Positive("payload.max_kg", p.max_kg, 100.0, "the upper bound of the payload estimate");
  list->Within("payload.start_kg", p.start_kg, 0.0, 100.0,
               "the payload estimate before the first move");
  list->Positive("payload.start_sigma_kg", p.start_sigma_kg, 100.0,
                 "at zero standard deviation the payload is never estimated");
  list->Positive("payload.move_sigma_kg", p.move_sigma_kg, 100.0,
                 "at zero standard deviation a new payload is never estimated");
  list->Positive("payload.walk_kg", p.walk_kg, 1.0, "the payload's random walk per sample");
  list->Within("payload.min_rate_rad_s", p.min_rate_rad_s, 0.0, 10.0,
               "with both hubs slower the payload is not updated");
  list->EachPositive("payload.friction_start_sigma_nm", p.friction_start_sigma_nm, 100.0,
                     "at zero standard deviation the friction is never estimated");
  list->EachPositive("payload.friction_max_nm", p.friction_max_nm, 100.0,
                     "the upper bound of the Coulomb friction estimate");
  list->EachWithin("payload.friction_walk_nm", p.friction_walk_nm, 0.0, 1.0,
                   "the friction's random walk per sample");
  list->Within("payload.friction_min_rate_rad_s", p.friction_min_rate_rad_s, 0.0, 10.0,
               "the friction of a slower hub is not observable");
  list->Positive("payload.play_threshold_counts", p.play_threshold_counts, 1e3,
                 "counts of hub 2; a larger distance of its rotor is backlash");
  list->Within("payload.play_memory", p.play_memory, 0.0, 1.0,
               "the part of the backlash estimate kept after a sample");
  list->Within("payload.gate_sigmas", p.gate_sigmas, 1.0, 100.0,
               "an output beyond it is an outlier");
  if (!p.tip_extra_sigma_m_s2) return;
  list->Within("payload.tip_extra_sigma_m_s2", *p.tip_extra_sigma_m_s2, 0.0, 1e3,
               "the model error of the accelerometer's reading");
}

}  // namespace

std::vector<Problem> EstimatorConfig::Problems() const {
  ProblemList list("estimator.");
  list.Within("modes_per_link", modes_per_link, 1, 2, "modal coordinates fitted per link");
  list.EachPositive("process_force", process_force, 1e4,
                    "without process noise on every coordinate the filter ignores its sensors");
  list.EachWithin("hub_extra_sigma_rad", hub_extra_sigma_rad, 0.0, 0.1,
                  "standard deviation added to the quantisation of a hub encoder");
  list.EachWithin("rotor_extra_sigma_rad", rotor_extra_sigma_rad, 0.0, 0.1,
                  "added to the quantisation of the rotor encoders");
  list.EachPositive("modal_sigma_m", modal_sigma_m, 0.1,
                    "standard deviation of a fitted coordinate; at 0 the filter has no solution");
  list.Within("max_joint_rate_rad_s", max_joint_rate_rad_s, 0.1, 200.0,
              "a counter that changes faster is rejected as a jump");
  list.Positive("hub_rotor_limit_rad", hub_rotor_limit_rad, 1.0,
                "a larger angle between hub and rotor is a fault");
  list.Positive("strain_family_limit", strain_family_limit, 0.01,
                "unit strain; a channel farther from the fit is excluded");
  list.Positive("strain_stuck_limit", strain_stuck_limit, 0.01,
                "unit strain; a channel is stuck if constant while the fit changes by this");
  list.Positive("innovation_limit_rad", innovation_limit_rad, 3.2,
                "a larger innovation of a hub angle is a fault");
  list.Within("fault_ticks", fault_ticks, 1, 3, "a fault must be detected within three ticks");
  if (payload) CheckPayload(*payload, &list);
  return list.Take();
}

}  // namespace flexarm
