#pragma once

#include <cstdint>

#include "hal/canopen/can_frame.h"
#include "hal/canopen/object_dictionary.h"

namespace flexarm {

/// Service data objects, expedited transfers only: values of 1 to 4 bytes, CiA 301 7.2.4.3.

/// Abort codes of a transfer: those that our server sends.
inline constexpr std::uint32_t kSdoAbortBadCommand = 0x0504'0001;
inline constexpr std::uint32_t kSdoAbortReadOnly = 0x0601'0002;
inline constexpr std::uint32_t kSdoAbortNoObject = 0x0602'0000;
inline constexpr std::uint32_t kSdoAbortNotMappable = 0x0604'0041;
inline constexpr std::uint32_t kSdoAbortPdoTooLong = 0x0604'0042;
inline constexpr std::uint32_t kSdoAbortWrongLength = 0x0607'0010;
inline constexpr std::uint32_t kSdoAbortNoSubIndex = 0x0609'0011;
inline constexpr std::uint32_t kSdoAbortValueRange = 0x0609'0030;
inline constexpr std::uint32_t kSdoAbortDeviceState = 0x0800'0022;

/// Text of CiA 301 for an abort code; "unknown reason" for a code that it lacks.
const char* SdoAbortText(std::uint32_t code) noexcept;

/// Client: request to read `object` of node `node_id`.
CanFrame SdoReadRequest(int node_id, CanopenObject object) noexcept;
/// Client: request to write it. @param size  1..4 bytes
CanFrame SdoWriteRequest(int node_id, CanopenObject object, std::uint32_t value, int size) noexcept;

/// A decoded reply of a server.
struct SdoReply {
  enum class Kind : std::uint8_t { kMalformed, kWritten, kValue, kAborted };
  Kind kind;
  CanopenObject object;
  std::uint32_t value;  ///< of kValue: the value, zero-extended; of kAborted: the abort code
  int size;             ///< of kValue: bytes
};
/// A segmented reply is kMalformed: every value requested here has at most 4 bytes.
SdoReply DecodeSdoReply(const CanFrame& frame) noexcept;

/// A decoded request of a client.
struct SdoRequest {
  enum class Kind : std::uint8_t { kMalformed, kRead, kWrite };
  Kind kind;
  CanopenObject object;
  std::uint32_t value;  ///< of kWrite
  int size;             ///< of kWrite: bytes
};
SdoRequest DecodeSdoRequest(const CanFrame& frame) noexcept;

/// Server: confirmation of a write.
CanFrame SdoWrittenReply(int node_id, CanopenObject object) noexcept;
/// Server: the requested value. @param size  1..4 bytes
CanFrame SdoValueReply(int node_id, CanopenObject object, std::uint32_t value, int size) noexcept;
/// Server: abort, with one of the abort codes.
CanFrame SdoAbortReply(int node_id, CanopenObject object, std::uint32_t code) noexcept;

}  // namespace flexarm
