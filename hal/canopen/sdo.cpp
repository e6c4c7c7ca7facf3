#include "hal/canopen/sdo.h"

#include <array>

#include "hal/canopen/canopen_codec.h"

namespace flexarm {
namespace {

// First byte: command specifier in bits 7..5; for expedited transfers bit 1 is set, and with bit 0
// set, bits 3..2 are the number of bytes without data.
constexpr std::uint8_t kSpecifier = 0xE0;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSizeGiven = 0x01;
constexpr std::uint8_t kDownloadRequest = 0x20;
constexpr std::uint8_t kUploadRequest = 0x40;
constexpr std::uint8_t kDownloadReply = 0x60;
constexpr std::uint8_t kUploadReply = 0x40;
constexpr std::uint8_t kAbort = 0x80;

CanFrame Make(std::uint32_t id, std::uint8_t command, CanopenObject object, std::uint32_t value) {
  CanFrame frame{.id = id, .length = 8};
  frame.data[0] = command;
  StoreLe(frame.data, 1, object.index);
  frame.data[3] = object.sub;
  StoreLe(frame.data, 4, value);
  return frame;
}

constexpr std::uint8_t WithSize(std::uint8_t command, int size) {
  return static_cast<std::uint8_t>(command | kExpedited | kSizeGiven |
                                   static_cast<unsigned>(4 - size) << 2U);
}

constexpr int SizeOf(std::uint8_t command) {
  return (command & kSizeGiven) != 0 ? 4 - (command >> 2 & 3) : 4;
}

constexpr std::uint32_t Truncated(std::uint32_t value, int size) {
  return size >= 4 ? value : value & ((1U << static_cast<unsigned>(8 * size)) - 1U);
}

CanopenObject ObjectOf(const CanFrame& frame) {
  return {LoadLe<std::uint16_t>(frame.data, 1), frame.data[3]};
}

struct AbortText {
  std::uint32_t code;
  const char* text;
};
constexpr std::array kAbortTexts = {
    AbortText{0x0503'0000, "toggle bit not alternated"},
    AbortText{0x0504'0000, "SDO protocol timed out"},
    AbortText{0x0504'0001, "command specifier not valid or unknown"},
    AbortText{0x0504'0005, "out of memory"},
    AbortText{0x0601'0000, "unsupported access to an object"},
    AbortText{0x0601'0001, "attempt to read a write only object"},
    AbortText{0x0601'0002, "attempt to write a read only object"},
    AbortText{0x0602'0000, "object does not exist in the object dictionary"},
    AbortText{0x0604'0041, "object cannot be mapped to the PDO"},
    AbortText{0x0604'0042, "number and length of the mapped objects exceed the PDO length"},
    AbortText{0x0604'0043, "general parameter incompatibility"},
    AbortText{0x0604'0047, "general internal incompatibility in the device"},
    AbortText{0x0606'0000, "access failed due to a hardware error"},
    AbortText{0x0607'0010, "data type does not match, length of service parameter wrong"},
    AbortText{0x0607'0012, "data type does not match, length too high"},
    AbortText{0x0607'0013, "data type does not match, length too low"},
    AbortText{0x0609'0011, "sub-index does not exist"},
    AbortText{0x0609'0030, "invalid value for parameter"},
    AbortText{0x0609'0031, "value of parameter written too high"},
    AbortText{0x0609'0032, "value of parameter written too low"},
    AbortText{0x0609'0036, "maximum value is less than minimum value"},
    AbortText{0x060A'0023, "resource not available"},
    AbortText{0x0800'0000, "general error"},
    AbortText{0x0800'0020, "data cannot be transferred or stored"},
    AbortText{0x0800'0021, "data cannot be transferred or stored because of local control"},
    AbortText{0x0800'0022, "data cannot be transferred or stored in the present device state"},
    AbortText{0x0800'0024, "no data available"},
};

}  // namespace

const char* SdoAbortText(std::uint32_t code) noexcept {
  for (const AbortText& entry : kAbortTexts) {
    if (entry.code == code) return entry.text;
  }
  return "unknown reason";
}

CanFrame SdoReadRequest(int node_id, CanopenObject object) noexcept {
  return Make(CobId(kCobSdoRequest, node_id), kUploadRequest, object, 0);
}

CanFrame SdoWriteRequest(int node_id, CanopenObject object, std::uint32_t value,
                         int size) noexcept {
  return Make(CobId(kCobSdoRequest, node_id), WithSize(kDownloadRequest, size), object,
              Truncated(value, size));
}

SdoReply DecodeSdoReply(const CanFrame& frame) noexcept {
  SdoReply reply{.kind = SdoReply::Kind::kMalformed, .object = {}, .value = 0, .size = 0};
  if (frame.length != 8) return reply;
  reply.object = ObjectOf(frame);
  const std::uint8_t command = frame.data[0];
  const auto value = LoadLe<std::uint32_t>(frame.data, 4);
  if ((command & kSpecifier) == kDownloadReply) {
    reply.kind = SdoReply::Kind::kWritten;
  } else if ((command & kSpecifier) == kAbort) {
    reply.kind = SdoReply::Kind::kAborted;
    reply.value = value;
  } else if ((command & kSpecifier) == kUploadReply && (command & kExpedited) != 0) {
    reply.kind = SdoReply::Kind::kValue;
    reply.size = SizeOf(command);
    reply.value = Truncated(value, reply.size);
  }
  return reply;
}

SdoRequest DecodeSdoRequest(const CanFrame& frame) noexcept {
  SdoRequest request{.kind = SdoRequest::Kind::kMalformed, .object = {}, .value = 0, .size = 0};
  if (frame.length != 8) return request;
  request.object = ObjectOf(frame);
  const std::uint8_t command = frame.data[0];
  if ((command & kSpecifier) == kUploadRequest) {
    request.kind = SdoRequest::Kind::kRead;
  } else if ((command & kSpecifier) == kDownloadRequest && (command & kExpedited) != 0) {
    request.kind = SdoRequest::Kind::kWrite;
    request.size = SizeOf(command);
    request.value = Truncated(LoadLe<std::uint32_t>(frame.data, 4), request.size);
  }
  return request;
}

CanFrame SdoWrittenReply(int node_id, CanopenObject object) noexcept {
  return Make(CobId(kCobSdoReply, node_id), kDownloadReply, object, 0);
}

CanFrame SdoValueReply(int node_id, CanopenObject object, std::uint32_t value, int size) noexcept {
  return Make(CobId(kCobSdoReply, node_id), WithSize(kUploadReply, size), object,
              Truncated(value, size));
}

CanFrame SdoAbortReply(int node_id, CanopenObject object, std::uint32_t code) noexcept {
  return Make(CobId(kCobSdoReply, node_id), kAbort, object, code);
}

}  // namespace flexarm
