#pragma once

#include "controller/design/gain_table_design.h"
#include "controller/planner/horizon_planner.h"
#include "tests/support/loop_time.h"
#include "tests/support/study_gains.h"
#include "tests/support/study_move.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {

/// The settings of docs/theory/payload.md 5.
inline HorizonPlannerConfig StudyPlannerConfig() {
  return {.weights = {.moving = {100, 30, 0, 0, 0, 0, 1, 0.3, 0, 0, 0, 0},
                      .resting = {2e5, 6e4, 2e5, 2e5, 2e5, 2e5, 2e3, 600, 3e3, 3e3, 3e3, 3e3},
                      .torque = {0.02, 0.2},
                      .light_kg = 0.15,
                      .reference_payload_kg = 0.15},
          .torque_limit_nm = {28.0, 5.6},
          .roughness = 0.5,
          .payload_change_kg = 0.03,
          .payload_change_share = 0.2};
}

inline HorizonPlanner StudyPlanner(const HorizonPlannerConfig& config = StudyPlannerConfig()) {
  const RigidJointArm arm(ThesisRig());
  return {arm, kPeriod_s, DesignGainTable(arm, StudyGrid(), StudyWeights(1.5), kPeriod_s), config};
}

}  // namespace flexarm
