#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <vector>

#include "model/arm/arm_model.h"
#include "tools/analysis/parametric_study.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {

/// The free arm under one period of a square wave of torque, from rest: chapter 4's experiment.
struct ExcitationRun {
  struct Sample {
    double time_s;
    std::array<double, 2> bending_mm, joint_deg;
  };
  std::vector<Sample> sample;  ///< one per step of the integrator
  std::array<double, 2> peak_bending_mm = {0.0, 0.0};
  Eigen::Vector2d tip_m;  ///< at the end
};

/// @param duration_s  of the run; the wave ends after Excitation::kPeriod_s
ExcitationRun RunExcitation(const ArmModel& model, double theta2_deg, const Excitation& excitation,
                            double duration_s);

/// Draws the bending of both links and the angles of both joints over time, like figures 4.4 and
/// 4.5.
/// @throws std::runtime_error if gnuplot fails
void DrawExcitation(const ExcitationRun& run, const std::filesystem::path& output,
                    const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
