#pragma once

#include <array>

#include "estimator/state_estimator.h"
#include "tests/estimator/thesis_estimator.h"

namespace flexarm {

inline FilterGains GainsOf(const KalmanDesign& design, const StateLayout& layout = kR12) {
  return {.layout = layout,
          .A = design.A,
          .B = design.B,
          .C = design.C,
          .L = design.L,
          .A_rate = design.A_rate,
          .B_rate = design.B_rate,
          .W = design.W,
          .P = design.P,
          .R = design.R};
}

inline DecodedCounters Angles(double th1, double th2, double th3, double th4) {
  DecodedCounters counters{};
  counters.angle_rad = {th1, th2, th3, th4};
  counters.good = 0b1111;
  return counters;
}

inline FittedModes Bend(const std::array<double, 4>& modal) {
  FittedModes modes{};
  modes.modal_m = modal;
  modes.valid = {true, true};
  return modes;
}

inline StateEstimator Kalman(const KalmanDesign& design, const StateLayout& layout = kR12) {
  return {ThesisEstimator(), GainsOf(design, layout), kPeriod_s, kStiffness};
}

}  // namespace flexarm
