#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "controller/commissioning/switch_proof.h"
#include "controller/latch/trip_latch.h"
#include "controller/operator/commissioning_commands.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/override.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Name of the condition of `run`, for an override.
inline constexpr const char* kSwitchesCondition = "switches";

/// The command `prove-switches`: leads a person through the proof of every switch, with the relay
/// open, and keeps the proof in the state folder. A wired rig runs no experiment without it.
///
/// A switch that opens trips, as always: a reset follows the proof.
/// Not real-time safe. Thread: operator.
class ProveSwitches {
 public:
  static constexpr const char* kFile = "switch-proof.json";

  /// @param latch  whose state folder keeps the proof; outlives this
  /// @param unix_s  the time of day, s since 1970; empty: the computer's
  ProveSwitches(const RigConfig& config, TripLatch* latch, JournalReport report,
                std::function<std::int64_t()> unix_s = {});

  /// Begins the proof, or begins it again. Its answer comes from TakeAnswer.
  /// @throws RejectedError if the relay may be closed
  void Start(int client, SafetyState state);

  /// Every step of the loop, in order.
  void Take(const TickRecord& tick);

  /// The answer of a proof that has ended, once.
  std::optional<ClientAnswer> TakeAnswer(const Permit& permit);

  /// What forbids a run: nothing on a simulated rig, or while the proof holds.
  std::vector<UnmetCondition> UnmetToRun() const;

  /// For the status: {"proved", "why_not", "step", "steps", "text"}; step and text are null unless
  /// a proof is under way.
  nlohmann::json Json() const;

 private:
  /// Why there is no proof; "" if there is one.
  std::string WhyNot() const;
  void End(const std::string& error);

  std::optional<GpiodConfig> lines_;
  double valid_days_;
  double period_s_;
  bool needed_;
  TripLatch* latch_;
  JournalReport report_;
  std::function<std::int64_t()> unix_s_;
  std::optional<SwitchProof> proof_;  // under way
  int client_ = -1;
  std::unique_ptr<nlohmann::json> answer_;
};

}  // namespace flexarm
