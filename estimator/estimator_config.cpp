#include "estimator/estimator_config.h"

#include "model/problem_list.h"

namespace flexarm {

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
  return list.Take();
}

}  // namespace flexarm
