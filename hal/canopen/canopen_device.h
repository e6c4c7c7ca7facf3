#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/bus_device.h"
#include "hal/canopen/can_bus.h"
#include "hal/canopen/canopen_codec.h"
#include "hal/canopen/canopen_config.h"
#include "hal/canopen/canopen_fault.h"
#include "hal/canopen/drive_state.h"
#include "hal/canopen/node_setup.h"

namespace flexarm {

/// Frames that were not taken, since Open.
struct CanopenCounts {
  std::uint32_t stale = 0;       ///< PDOs of before the SYNC, dropped by their time stamp
  std::uint32_t duplicated = 0;  ///< second answers to one SYNC
  std::uint32_t malformed = 0;   ///< of a length or content that the protocol does not have
  std::uint32_t missed = 0;      ///< answers that did not come in time
};

/// The CANopen nodes of one interface: drives in cyclic synchronous torque mode, encoders.
///
/// One exchange: torque and controlword to each drive, SYNC, the daemon's heartbeat; then the PDOs
/// that answer SYNC, until all have come or the answer time is over. All nodes latch, and all
/// drives act, at the SYNC: it is the sampling instant, and every offset is 0.
///
/// Torque goes out only while enabled and only to a drive that said "operation enabled" in the last
/// exchange. A fault latches: drives are told off until Reconnect, which may be called while
/// disarmed only; it resets the drives' faults, or configures all nodes anew if one was lost. If
/// the last frames have not gone out, nothing is added to them: at most one exchange can be queued,
/// and Reconnect throws that away. If the daemon dies, the drives miss its heartbeat (1016) and
/// remove their torque (6007) within master_timeout_ms.
class CanopenDevice : public BusDevice {
 public:
  /// @param config  without problems
  CanopenDevice(CanopenConfig config, std::unique_ptr<CanBus> bus);
  CanopenDevice(const CanopenDevice&) = delete;
  CanopenDevice& operator=(const CanopenDevice&) = delete;

  const char* name() const noexcept override { return config_.interface.c_str(); }
  std::uint32_t drives() const noexcept override { return drives_; }
  std::int64_t worst_case_ns() const noexcept override { return config_.worst_case_exchange_ns(); }
  void Open() override;
  [[nodiscard]] BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override;
  [[nodiscard]] BusStatus Reconnect() noexcept override;
  BusFault FaultOf(BusStatus status) const noexcept override;
  std::string FaultText(const BusFault& fault) const override;
  void Close() noexcept override;

  /// What latched, for the log. Thread: the bus's.
  const CanopenFault& fault() const noexcept { return fault_; }
  const CanopenCounts& counts() const noexcept { return counts_; }
  const CanCounts& bus_counts() const noexcept { return bus_->counts(); }
  const CanopenConfig& config() const noexcept { return config_; }
  /// State of the drive of joint `joint` (0, 1) at the last exchange; kUnknown if it is elsewhere.
  DriveState drive_state(int joint) const noexcept;
  /// Torque that it says it makes, at the gearbox output, positive as the joint.
  double drive_torque_nm(int joint) const noexcept;

 private:
  struct Node {
    const CanopenNodeConfig* config = nullptr;
    DriveState state = DriveState::kUnknown;
    std::uint16_t statusword = 0;
    std::int16_t torque_per_mille = 0;
    std::uint32_t counts = 0;
    std::int64_t heartbeat_ns = 0;
    bool answered = false;     // this SYNC
    bool was_enabled = false;  // has been in operation since it was last told off
    int missed = 0;            // SYNCs in a row
    int waiting = 0;           // exchanges that it does not follow the controlword
  };

  std::span<Node> nodes() noexcept { return std::span(nodes_).first(node_count_); }
  Node* Find(int node_id) noexcept;
  const Node* Drive(int joint) const noexcept;
  std::int64_t answer_ns() const noexcept;
  void Latch(CanopenFaultKind kind, const Node* node, unsigned code) noexcept;
  BusStatus FaultStatus() const noexcept { return StatusOf(config_, fault_); }

  /// One SYNC with its answers. kOk: everybody has answered.
  BusStatus Cycle(DriveWish wish, const BusCommand& command) noexcept;
  void Drain(std::int64_t until_ns) noexcept;
  bool Send(DriveWish wish, const BusCommand& command) noexcept;
  CanFrame CommandFor(const Node& node, DriveWish wish, const BusCommand& command) const noexcept;
  void Collect(std::int64_t until_ns) noexcept;
  BusStatus Stuck() noexcept;
  bool BusIsGone() noexcept;
  BusStatus CountMissing() noexcept;
  void CheckHeartbeats() noexcept;
  void FollowDrive(DriveWish wish, Node* node) noexcept;

  void Handle(const ReceivedFrame& received) noexcept;
  void HandleSync(const ReceivedFrame& received) noexcept;
  void HandleFeedback(const ReceivedFrame& received, Node* node) noexcept;
  void HandleEmergency(const ReceivedFrame& received, const Node* node) noexcept;
  void HandleHeartbeat(const ReceivedFrame& received, Node* node) noexcept;

  BusStatus ConfigureAnew() noexcept;
  BusStatus ResetFaults() noexcept;
  void BeginOperation() noexcept;

  CanopenConfig config_;
  std::unique_ptr<CanBus> bus_;
  NodeSetup setup_;
  std::array<Node, kMaxCanopenNodes> nodes_{};
  std::size_t node_count_ = 0;
  std::uint32_t drives_ = 0;
  bool open_ = false;
  bool first_ = true;                // no exchange yet: the nodes' time-outs begin with it
  bool configuring_ = false;         // Reconnect is in the middle of it
  int resets_ = 0;                   // attempts to reset the drives' faults
  int stuck_ = 0;                    // exchanges in a row whose frames did not go out
  const Node* malformed_ = nullptr;  // whose PDO was none, in this exchange
  bool collecting_ = false;
  std::int64_t sync_sent_ns_ = 0;
  std::int64_t sampled_ns_ = 0;  // the SYNC's end on the bus; 0: it has not gone out
  CanopenFault fault_;
  CanopenCounts counts_;
};

}  // namespace flexarm
