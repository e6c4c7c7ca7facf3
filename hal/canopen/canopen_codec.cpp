#include "hal/canopen/canopen_codec.h"

#include <algorithm>

namespace flexarm {

CanFrame EncodeNmt(NmtCommand command, int node_id) noexcept {
  CanFrame frame{.id = kCobNmt, .length = 2};
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = static_cast<std::uint8_t>(node_id);
  return frame;
}

std::optional<NmtOrder> DecodeNmt(const CanFrame& frame) noexcept {
  using enum NmtCommand;
  if (frame.length != 2 || frame.data[1] > kMaxNodeId) return std::nullopt;
  for (const NmtCommand c : {kStart, kStop, kPreOperational, kResetNode, kResetCommunication}) {
    if (frame.data[0] == static_cast<std::uint8_t>(c)) return NmtOrder{c, frame.data[1]};
  }
  return std::nullopt;
}

CanFrame EncodeSync() noexcept { return {.id = kCobSync, .length = 0}; }

CanFrame EncodeHeartbeat(int node_id, NmtState state) noexcept {
  CanFrame frame{.id = CobId(kCobHeartbeat, node_id), .length = 1};
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

std::optional<NmtState> DecodeHeartbeat(const CanFrame& frame) noexcept {
  using enum NmtState;
  if (frame.length != 1) return std::nullopt;
  for (const NmtState s : {kBooting, kStopped, kOperational, kPreOperational}) {
    if (frame.data[0] == static_cast<std::uint8_t>(s)) return s;
  }
  return std::nullopt;
}

CanFrame EncodeEmergency(int node_id, const Emergency& emergency) noexcept {
  CanFrame frame{.id = CobId(kCobEmergency, node_id), .length = 8};
  StoreLe(frame.data, 0, emergency.code);
  frame.data[2] = emergency.error_register;
  std::copy(emergency.vendor_bytes.begin(), emergency.vendor_bytes.end(), frame.data.begin() + 3);
  return frame;
}

std::optional<Emergency> DecodeEmergency(const CanFrame& frame) noexcept {
  if (frame.length != 8) return std::nullopt;
  Emergency emergency{.code = LoadLe<std::uint16_t>(frame.data, 0),
                      .error_register = frame.data[2],
                      .vendor_bytes = {}};
  std::copy(frame.data.begin() + 3, frame.data.end(), emergency.vendor_bytes.begin());
  return emergency;
}

CanFrame EncodeDriveCommand(int node_id, const DriveCommand& command) noexcept {
  CanFrame frame{.id = CobId(kCobRpdo, node_id), .length = 4};
  StoreLe(frame.data, 0, command.controlword);
  StoreLe(frame.data, 2, static_cast<std::uint16_t>(command.torque_per_mille));
  return frame;
}

std::optional<DriveCommand> DecodeDriveCommand(const CanFrame& frame) noexcept {
  if (frame.length != 4) return std::nullopt;
  return DriveCommand{
      .controlword = LoadLe<std::uint16_t>(frame.data, 0),
      .torque_per_mille = static_cast<std::int16_t>(LoadLe<std::uint16_t>(frame.data, 2))};
}

CanFrame EncodeDriveFeedback(int node_id, const DriveFeedback& feedback) noexcept {
  CanFrame frame{.id = CobId(kCobTpdo, node_id), .length = 8};
  StoreLe(frame.data, 0, feedback.statusword);
  StoreLe(frame.data, 2, static_cast<std::uint32_t>(feedback.position_counts));
  StoreLe(frame.data, 6, static_cast<std::uint16_t>(feedback.torque_per_mille));
  return frame;
}

std::optional<DriveFeedback> DecodeDriveFeedback(const CanFrame& frame) noexcept {
  if (frame.length != 8) return std::nullopt;
  return DriveFeedback{
      .statusword = LoadLe<std::uint16_t>(frame.data, 0),
      .position_counts = static_cast<std::int32_t>(LoadLe<std::uint32_t>(frame.data, 2)),
      .torque_per_mille = static_cast<std::int16_t>(LoadLe<std::uint16_t>(frame.data, 6))};
}

CanFrame EncodeEncoderPosition(int node_id, std::uint32_t position_counts) noexcept {
  CanFrame frame{.id = CobId(kCobTpdo, node_id), .length = 4};
  StoreLe(frame.data, 0, position_counts);
  return frame;
}

std::optional<std::uint32_t> DecodeEncoderPosition(const CanFrame& frame) noexcept {
  if (frame.length != 4) return std::nullopt;
  return LoadLe<std::uint32_t>(frame.data, 0);
}

}  // namespace flexarm
