#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hal/bus_device.h"
#include "hal/modbus/modbus_config.h"
#include "hal/modbus/modbus_link.h"
#include "hal/modbus/modbus_plan.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Driver of strain amplifiers and remote inputs on Modbus/TCP or Modbus RTU.
///
/// An exchange reads every row of the map, in the requests of the plan, and ends with the first
/// that fails. The time of a reading is the middle of its request: sampled_at_ns is that of the
/// first request, offsets are relative to it. A channel whose value is not a number, or does not
/// fit, is marked not valid while the others stay valid: a broken amplifier channel must not
/// invalidate its neighbours.
/// Replies on a serial line have no transaction number. So after a failure there the next exchange
/// first reads an identification register: its reply has another form than every reading's, so a
/// late one is recognised.
/// Statuses: an exception of the device is kMalformed, counted separately; a second mismatch in a
/// row is kDisconnected, as is everything until Reconnect has succeeded.
/// Real-time: Exchange, Reconnect and Close do not allocate. Thread: the bus's own.
class ModbusDevice final : public BusDevice {
 public:
  /// @param config  without problems
  ModbusDevice(ModbusDeviceConfig config, ModbusClock clock);

  const char* name() const noexcept override { return config_.name.c_str(); }
  /// Bound of an exchange, or of connecting and identifying, whichever is longer.
  std::int64_t worst_case_ns() const noexcept override;

  /// Connects, reads the settings and the identification back, and reads every row once.
  /// @throws HalError naming the device, the registers, what was found and what was expected
  void Open() override;

  [[nodiscard]] BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override;

  /// Connects and identifies again. A failed attempt doubles the pause before the next, up to
  /// 1.6 s; within the pause it returns at once.
  [[nodiscard]] BusStatus Reconnect() noexcept override;

  std::span<const char* const> counter_names() const noexcept override;
  BusCounters counter_values() const noexcept override;
  LineLevels lines() const noexcept override { return lines_; }

  BusFault FaultOf(BusStatus status) const noexcept override;
  std::string FaultText(const BusFault& fault) const override;

  void Close() noexcept override { link_.Close(); }

  /// The strain channels that an exchange reads; bit i is channel i.
  std::uint32_t strain_channels() const noexcept { return strain_channels_; }

  const ModbusPlan& plan() const noexcept { return plan_; }
  const ModbusCounters& counters() const noexcept { return link_.counters(); }
  /// Number of readings that were not a number, or did not fit.
  std::uint64_t values_refused() const noexcept { return values_refused_; }

 private:
  struct Wrong {  // an identification register with a wrong value
    const ModbusIdentity* identity;
    int found;
  };

  BusStatus ReadAll(SensorFrame* fresh) noexcept;
  BusStatus Prove(const ModbusRequest& request, Wrong* wrong) noexcept;
  BusStatus ConnectAndProve(Wrong* wrong) noexcept;
  void Take(const ModbusRequest& request, const ModbusReply& reply, SensorFrame* fresh) noexcept;
  void KeepAges(SensorFrame* fresh) const noexcept;
  std::string Place() const;
  std::string Refusal(const ModbusRequest& request, BusStatus status) const;

  ModbusDeviceConfig config_;
  ModbusPlan plan_;
  ModbusClock clock_;
  ModbusLink link_;
  std::uint32_t strain_channels_ = 0;
  LineLevels lines_ = 0;
  SensorFrame last_{};  // good values, repeated while there are no new ones
  bool prove_first_ = false;
  const ModbusRequest* failed_ = nullptr;  // the last request, for messages
  std::int64_t pause_ns_;
  std::int64_t next_attempt_ns_ = INT64_MIN;
  std::uint64_t values_refused_ = 0;
};

}  // namespace flexarm
