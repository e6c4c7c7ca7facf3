#pragma once

#include <cstdint>

#include "hal/canopen/can_frame.h"
#include "hal/canopen/object_dictionary.h"

namespace flexarm {

/// Service data objects, expedited transfers only: values of 1 to 4 bytes, CiA 301 7.2.4.3.

/// Why a transfer was aborted: the codes that a server of ours sends.
inline constexpr std::uint32_t kSdoAbortBadCommand = 0x0504'0001;
inline constexpr std::uint32_t kSdoAbortReadOnly = 0x0601'0002;
inline constexpr std::uint32_t kSdoAbortNoObject = 0x0602'0000;
inline constexpr std::uint32_t kSdoAbortNotMappable = 0x0604'0041;
inline constexpr std::uint32_t kSdoAbortPdoTooLong = 0x0604'0042;
inline constexpr std::uint32_t kSdoAbortWrongLength = 0x0607'0010;
inline constexpr std::uint32_t kSdoAbortNoSubIndex = 0x0609'0011;
inline constexpr std::uint32_t kSdoAbortValueRange = 0x0609'0030;
inline constexpr std::uint32_t kSdoAbortDeviceState = 0x0800'0022;

/// The words of CiA 301 for an abort code; "unknown reason" for one that it does not have.
const char* SdoAbortText(std::uint32_t code) noexcept;

/// Client: asks node `node_id` for the value of `object`.
CanFrame SdoReadRequest(int node_id, CanopenObject object) noexcept;
/// Client: sets it. @param size  1..4 bytes
CanFrame SdoWriteRequest(int node_id, CanopenObject object, std::uint32_t value, int size) noexcept;

/// What a server has answered.
struct SdoReply {
  enum class Kind : std::uint8_t { kMalformed, kWritten, kValue, kAborted };
  Kind kind;
  CanopenObject object;
  std::uint32_t value;  ///< of kValue: the value, zero-extended; of kAborted: the abort code
  int size;             ///< of kValue: bytes
};
/// A segmented answer is kMalformed: nothing that is asked for here is longer than 4 bytes.
SdoReply DecodeSdoReply(const CanFrame& frame) noexcept;

/// What a client asks.
struct SdoRequest {
  enum class Kind : std::uint8_t { kMalformed, kRead, kWrite };
  Kind kind;
  CanopenObject object;
  std::uint32_t value;  ///< of kWrite
  int size;             ///< of kWrite: bytes
};
SdoRequest DecodeSdoRequest(const CanFrame& frame) noexcept;

/// Server's answers.
CanFrame SdoWrittenReply(int node_id, CanopenObject object) noexcept;
/// The value asked for. @param size  1..4 bytes
CanFrame SdoValueReply(int node_id, CanopenObject object, std::uint32_t value, int size) noexcept;
/// The refusal, with one of sdo_abort.
CanFrame SdoAbortReply(int node_id, CanopenObject object, std::uint32_t code) noexcept;

}  // namespace flexarm
