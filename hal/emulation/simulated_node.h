#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/canopen/can_bus.h"
#include "hal/canopen/canopen_codec.h"
#include "hal/canopen/canopen_config.h"
#include "hal/canopen/drive_state.h"
#include "hal/canopen/object_dictionary.h"
#include "hal/canopen/sdo.h"
#include "hal/emulation/drive_supply.h"

namespace flexarm {

/// Identity and kind of a simulated node.
struct SimulatedNodeConfig {
  bool drive;  ///< CiA 402 drive, or CiA 406 encoder
  int node_id;
  std::uint32_t vendor;
  std::uint32_t product;
  std::uint32_t serial;
  std::uint32_t rated_torque_mnm;                         ///< of a drive's motor
  std::optional<DriveSupplyModel> supply = std::nullopt;  ///< of a drive; none: always supplied
};

/// The simulated node that matches a rig's config.
SimulatedNodeConfig SimulatedNodeOf(const CanopenNodeConfig& config);

/// Injected faults of a simulated node.
struct Misbehaviour {
  bool silent = false;                                     ///< sends and receives nothing: no power
  bool answers_no_sync = false;                            ///< heartbeats continue
  bool no_heartbeat = false;                               ///< everything else continues
  bool cuts_pdos = false;                                  ///< sends its PDOs a byte too short
  std::optional<std::uint16_t> statusword = std::nullopt;  ///< constant value
  std::uint16_t refuses_index = 0;                         ///< aborts a write to this object
  std::uint16_t forgets_index = 0;   ///< acknowledges a write to it, and keeps the old value
  bool has_no_abort_option = false;  ///< object 6007 does not exist
  bool keeps_torque = false;         ///< ignores its heartbeat consumer
  bool another_product = false;      ///< 1018:2 differs: the node was replaced by another product
};

/// A CiA 402 drive in cyclic synchronous torque mode, or a CiA 406 encoder, on a CanBus: object
/// dictionary with SDO server, PDOs as mapped, on SYNC, heartbeat producer and consumer. A drive
/// that misses the heartbeat of its master reacts as configured in 6007.
///
/// NMT reset resets everything; the encoder's position survives a reset of communication only:
/// after the others it counts from 0. With a supply model, a drive without DC link is in fault.
/// Real-time: Run is safe. Thread: that of its bus.
class SimulatedNode {
 public:
  SimulatedNode(CanBus* bus, const SimulatedNodeConfig& config);

  /// Joins the bus and sends the boot-up message. @throws HalError
  void Start();
  /// Handles received frames and due timers. The call rate is the resolution of its timers.
  void Run() noexcept;

  /// Torque on the motor's shaft in 0.1 % of rated: 0 unless operation is enabled.
  int torque_per_mille() const noexcept;
  DriveState state() const noexcept { return state_; }
  NmtState nmt() const noexcept { return nmt_; }
  /// Turns the encoder to `counts`; 6064 or 6004 is what it has counted since it lost its count.
  void SetPosition(std::uint32_t counts) noexcept;
  /// Loses power and gets it again at once: counts from 0 and sends the boot-up message.
  void PowerCycle() noexcept;
  /// The relay feeds the drive. Without supply model: no effect.
  void Feed(bool fed) noexcept;
  /// The value of an object; 0 if there is none.
  std::uint32_t Value(CanopenObject object) const noexcept;

  /// Sends an emergency message, and sets the fault state of a drive.
  void RaiseFault(std::uint16_t code) noexcept;
  /// Sets the injected faults; `{}` removes them.
  void Misbehave(const Misbehaviour& wrong) noexcept { wrong_ = wrong; }

 private:
  struct Entry {
    CanopenObject object;
    int size;
    bool writable;
    std::uint32_t value;
  };

  void FillDictionary() noexcept;
  void Add(CanopenObject object, int size, bool writable, std::uint32_t value) noexcept;
  void AddPdo(std::uint16_t communication, std::uint32_t cob_id, std::uint16_t mapping,
              int entries) noexcept;
  Entry* Find(CanopenObject object) noexcept;
  void Set(CanopenObject object, std::uint32_t value) noexcept;
  void Transmit(const CanFrame& frame) noexcept;

  void Handle(const CanFrame& frame) noexcept;
  void HandleNmt(const NmtOrder& order) noexcept;
  void HandleSdo(const CanFrame& frame) noexcept;
  /// Abort code, or 0 if the value was accepted.
  std::uint32_t Write(CanopenObject object, std::uint32_t value, int size) noexcept;
  std::uint32_t CheckMapping(std::uint16_t index, std::uint32_t count) const noexcept;
  void HandleSync() noexcept;
  void TakeCommand() noexcept;
  void Follow(std::uint16_t control) noexcept;
  void SendPdo() noexcept;
  void Boot() noexcept;
  void LoseCount() noexcept;
  void FollowSupply() noexcept;
  bool Supplied() const noexcept { return !supply_ || supply_->up(bus_->now_ns()); }
  void LoseMaster() noexcept;
  void RemoveTorque(DriveState next) noexcept;

  CanBus* bus_;
  SimulatedNodeConfig config_;
  Misbehaviour wrong_;
  std::array<Entry, 64> dictionary_{};
  std::size_t entries_ = 0;
  NmtState nmt_ = NmtState::kBooting;
  DriveState state_ = DriveState::kSwitchOnDisabled;
  std::uint16_t last_control_ = 0;
  std::optional<DriveSupply> supply_;
  bool supply_fault_ = false;  // the fault state is that of the supply
  std::int64_t switched_on_ns_ = 0;
  std::uint32_t turned_to_ = 0;      // the encoder, by SetPosition
  std::uint32_t counts_from_ = 0;    // where it last lost its count
  std::optional<CanFrame> command_;  // received RPDO, applied at SYNC
  std::int64_t next_heartbeat_ns_ = 0;
  std::optional<std::int64_t> master_heard_ns_;
};

}  // namespace flexarm
