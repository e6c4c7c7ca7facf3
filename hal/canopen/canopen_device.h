#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/bus_device.h"
#include "hal/canopen/can_bus.h"
#include "hal/canopen/canopen_codec.h"
#include "hal/canopen/canopen_config.h"
#include "hal/canopen/canopen_fault.h"
#include "hal/canopen/confirmed_bus.h"
#include "hal/canopen/drive_state.h"
#include "hal/canopen/node_setup.h"

namespace flexarm {

/// Counts of rejected and missing frames since Open.
struct CanopenCounts {
  std::uint32_t stale = 0;       ///< PDOs from before the SYNC, rejected by their time stamp
  std::uint32_t duplicated = 0;  ///< second answers to one SYNC
  std::uint32_t malformed = 0;   ///< wrong length or content
  std::uint32_t missed = 0;      ///< answers that did not arrive in time
  std::uint32_t unsent = 0;      ///< exchanges and switch-offs that were not, or not wholly, sent
};

/// Driver of the CANopen nodes of one interface: drives in cyclic synchronous torque mode,
/// encoders.
///
/// One exchange: torque and controlword to each drive, SYNC, the daemon's heartbeat; then it
/// receives the PDOs that answer SYNC, until all have arrived or the answer time is over. All nodes
/// sample, and all drives act, at the SYNC: it is the sampling instant, and every offset is 0.
///
/// Torque is sent only while enabled, before the command expires, and only to a drive that reported
/// "operation enabled" in the last exchange. SwitchOff sends a SYNC between two exchanges, so that
/// the drives act on its controlword at once; the answers to it are stale and dropped. A fault
/// latches: the drives stay switched off. One of a drive that answers lasts until an exchange with
/// `acknowledge`, which sends the fault reset, and no other call does. After any other one
/// Reconnect configures all nodes again, with a pause of 0.1 s before a second attempt, doubled
/// with each up to 2 s; the fault of a drive outlasts that. Until each frame of the last exchange
/// has its echo, an exchange adds none and fails: at most one exchange waits, in the queue and in
/// the controller together, and Reconnect drops it. The
/// relay feeds the drives, so while they are off an emergency for want of supply or by safe torque
/// off (SupplyEmergency) is a notice and no fault, and so is the fault state behind it. When they
/// are switched on, that fault alone is reset, until the drive operates: a second at most. In
/// operation every emergency is a fault. If the daemon dies, the drives miss its heartbeat (1016)
/// and remove their torque (6007) within master_timeout_ms.
class CanopenDevice : public BusDevice {
 public:
  /// @param config  without problems
  CanopenDevice(CanopenConfig config, std::unique_ptr<CanBus> bus);
  CanopenDevice(const CanopenDevice&) = delete;
  CanopenDevice& operator=(const CanopenDevice&) = delete;

  const char* name() const noexcept override { return config_.interface.c_str(); }
  std::uint32_t drives() const noexcept override { return drives_; }
  std::uint32_t drives_on() const noexcept override;
  DriveVoltage voltage() const noexcept override;
  std::int64_t worst_case_ns() const noexcept override { return config_.worst_case_exchange_ns(); }
  CountEpochs count_epochs() const noexcept override { return count_epochs_; }
  bool needs_reconnect() const noexcept override { return configuring_ || lost_; }
  BusFault notice() const noexcept override;
  std::span<const char* const> counter_names() const noexcept override;
  BusCounters counter_values() const noexcept override;
  void Open() override;
  [[nodiscard]] BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override;
  [[nodiscard]] BusStatus SwitchOff() noexcept override;
  [[nodiscard]] BusStatus Reconnect() noexcept override;
  BusFault FaultOf(BusStatus status) const noexcept override;
  std::string FaultText(const BusFault& fault) const override;
  void Close() noexcept override;

  /// The latched fault, for the log. Thread: the bus's.
  const CanopenFault& fault() const noexcept { return fault_; }
  const CanopenCounts& counts() const noexcept { return counts_; }
  const CanCounts& bus_counts() const noexcept { return bus_.counts(); }
  const CanopenConfig& config() const noexcept { return config_; }
  /// State of the drive of joint `joint` (0, 1) at the last exchange; kUnknown if it is not on this
  /// bus.
  DriveState drive_state(int joint) const noexcept;
  /// Torque reported by the drive, at the gearbox output, positive as the joint.
  double drive_torque_nm(int joint) const noexcept;

