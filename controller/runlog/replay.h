#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "controller/safety/safety_record.h"
#include "controller/types/records.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// What replaying a run found.
struct ReplayResult {
  std::int64_t ticks = 0;
  /// Every output had the recorded bytes; nothing if bytes cannot be expected to be equal (a CSV
  /// file, another config).
  std::optional<bool> bit_exact = true;
  std::array<double, 2> max_torque_difference_nm{};  ///< of the asked torque, against the recorded
  /// What the estimator had not expected of the hubs' encoders, rms; 0 without a filter.
  std::array<double, 2> hub_innovation_rms_rad{};
  std::int64_t faulty_ticks = 0;            ///< in which the loop itself found a fault
  std::optional<bool> safety_exact = true;  ///< nothing: there were no safety records
  std::int64_t safety_records = 0;
  std::optional<std::int64_t> first_gap_tick;        ///< first tick number that is missing
  std::optional<std::int64_t> first_different_tick;  ///< first tick with other bytes
  std::optional<std::int64_t> first_different_safety_ns;
};

/// ControlStep::Step of a fresh ControlStep.
using StepFunction = std::function<StepOutput(const StepInput&)>;

/// Runs recorded inputs through a fresh loop and compares with the recorded outputs.
class Replay {
 public:
  /// @param step  of a loop made from the log's own config and gains
  /// @param other_config  it was made from another config: bytes are not compared
  Replay(StepFunction step, bool other_config);

  /// In the order of the log.
  void Tick(const TickRecord& record);
  /// NextSafetyState over the recorded facts must give the recorded state, and each record must
  /// begin where the one before it ended.
  void Safety(const SafetyRecord& record);
  /// After the last record.
  ReplayResult Result() const;

 private:
  StepFunction step_;
  ReplayResult result_;
  std::array<double, 2> innovation_square_{};  // sums
  std::optional<std::int64_t> previous_tick_;
  std::optional<SafetyStatus> previous_status_;
};

}  // namespace flexarm
