#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/config.h"
#include "model/rigid_joint/rigid_joint_arm.h"
#include "tools/sweep/random_moves.h"
#include "tools/torture/disturbed_executor.h"
#include "tools/torture/fault.h"

namespace flexarm {

/// What the session does when its faults begin.
enum class Situation : std::uint8_t {
  kStarting,
  kIdle,
  kArmed,
  kRunning,
  kStopping,
  kDisarming,
  kTripped,        ///< by the emergency stop in mid-move
  kFaultStopping,  ///< by a torque in mid-move that was not that of the command, and is again;
                   ///< in a fifth Tripped at once (TortureSession::BreakALimit)
};
inline constexpr int kSituations = 8;

const char* ToString(Situation situation) noexcept;

/// A command of the operator, beyond those that lead to the situation.
struct TimedCommand {
  std::int64_t at_ns;  ///< after the begin of the faults; negative: at once
  std::string text;    ///< one line of the protocol
};

/// One session of the whole daemon, from its start to its end: all that is random in it.
struct TortureScenario {
  std::uint64_t seed = 0;
  std::string law;                      ///< controller.name
  double payload_kg = 0.0;              ///< of the simulated arm
  std::vector<std::string> plant{};     ///< --set of the simulated arm alone
  std::array<double, 2> move_to_deg{};  ///< the move of its run
  double move_s = 0.0;
  Situation situation = Situation::kIdle;
  std::int64_t after_ns = 0;    ///< from the begin of the situation to that of the faults
  std::vector<Fault> faults{};  ///< instants after the begin of the faults
  std::vector<TimedCommand> commands{};
  bool recovers = false;  ///< at the end: faults gone, button, reset, arm
  WakeUps wake_ups{};

  /// Nothing in it may trip the arm.
  bool is_clean() const {
    return faults.empty() && situation != Situation::kTripped &&
           situation != Situation::kFaultStopping;
  }
};

/// What scenarios are drawn from: laws, and what the rig has.
struct TortureSpace {
  std::vector<std::string> laws;
  std::array<double, 2> payload_kg;        ///< of laws that follow the payload
  std::array<double, 2> fixed_payload_kg;  ///< of the others
  int gauges;
  std::array<double, 2> within_deg;  ///< of the moves
  RigidJointArm arm;                 ///< of the design
  MoveRecipe recipe;                 ///< of the benchmark's moves for this rig

  /// Least and greatest payload with a law.
  const std::array<double, 2>& PayloadsOf(const std::string& law) const;
};

/// Whether the daemon has such a place with this law.
bool Has(const std::string& law, FaultPlace place);

/// The space of a rig.
TortureSpace SpaceOf(const RigConfig& config, std::vector<std::string> laws);

/// The scenario of a seed: a tenth has no fault, six tenths one, the others two or three.
TortureScenario ScenarioOf(std::uint64_t seed, const TortureSpace& space, const RigConfig& config);

/// Duration of a move from the straight arm, s: `share` of that by the rule of the benchmark's
/// moves for this payload.
double MoveTime_s(const TortureSpace& space, const std::array<double, 2>& to_deg,
                  double heaviest_kg, double share);

/// For people: what happens, in one line.
std::string Text(const TortureScenario& scenario);

}  // namespace flexarm
