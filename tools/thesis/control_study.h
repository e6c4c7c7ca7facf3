#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// The commands of the thesis's control experiments: a move by 30 degrees, and 2 s later the move
/// back.
Experiment ControlCommand(DoubletShape shape);

/// One closed loop of chapter 7.
struct ControlCase {
  std::vector<std::string> overrides;  ///< --set; empty: the rig as it is
  double payload_kg;                   ///< of the plant
  DoubletShape shape;

  bool operator<(const ControlCase& other) const {
    return std::tie(overrides, payload_kg, shape) <
           std::tie(other.overrides, other.payload_kg, other.shape);
  }
};

/// Results of a case: medians over the seeds, of the runs that completed; NaN if none completed.
struct ControlFigures {
  std::size_t runs = 0, completed = 0;
  std::array<double, 2> rms_deg{}, final_deg{}, peak_nm{}, torque_rms_nm{};
  double settling_s = 0.0;  ///< infinite: never settled
  double residual_mm = 0.0;
  std::array<double, 2> peak_bending_mm{};  ///< of the links' tips

  double worst_final_deg() const {
    return final_deg[0] > final_deg[1] ? final_deg[0] : final_deg[1];
  }
  double rms_sum_deg() const { return rms_deg[0] + rms_deg[1]; }
};

/// Simulates every closed loop of the statements of chapter 7 and of figures 7.1 to 7.3, with
/// sensors, estimator and delay.
class ControlStudy {
 public:
  static constexpr int kSeeds = 3;

  /// Runs all cases, on all cores.
  /// @param progress  called with the number of runs done; may be empty
  explicit ControlStudy(const RigConfig& config,
                        const std::function<void(std::size_t)>& progress = {});

  /// Number of runs of a study.
  static std::size_t Runs();

  const RigConfig& config() const { return config_; }

  /// @throws std::out_of_range  ControlStudy has no such case
  const ControlFigures& Of(const ControlCase& of) const { return figures_.at(of); }

 private:
  RigConfig config_;
  std::map<ControlCase, ControlFigures> figures_;
};

// A case with changed config values. ControlStudy has the cases of the grids below.
ControlCase ChangedCase(const std::vector<std::string>& overrides, double payload_kg);
ControlCase SineCase(double payload_kg);
ControlCase AlphaCase(double alpha, double payload_kg);
ControlCase VarthetaCase(double vartheta, const char* sign);
inline constexpr std::array<double, 9> kAlphas = {0.0, 1.0, 2.0, 2.5, 3.0, 3.2, 3.5, 4.0, 5.0};
inline constexpr std::array<double, 5> kVarthetas = {0.0, 0.25, 0.35, 0.5, 1.0};
inline constexpr std::array<double, 3> kThesisPayloads_kg = {0.01, 0.1, 0.2};

}  // namespace flexarm