 private:
  struct Node {
    const CanopenNodeConfig* config = nullptr;
    DriveState state = DriveState::kUnknown;
    std::uint16_t statusword = 0;
    std::int16_t torque_per_mille = 0;
    std::uint32_t counts = 0;
    std::int64_t heartbeat_ns = 0;
    bool answered = false;        // this SYNC
    bool was_enabled = false;     // was in operation since it was last switched off
    int missed = 0;               // SYNCs in a row without answer
    int waiting = 0;              // exchanges in a row without following the controlword
    std::uint16_t no_supply = 0;  // code of its SupplyEmergency, until the fault is over; 0: none
    int unexplained = 0;          // exchanges in a row in fault, without such an emergency
    int without_fault = 0;        // exchanges since that emergency in which it was not in fault
  };

  std::span<Node> nodes() noexcept { return std::span(nodes_).first(node_count_); }
  Node* Find(int node_id) noexcept;
  const Node* Drive(int joint) const noexcept;
  std::vector<std::uint32_t> Identifiers() const;
  std::int64_t answer_ns() const noexcept;
  void Latch(CanopenFaultKind kind, const Node* node, unsigned code) noexcept;
  BusStatus FaultStatus() const noexcept { return StatusOf(config_, fault_); }

  /// One SYNC with its answers. kOk: all nodes have answered. Latches what it finds.
  BusStatus Cycle(DriveWish wish, const BusCommand& command) noexcept;
  void Drain(std::int64_t until_ns) noexcept;
  bool Send(DriveWish wish, const BusCommand& command) noexcept;
  /// Controlwords that switch the drives off, and a SYNC. False if a frame was not sent.
  bool SendOff() noexcept;
  CanFrame CommandFor(const Node& node, DriveWish wish, const BusCommand& command) const noexcept;
  void Collect(std::int64_t until_ns) noexcept;
  BusStatus Stuck() noexcept;
  bool BusIsGone() noexcept;
  BusStatus CountMissing() noexcept;
  void CheckHeartbeats() noexcept;
  void FollowDrive(DriveWish wish, Node* node) noexcept;
  /// True if the fault state of the drive is one that the missing supply explains.
  static bool Excused(const Node& node) noexcept;
  void FollowFault(Node* node) noexcept;
  void MarkOff() noexcept;
  void Read(SensorFrame* part) const noexcept;

  void Handle(const ReceivedFrame& received) noexcept;
  void HandleSync(const ReceivedFrame& received) noexcept;
  void HandleFeedback(const ReceivedFrame& received, Node* node) noexcept;
  void HandleEmergency(const ReceivedFrame& received, Node* node) noexcept;
  void TakeEmergency(std::uint16_t code, Node* node) noexcept;
  void HandleHeartbeat(const ReceivedFrame& received, Node* node) noexcept;

  /// An exchange that acknowledges the drives' faults: reset bit and none, in turn.
  BusStatus Acknowledge() noexcept;
  BusStatus BeginSetup() noexcept;
  void EndSetup() noexcept;
  void BeginOperation() noexcept;
  void LoseCount(const Node& node) noexcept;

  CanopenConfig config_;
  ConfirmedBus bus_;
  NodeSetup setup_;
  std::array<Node, kMaxCanopenNodes> nodes_{};
  std::size_t node_count_ = 0;
  std::uint32_t drives_ = 0;
  bool open_ = false;
  bool first_ = true;          // no exchange yet: the nodes' time-outs start with the first
  bool configuring_ = false;   // Reconnect has begun the configuration
  bool lost_ = false;          // a fault that only the configuration ends
  std::int64_t pause_ns_ = 0;  // before the next configuration
  std::int64_t next_setup_ns_ = INT64_MIN;
  int acknowledged_ = 0;             // exchanges that acknowledged the present fault
  int stuck_ = 0;                    // exchanges in a row whose frames were not sent
  const Node* malformed_ = nullptr;  // node with a malformed PDO in this exchange
  bool collecting_ = false;
  std::int64_t sync_sent_ns_ = 0;
  std::int64_t sampled_ns_ = 0;  // the SYNC's end on the bus; 0: not sent yet
  CanopenFault fault_;
  CanopenFault kept_;  // a drive's fault while fault_ is one of the configuration
  CountEpochs count_epochs_{};
  CanopenCounts counts_;
};

}  // namespace flexarm
