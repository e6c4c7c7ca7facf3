#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "controller/safety/safety_record.h"
#include "controller/types/records.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// Result of the replay of a run.
struct ReplayResult {
  std::int64_t ticks = 0;
  /// Ticks before the first reset of the loop, in the log of a trip outside a run: what the loop
  /// had stored by then is not known, so they are not compared.
  std::int64_t ticks_before_reset = 0;
  /// Every output had the recorded bytes. Nothing if equal bytes cannot be expected (a CSV file,
  /// another config).
  std::optional<bool> bit_exact = true;
  std::array<double, 2>
      max_torque_difference_nm{};  ///< of the requested torque, against the recorded one
  /// Largest difference of a component of the state estimate x_hat, as a share of the largest
  /// recorded value of that component. Nothing under another config.
  std::optional<double> estimate_difference = 0.0;
  /// Innovation of the hub encoders, rms; 0 without a filter.
  std::array<double, 2> hub_innovation_rms_rad{};
  std::int64_t faulty_ticks = 0;            ///< in which the loop detected a fault
  std::optional<bool> safety_exact = true;  ///< nothing: there were no safety records
  std::int64_t safety_records = 0;
  std::optional<std::int64_t> first_gap_tick;        ///< first tick number that is missing
  std::optional<std::int64_t> first_different_tick;  ///< first tick with other bytes
  std::optional<std::int64_t> first_different_safety_ns;
};

/// ControlStep::Step of a new ControlStep.
using StepFunction = std::function<StepOutput(const StepInput&)>;

/// Replay: runs recorded inputs through a new loop and compares with the recorded outputs.
class Replay {
 public:
  /// @param step  of a loop made from the log's own config and gains
  /// @param other_config  the loop has another config: bytes are not compared
  Replay(StepFunction step, bool other_config);

  /// In the order of the log. The comparison begins with the first reset.
  void Tick(const TickRecord& record);
  /// NextSafetyState of the recorded facts must give the recorded state, and each record must begin
  /// in the state in which the one before it ended.
  void Safety(const SafetyRecord& record);
  /// After the last record.
  ReplayResult Result() const;

 private:
  StepFunction step_;
  ReplayResult result_;
  std::array<double, kMaxNominalStates> largest_state_{};
  std::array<double, kMaxNominalStates> largest_state_difference_{};
  std::array<double, 2> innovation_square_{};  // sums
  bool reset_seen_ = false;
  std::optional<std::int64_t> previous_tick_;
  std::optional<SafetyStatus> previous_status_;
};

}  // namespace flexarm
