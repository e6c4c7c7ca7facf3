#include "estimator/estimator_config.h"

#include "model/problem_list.h"

namespace flexarm {

namespace {

void CheckPayload(const PayloadEstimatorConfig& p, ProblemList* list) {
  list->EachPositive("payload.process_force", p.process_force, 1e4,
                     "without process noise on every coordinate the filter ignores its sensors");
  list->EachWithin("payload.rotor_extra_sigma_rad", p.rotor_extra_sigma_rad, 0.0, 0.1,
                   "added to the quantisation of the rotor encoders");
  list->Positive("payload.max_kg", p.max_kg, 100.0, "the heaviest payload that is believed");
  list->Within("payload.start_kg", p.start_kg, 0.0, 100.0, "the payload before the first move");
  list->Positive("payload.start_sigma_kg", p.start_sigma_kg, 100.0,
                 "without doubt the payload is never found");
  list->Positive("payload.move_sigma_kg", p.move_sigma_kg, 100.0,
                 "without doubt a new payload is never found");
  list->Positive("payload.walk_kg", p.walk_kg, 1.0, "the payload's change in a sample");
  list->Within("payload.min_rate_rad_s", p.min_rate_rad_s, 0.0, 10.0,
               "with both hubs slower the payload is not learnt");
  list->EachPositive("payload.friction_start_sigma_nm", p.friction_start_sigma_nm, 100.0,
                     "without doubt the friction is never found");
  list->EachPositive("payload.friction_max_nm", p.friction_max_nm, 100.0,
                     "the largest Coulomb friction that is believed");
  list->EachWithin("payload.friction_walk_nm", p.friction_walk_nm, 0.0, 1.0,
                   "the friction's change in a sample");
  list->Within("payload.friction_min_rate_rad_s", p.friction_min_rate_rad_s, 0.0, 10.0,
               "a slower hub does not show its friction");
  list->Positive("payload.play_threshold_counts", p.play_threshold_counts, 1e3,
                 "counts of hub 2 between it and its rotor that are play, not quantisation");
  list->Within("payload.play_memory", p.play_memory, 0.0, 1.0, "kept of the play after a sample");
  list->Within("payload.gate_sigmas", p.gate_sigmas, 1.0, 100.0, "beyond it an output is a glitch");
  if (!p.tip_extra_sigma_m_s2) return;
  list->Within("payload.tip_extra_sigma_m_s2", *p.tip_extra_sigma_m_s2, 0.0, 1e3,
               "what the model lacks of the accelerometer's reading");
}

}  // namespace

std::vector<Problem> EstimatorConfig::Problems() const {
  ProblemList list("estimator.");
  list.Within("modes_per_link", modes_per_link, 1, 2, "modal coordinates that are fitted a link");
  list.EachPositive("process_force", process_force, 1e4,
                    "without process noise on every coordinate the filter ignores its sensors");
  list.EachWithin("rotor_extra_sigma_rad", rotor_extra_sigma_rad, 0.0, 0.1,
                  "added to the quantisation of the rotor encoders");
  list.EachPositive("modal_sigma_m", modal_sigma_m, 0.1,
                    "standard deviation of a fitted coordinate; at 0 the filter has no solution");
  list.Within("max_joint_rate_rad_s", max_joint_rate_rad_s, 0.1, 200.0,
              "a faster change of a counter is an impossible jump");
  list.Positive("hub_rotor_limit_rad", hub_rotor_limit_rad, 1.0,
                "hub and rotor further apart than this is a fault");
  list.Positive("strain_family_limit", strain_family_limit, 0.01,
                "unit strain; a channel further from the fit than this is dropped");
  list.Positive("strain_stuck_limit", strain_stuck_limit, 0.01,
                "unit strain; a channel that rests while the fit moves by this is stuck");
  list.Positive("innovation_limit_rad", innovation_limit_rad, 3.2,
                "an innovation of a hub angle beyond this is a fault");
  list.Within("fault_ticks", fault_ticks, 1, 3, "a fault must be named within three ticks");
  if (payload) CheckPayload(*payload, &list);
  return list.Take();
}

}  // namespace flexarm
