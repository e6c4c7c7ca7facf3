#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/canopen/can_bus.h"
#include "hal/canopen/canopen_config.h"
#include "hal/canopen/object_dictionary.h"

namespace flexarm {

/// Action of a step of a node's configuration.
enum class SetupAction : std::uint8_t {
  kResetNode,           ///< NMT: application and communication, as after power on
  kResetCommunication,  ///< NMT: an incremental encoder keeps its count
  kAwaitBoot,           ///< the boot-up message
  kExpect,              ///< reads the object and compares it with the value
  kWrite,               ///< writes the object, then reads it back
  kStart,               ///< NMT: operational
  kAwaitOperational,    ///< a heartbeat in the operational state
};

/// One step. A step without SDO transfer has no object.
struct SetupStep {
  SetupAction action;
  const char* what;  ///< text for the operator
  CanopenObject object{};
  int size = 0;  ///< of the object, bytes
  std::uint32_t value = 0;
  std::uint32_t mask = 0xFFFF'FFFF;  ///< bits that are compared
  std::uint32_t tolerance = 0;       ///< largest accepted deviation of the value
  bool optional = false;             ///< the object need not exist
};

/// All configuration steps of a node before operation, in this order: identity, PDOs on SYNC only,
/// torque mode, reaction to the loss of the daemon, heartbeats. Start-up only.
std::vector<SetupStep> SetupSteps(const CanopenConfig& config, const CanopenNodeConfig& node);

/// Configures all nodes of a bus step by step, one node at a time. Advance is real-time safe: it
/// can be interrupted and resumed at any point. Thread: that of the bus.
class NodeSetup {
 public:
  enum class Progress : std::uint8_t { kBusy, kDone, kFailed };

  NodeSetup(const CanopenConfig& config, CanBus* bus);

  /// Restarts with the first node.
  void Begin() noexcept;
  /// Continues until all steps are done, one has failed, or `until_ns`.
  Progress Advance(std::int64_t until_ns) noexcept;

  /// True if the step that failed got no answer.
  bool without_answer() const noexcept { return failure_ == Failure::kNoAnswer; }
  /// Node of the step that failed, and the index of its object: 0 if it is not an SDO transfer.
  int failed_node_id() const noexcept { return config_.node[node_].node_id; }
  std::uint16_t failed_index() const noexcept { return step().object.index; }
  /// Code of the newest emergency that the node of row `node` of the config has sent since its
  /// reset by this setup; 0: none.
  std::uint16_t emergency(std::size_t node) const noexcept { return emergency_[node]; }
  /// Text of the failure: interface, node, object, found and expected. Not real-time.
  std::string FailureText() const;

 private:
  enum class Failure : std::uint8_t {
    kNone,
    kNotSent,
    kNoAnswer,
    kMalformed,
    kAborted,
    kDiffers,
  };
  enum class Phase : std::uint8_t { kBegin, kWriting, kReading, kListening };

  const SetupStep& step() const noexcept { return steps_[node_][step_]; }
  void NextStep() noexcept;
  void Fail(Failure failure, std::uint32_t found) noexcept;
  void BeginStep() noexcept;
  void Ask(Phase phase) noexcept;
  void Handle(const ReceivedFrame& received) noexcept;
  void HandleReply(const CanFrame& frame) noexcept;
  void HandleEmergency(const ReceivedFrame& received) noexcept;

  const CanopenConfig& config_;
  CanBus* bus_;
  std::vector<std::vector<SetupStep>> steps_;
  std::size_t node_ = 0;
  std::size_t step_ = 0;
  Phase phase_ = Phase::kBegin;
  std::int64_t asked_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  Failure failure_ = Failure::kNone;
  std::uint32_t found_ = 0;
  std::array<std::uint16_t, kMaxCanopenNodes> emergency_{};
};

}  // namespace flexarm
