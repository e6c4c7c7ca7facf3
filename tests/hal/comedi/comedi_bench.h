#pragma once

#include <memory>
#include <string>
#include <utility>

#include "hal/comedi/comedi_device.h"
#include "tests/hal/comedi/simulated_daq_board.h"
#include "tests/support/message_of.h"

namespace flexarm {

inline constexpr std::int64_t kMillisecond = 1'000'000;

/// A board of the thesis's kind, with the first link's ten gauges, both amplifiers and the hub
/// encoders: a scan of 1 ms, 50 us from channel to channel.
inline ComediBoardConfig BenchBoard() {
  ComediInputConfig input{.subdevice = 0,
                          .channels = 16,
                          .bits = 12,
                          .range_v = 10.0,
                          .reference = ComediReference::kGround,
                          .acquisition = ComediAcquisition::kStream,
                          .scan_interval_us = 1000.0,
                          .convert_interval_us = 50.0,
                          .transfer_us = 200.0,
                          .channel = {}};
  for (int i = 0; i < 10; ++i) input.channel.push_back({.strain = i, .channel = 15 - i});
  return {.device = "/dev/comedi0",
          .driver = "sim",
          .board = "sim-16",
          .instruction_us = 20.0,
          .period_ms = 20.0,
          .input = input,
          .output = ComediOutputConfig{.subdevice = 1,
                                       .channels = 2,
                                       .bits = 12,
                                       .range_v = 10.0,
                                       .drive = {{.joint = 0,
                                                  .channel = 1,
                                                  .motor_torque_per_volt_nm = 0.8,
                                                  .gear = 5.0,
                                                  .sign = 1,
                                                  .torque_range_nm = 36.0},
                                                 {.joint = 1,
                                                  .channel = 0,
                                                  .motor_torque_per_volt_nm = 0.02,
                                                  .gear = 50.0,
                                                  .sign = -1,
                                                  .torque_range_nm = 7.0}}},
          .counter = {{.counter = 0, .subdevice = 3, .channel = 2, .bits = 24},
                      {.counter = 1, .subdevice = 3, .channel = 0, .bits = 24}},
          .line = {{.line = Line::kResetButton, .subdevice = 2, .channel = 3},
                   {.line = Line::kLimit1Low, .subdevice = 2, .channel = 5}}};
}

inline ComediBoardConfig SingleReads() {
  ComediBoardConfig config = BenchBoard();
  config.input->acquisition = ComediAcquisition::kSingle;
  return config;
}

/// A device on a simulated board, in virtual time.
class ComediBench {
 public:
  static constexpr std::int64_t kPeriod_ns = 20 * kMillisecond;
  static constexpr BusCommand kOff{.torque_nm = {}, .enabled = false};

  explicit ComediBench(const ComediBoardConfig& config = BenchBoard(),
                       const SimulatedDaqConfig& wired = {}) {
    auto simulated = std::make_unique<SimulatedDaqBoard>(wired);
    board = simulated.get();
    device = std::make_unique<ComediDevice>(config, std::move(simulated));
  }

  /// One exchange at the next instant of the grid.
  BusStatus Exchange(const BusCommand& command = kOff) {
    NextPeriod();
    return device->Exchange(command, &frame);
  }
  void NextPeriod() { board->AdvanceTo((board->now_ns() / kPeriod_ns + 1) * kPeriod_ns); }

  BusStatus ReconnectUntilOk(int attempts) {
    BusStatus status = BusStatus::kTimeout;
    for (int k = 0; k < attempts && status != BusStatus::kOk; ++k) {
      NextPeriod();
      status = device->Reconnect();
    }
    return status;
  }

  /// Message of Open; "" if it succeeds.
  std::string OpenError() {
    return MessageOf<HalError>([this] { device->Open(); });
  }

  SimulatedDaqBoard* board;
  std::unique_ptr<ComediDevice> device;
  SensorFrame frame{};
};

}  // namespace flexarm
