#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "config/config.h"
#include "tools/thesis/verdict_rules.h"

namespace flexarm {

/// Rotation of both joints in the experiments.
inline constexpr double kMove_deg = 30.0;

/// The commands of the thesis's control experiments: a move of both joints, and 2 s later the move
/// back.
Experiment ControlCommand(DoubletShape shape, double move_deg = kMove_deg);

/// One closed loop of chapter 7.
struct ControlCase {
  std::vector<std::string> overrides;  ///< --set; empty: the rig as it is
  double payload_kg;                   ///< of the plant
  DoubletShape shape = DoubletShape::kSquare;
  double move_deg = kMove_deg;

  bool operator<(const ControlCase& other) const {
    return std::tie(overrides, payload_kg, shape, move_deg) <
           std::tie(other.overrides, other.payload_kg, other.shape, other.move_deg);
  }
};

/// Results of a case over the seeds, of the runs that completed; NaN if none completed.
struct ControlFigures {
  std::size_t runs = 0, completed = 0;
  std::array<OverSeeds, 2> rms_deg, final_deg, peak_nm, torque_rms_nm, peak_angle_deg,
      roughness_rad_s2, lag_s;
  std::array<OverSeeds, 2> peak_bending_mm;  ///< of the links' tips
  OverSeeds rms_sum_deg, worst_final_deg;    ///< of both joints
  /// The tip stays within 15 mm, 5 mm of its resting place; infinite: never.
  OverSeeds still_15mm_s, still_5mm_s;
  OverSeeds residual_mm;     ///< rms in the last 0.3 s
  OverSeeds last_second_mm;  ///< rms in the last second

  bool all_completed() const { return completed == runs; }
  Outcome Of(const OverSeeds& value) const { return {all_completed(), value}; }
};

/// Simulates every closed loop of the statements of chapter 7 and of figures 7.1 to 7.3: with
/// sensors, estimator and delay, and with known state and without delay. Nominal models for which
/// the rig has too few gauges are left out.
class ControlStudy {
 public:
  static constexpr int kSeeds = 3;

  /// Runs all cases, on all cores, with the seeds first_seed .. first_seed + kSeeds - 1.
  /// @param progress  called with the number of runs done; may be empty
  explicit ControlStudy(const RigConfig& config, int first_seed = 1,
                        const std::function<void(std::size_t)>& progress = {});

  /// Number of runs of a study.
  static std::size_t Runs(const RigConfig& config);

  const RigConfig& config() const { return config_; }
  int first_seed() const { return first_seed_; }

  /// @throws std::out_of_range  ControlStudy has no such case
  const ControlFigures& Of(const ControlCase& of) const { return figures_.at(of); }

 private:
  RigConfig config_;
  int first_seed_;
  std::map<ControlCase, ControlFigures> figures_;
};

using Overrides = std::vector<std::string>;

/// The thesis's law with what this program adds at rest. All other cases are without it.
inline const Overrides kShippedLaw = {"controller.name=sobel"};

// Cases of ControlStudy.
ControlCase ChangedCase(const Overrides& overrides, double payload_kg);
ControlCase SineCase(double payload_kg);  ///< the same rotation
/// The sine with the square command's amplitude of torque turns the joints 2/pi as far.
ControlCase SmallSineCase(double payload_kg);
ControlCase AlphaCase(double alpha, double payload_kg);
/// vartheta = 0 with the given alpha, "0" or "3".
ControlCase WithoutBlend(const char* alpha, double payload_kg);
ControlCase VarthetaCase(double vartheta, const char* sign);
/// The same case with known state and without delay.
ControlCase Ideal(ControlCase of);

inline constexpr std::array<double, 9> kAlphas = {0.0, 1.0, 2.0, 2.5, 3.0, 3.2, 3.5, 4.0, 5.0};
inline constexpr std::array<double, 5> kVarthetas = {0.0, 0.25, 0.35, 0.5, 1.0};
inline constexpr std::array<double, 3> kSimulatedPayloads_kg = {0.01, 0.1, 0.2};    ///< thesis 7.4
inline constexpr std::array<double, 4> kTestedPayloads_kg = {0.0, 0.01, 0.1, 0.2};  ///< 7.5
inline constexpr std::array<double, 6> kAllPayloads_kg = {0.0, 0.01, 0.1, 0.2, 0.5, 1.0};

}  // namespace flexarm
