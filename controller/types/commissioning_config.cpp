#include "controller/types/commissioning_config.h"

#include "model/problem_list.h"

namespace flexarm {

std::vector<Problem> CommissioningConfig::Problems() const {
  ProblemList list("commissioning.");
  list.Require(!calibration_file.empty(), "calibration_file", calibration_file,
               "must name the file that keeps what commissioning found");
  list.Within("measure_s", measure_s, 0.1, 60.0, "the time over which readings are averaged");
  list.EachPositive("pluck_torque_nm", pluck_torque_nm, 1000.0,
                    "the torque of the pulse that proves the wiring");
  list.Within("pluck_pulse_s", pluck_pulse_s, 0.08, 5.0,
              "two halves of at least two periods, one each way");
  list.Within("pluck_rest_s", pluck_rest_s, 0.1, 10.0, "the arm swings out between the pulses");
  list.Within("motion_tolerance", motion_tolerance, 0.01, 0.6,
              "beyond it a wrong gear could pass for friction");
  list.Within("gauge_tolerance", gauge_tolerance, 0.005, 0.5,
              "beyond it two gauges that are exchanged could pass");
  list.Positive("home_rate_deg_per_s", home_rate_deg_per_s, 30.0,
                "the speed at which the switch is met");
  list.Positive("home_travel_deg", home_travel_deg, 180.0, "the search ends after it");
  list.Positive("home_back_deg", home_back_deg, 90.0, "the way off the switch");
  list.EachWithin("switch_angle_deg", switch_angle_deg, -360.0, 360.0,
                  "the hub angle at which the switch opens");
  if (!list.empty()) return list.Take();
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const double low = switch_angle_deg[2 * joint], high = switch_angle_deg[2 * joint + 1];
    list.Require(low < high, ProblemList::Element("switch_angle_deg", 2 * joint), NumberText(low),
                 "must be below that of the joint's other switch, " + NumberText(high));
  }
  return list.Take();
}

}  // namespace flexarm
