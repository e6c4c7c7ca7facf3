#include "controller/types/commissioning_config.h"

#include "model/problem_list.h"

namespace flexarm {

std::vector<Problem> CommissioningConfig::Problems() const {
  ProblemList list("commissioning.");
  list.Require(!calibration_file.empty(), "calibration_file", calibration_file,
               "must name the file for the results of the commissioning");
  list.Within("measure_s", measure_s, 0.1, 60.0, "the time over which readings are averaged");
  list.EachPositive("pluck_torque_nm", pluck_torque_nm, 1000.0, "the torque of the test pulse");
  list.Within("pluck_pulse_s", pluck_pulse_s, 0.08, 5.0,
              "two halves of at least two periods, one in each direction");
  list.Within("pluck_rest_s", pluck_rest_s, 0.1, 10.0,
              "time for the oscillation to decay after each pulse");
  list.Within("motion_tolerance", motion_tolerance, 0.01, 0.6,
              "above this a wrong gear ratio could be mistaken for friction");
  list.Within("gauge_tolerance", gauge_tolerance, 0.005, 0.5,
              "above this two exchanged gauges could pass the test");
  list.Positive("home_rate_deg_per_s", home_rate_deg_per_s, 30.0,
                "the speed at which the joint approaches the switch");
  list.Positive("home_travel_deg", home_travel_deg, 180.0, "the longest search for the switch");
  list.Positive("home_back_deg", home_back_deg, 90.0, "the distance from the switch afterwards");
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
