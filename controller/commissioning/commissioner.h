#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "controller/commissioning/angle_knowledge.h"
#include "controller/commissioning/calibrate.h"
#include "controller/commissioning/pluck.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// A motion for a commissioning command, to be run like an experiment.
struct CommissioningMotion {
  std::unique_ptr<PlannedExperiment> planned;
  LineLevels may_open;  ///< the limit switch that the motion searches for
};

/// Commissioning: tests the wiring of a rig and calibrates its sensors: tare, zero, calibrate,
/// pluck, home. One command at a time; each ends in one JSON answer. Maintains the calibration
/// file.
///
/// Commands, as JSON: {"command": "tare"}, {"command": "zero", "angle_deg": [a, b]},
/// {"command": "calibrate", "link": 1, "force_n": F, "at_m": x}, {"command": "pluck"},
/// {"command": "home", "joint": 1, "side": "low"}.
/// Not real-time. Thread: the operator's.
class Commissioner {
 public:
  /// Reads the calibration file, if there is one.
  /// @throws InputError if the file is for other sensors
  explicit Commissioner(const RigConfig& config);
  ~Commissioner();

  static bool Knows(const std::string& command);

  /// The calibration for the loop.
  const Calibration& calibration() const { return calibration_; }

  /// Which joint angles are known. The calibration of a joint that is not is that of its counts
  /// alone, and not in the file.
  const AngleKnowledge& angles() const { return angles_; }

  /// Why no experiment may run yet, and what to do; empty if one may.
  std::string WhyNoRun() const;
  /// The wiring must be tested before the arm may follow a reference.
  bool NeedsPluck() const { return config_.commissioning.prove_before_run && !proven_; }

  bool busy() const { return job_ != nullptr; }

  /// Begins a command. The caller asks for a run of the motion, if there is one, and tells its
  /// number to Expect.
  /// @param reduced_limits  they hold now: a pluck takes safety.reduced_torque of its torque
  /// @throws RejectedError if the command is not possible now, or not valid
  CommissioningMotion Start(const nlohmann::json& command, SafetyState state,
                            bool reduced_limits = false);

  /// The number of the run that is the motion of this command: no other run is judged.
  void Expect(std::uint32_t run_number);

  /// A run was granted, at `now_ns` or before; another than the expected one is ignored. A run that
  /// trips before a step sees it has no sample: from now_ns on, torque off is the command's end.
  void Granted(std::uint32_t run_number, std::int64_t now_ns);

  /// The newest epochs of the counters, before the steps of the same period.
  void Follow(const CountEpochs& epochs);

  /// Takes every step of the loop, in order.
  void Take(const TickRecord& tick);

  /// Ends the command: its motion was not permitted.
  void Abort();

  /// The answer of a command that has ended; returned once.
  std::optional<nlohmann::json> TakeAnswer();

 private:
  struct Job;
  using FromRest = std::function<nlohmann::json(const RestReadings&)>;
  using FromRun = std::function<nlohmann::json(const std::vector<TickRecord>&)>;

  void StartRest(const std::string& command, SafetyState state, FromRest then);
  CommissioningMotion StartPluck(SafetyState state, bool reduced_limits);
  CommissioningMotion StartHome(const nlohmann::json& command, SafetyState state);
  void StartZero(const nlohmann::json& command, SafetyState state);
  void StartCalibrate(const nlohmann::json& command, SafetyState state);
  nlohmann::json Home(const std::vector<TickRecord>& run, std::size_t joint, Line line,
                      double switch_deg);
  nlohmann::json Pluck(const std::vector<TickRecord>& run);
  /// Ends a command during which the angles of `joints` became unknown: it would calibrate counts
  /// that no longer hold.
  void EndIfLost(std::uint8_t joints);
  /// Saves `calibration` and returns it from then on.
  void Adopt(const Calibration& calibration);

  RigConfig config_;
  std::filesystem::path file_;
  Calibration calibration_{};
  GainCalibration gains_;
  bool proven_ = false;
  AngleKnowledge angles_;
  std::unique_ptr<Job> job_;
  std::unique_ptr<nlohmann::json> answer_;
};

}  // namespace flexarm
