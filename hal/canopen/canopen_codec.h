#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/canopen/can_frame.h"

namespace flexarm {

/// Identifiers of CiA 301's predefined connection set.
inline constexpr std::uint32_t kCobNmt = 0x000;
inline constexpr std::uint32_t kCobSync = 0x080;
inline constexpr std::uint32_t kCobEmergency = 0x080;  ///< + node id, as all below
inline constexpr std::uint32_t kCobTpdo = 0x180;
inline constexpr std::uint32_t kCobRpdo = 0x200;
inline constexpr std::uint32_t kCobSdoReply = 0x580;
inline constexpr std::uint32_t kCobSdoRequest = 0x600;
inline constexpr std::uint32_t kCobHeartbeat = 0x700;

/// `function` + node id.
constexpr std::uint32_t CobId(std::uint32_t function, int node_id) noexcept {
  return function + static_cast<std::uint32_t>(node_id);
}

inline constexpr int kMaxNodeId = 127;

/// NMT commands of a master.
enum class NmtCommand : std::uint8_t {
  kStart = 0x01,
  kStop = 0x02,
  kPreOperational = 0x80,
  kResetNode = 0x81,
  kResetCommunication = 0x82,
};

/// NMT state of a node as its heartbeat reports it.
enum class NmtState : std::uint8_t {
  kBooting = 0x00,  ///< the boot-up message
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
};

/// A received NMT command.
struct NmtOrder {
  NmtCommand command;
  int node_id;  ///< 0: all
};

/// An emergency message. Code 0: the error is cleared.
struct Emergency {
  std::uint16_t code;
  std::uint8_t error_register;
  std::array<std::uint8_t, 5> vendor_bytes;
};

/// Command to a drive: RPDO 1, mapped 6040, 6071.
struct DriveCommand {
  std::uint16_t controlword;
  std::int16_t torque_per_mille;  ///< of the rated torque, in the motor's sense
};

/// A drive's reply to SYNC: TPDO 1, mapped 6041, 6064, 6077.
struct DriveFeedback {
  std::uint16_t statusword;
  std::int32_t position_counts;
  std::int16_t torque_per_mille;
};

/// `node_id` 0: all nodes.
CanFrame EncodeNmt(NmtCommand command, int node_id) noexcept;
std::optional<NmtOrder> DecodeNmt(const CanFrame& frame) noexcept;

CanFrame EncodeSync() noexcept;

/// The boot-up message is the heartbeat with kBooting.
CanFrame EncodeHeartbeat(int node_id, NmtState state) noexcept;
/// Empty if the frame cannot be a heartbeat: length or state unknown.
std::optional<NmtState> DecodeHeartbeat(const CanFrame& frame) noexcept;

/// The node's emergency message.
CanFrame EncodeEmergency(int node_id, const Emergency& emergency) noexcept;
std::optional<Emergency> DecodeEmergency(const CanFrame& frame) noexcept;

/// PDOs: empty if the length is not that of the mapping.
CanFrame EncodeDriveCommand(int node_id, const DriveCommand& command) noexcept;
std::optional<DriveCommand> DecodeDriveCommand(const CanFrame& frame) noexcept;
CanFrame EncodeDriveFeedback(int node_id, const DriveFeedback& feedback) noexcept;
std::optional<DriveFeedback> DecodeDriveFeedback(const CanFrame& frame) noexcept;
CanFrame EncodeEncoderPosition(int node_id, std::uint32_t position_counts) noexcept;
std::optional<std::uint32_t> DecodeEncoderPosition(const CanFrame& frame) noexcept;

}  // namespace flexarm
