#include "hal/sim/sim_drift.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hal/sensor_frame.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kMost = 0.9;  // of a relative error: gains and stiffnesses keep their sign

void CheckGauges(const char* key, const std::vector<double>& values, ProblemList* list) {
  list->Require(values.size() <= static_cast<std::size_t>(kMaxStrainChannels), key,
                NumberText(values.size()) + " numbers", "at most one for each strain channel");
  for (std::size_t i = 0; i < values.size(); ++i) {
    list->Within(ProblemList::Element(key, i), values[i], -kMost, kMost, "relative to the config");
  }
}

void ScaleStiffness(BeamSection* section, double factor) {
  section->youngs_modulus_pa *= factor;
  section->given_bending_stiffness_nm2 *= factor;
}

}  // namespace

std::vector<Problem> SimDrift::Problems() const {
  ProblemList list("sim.drift.");
  CheckGauges("gauge_gain_error", gauge_gain_error, &list);
  CheckGauges("gauge_zero_share", gauge_zero_share, &list);
  list.EachWithin("friction_error", friction_error, -1.0, 20.0, "relative to the config");
  list.EachWithin("joint_stiffness_error", joint_stiffness_error, -kMost, 20.0,
                  "relative to the config");
  list.EachWithin("link_stiffness_error", link_stiffness_error, -kMost, 20.0,
                  "relative to the config");
  list.Within("payload_error_kg", payload_error_kg, -100.0, 100.0,
              "added to the payload that is stated");
  return list.Take();
}

ArmParameters Drifted(ArmParameters arm, const SimDrift& drift) {
  for (std::size_t i = 0; i < 2; ++i) {
    arm.joint[i].coulomb_friction_nm *= 1.0 + drift.friction_error[i];
    arm.joint[i].stiffness_nm_per_rad *= 1.0 + drift.joint_stiffness_error[i];
    for (BeamSection& section : arm.link[i].section) {
      ScaleStiffness(&section, 1.0 + drift.link_stiffness_error[i]);
    }
  }
  arm.payload_mass_kg = std::max(0.0, arm.payload_mass_kg + drift.payload_error_kg);
  return arm;
}

SensorConfig Drifted(SensorConfig sensors, const SimDrift& drift) {
  const double full_scale_counts = -sensors.strain_input.lowest_count();
  const auto count = [&sensors](const std::vector<double>& values) {
    return std::min(sensors.strain.size(), values.size());
  };
  for (std::size_t i = 0; i < count(drift.gauge_gain_error); ++i) {
    sensors.strain[i].gain_v_per_unit *= 1.0 + drift.gauge_gain_error[i];
  }
  for (std::size_t i = 0; i < count(drift.gauge_zero_share); ++i) {
    sensors.strain[i].offset_counts += drift.gauge_zero_share[i] * full_scale_counts;
  }
  return sensors;
}

}  // namespace flexarm
