#include "hal/emulation/modbus_reply.h"

#include <cstddef>

namespace flexarm {
namespace {

constexpr std::size_t kTcpHeader = 7;   // transaction, protocol, length, unit
constexpr std::size_t kRtuRequest = 8;  // unit, function, address, count, checksum
constexpr unsigned kMostBits = 2000, kMostRegisters = 125;
constexpr std::uint8_t kException = 0x80;

enum Code : std::uint8_t {
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kDeviceFailure = 4,
  kTargetFailed = 11,
};

unsigned WordAt(const ModbusBytes& bytes, std::size_t at) {
  return static_cast<unsigned>(bytes[at]) << 8U | bytes[at + 1];
}

void Append(ModbusBytes* bytes, unsigned word) {
  bytes->push_back(static_cast<std::uint8_t>(word >> 8U));
  bytes->push_back(static_cast<std::uint8_t>(word & 0xFFU));
}

// Modbus over serial line V1.02, 6.2.2; the first byte sent in the lower half.
unsigned Checksum(const ModbusBytes& bytes, std::size_t count) {
  unsigned crc = 0xFFFF;
  for (std::size_t n = 0; n < count; ++n) {
    crc ^= bytes[n];
    for (int i = 0; i < 8; ++i) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xA001U : crc >> 1U;
  }
  return crc;
}

void AppendChecksum(ModbusBytes* frame, WireFault fault) {
  const unsigned crc =
      Checksum(*frame, frame->size()) ^ (fault == WireFault::kBadChecksum ? 1U : 0U);
  Append(frame, (crc & 0xFFU) << 8U | crc >> 8U);
}

ModbusBytes Refusal(std::uint8_t function, Code code) {
  return {static_cast<std::uint8_t>(function | kException), code};
}

ModbusBytes Payload(const RegisterImage& image, ModbusTable table, std::size_t first,
                    std::size_t count) {
  std::vector<std::uint16_t> cells(static_cast<std::size_t>(image.extent(table).count));
  image.Copy(table, cells.data());
  ModbusBytes payload;
  if (!HoldsBits(table)) {
    for (std::size_t i = 0; i < count; ++i) Append(&payload, cells[first + i]);
    return payload;
  }
  payload.resize((count + 7) / 8);
  for (std::size_t i = 0; i < count; ++i) {
    if (cells[first + i] != 0) {
      payload[i / 8] = static_cast<std::uint8_t>(payload[i / 8] | 1U << (i % 8));
    }
  }
  return payload;
}

// Function code and data of the reply to a request.
ModbusBytes Answer(const RegisterImage& image, const ModbusBytes& body, WireFault fault) {
  const std::uint8_t function = body[0];
  if (function < 1 || function > 4) return Refusal(function, kIllegalFunction);
  if (body.size() < 5) return Refusal(function, kIllegalValue);
  const auto table = static_cast<ModbusTable>(function);
  const unsigned address = WordAt(body, 1), count = WordAt(body, 3);
  if (count < 1 || count > (HoldsBits(table) ? kMostBits : kMostRegisters)) {
    return Refusal(function, kIllegalValue);
  }
  const RegisterImage::Extent extent = image.extent(table);
  const int first = static_cast<int>(address) - extent.start;
  if (first < 0 || first + static_cast<int>(count) > extent.count) {
    return Refusal(function, kIllegalAddress);
  }
  if (fault == WireFault::kException) return Refusal(function, kDeviceFailure);
  ModbusBytes payload = Payload(image, table, static_cast<std::size_t>(first), count);
  if (fault == WireFault::kLongPayload) payload.insert(payload.end(), 2, 0);
  if (fault == WireFault::kShortPayload) payload.clear();
  ModbusBytes answer = {function, static_cast<std::uint8_t>(payload.size())};
  answer.insert(answer.end(), payload.begin(), payload.end());
  if (fault == WireFault::kHugePayload) {
    answer[1] = 255;
    answer.resize(257);
  }
  if (fault == WireFault::kWrongFunction) answer[0] ^= 0x01U;  // the neighbouring table
  return answer;
}

ModbusBytes TcpFrame(const ModbusBytes& request, std::uint8_t unit, const ModbusBytes& answer,
                     WireFault fault) {
  ModbusBytes frame = {request[0], request[1], 0, 0};
  if (fault == WireFault::kWrongTransaction) frame[1] ^= 0x01U;
  if (fault == WireFault::kWrongProtocol) frame[3] = 1;
  Append(&frame,
         static_cast<unsigned>(answer.size()) + (fault == WireFault::kWrongFrameLength ? 3 : 1));
  frame.push_back(unit);
  frame.insert(frame.end(), answer.begin(), answer.end());
  return frame;
}

// Truncates the frame, or replaces it by garbage.
ModbusBytes Corrupted(ModbusBytes frame, WireFault fault) {
  if (fault == WireFault::kGarbage) frame.assign(64, 0xFF);
  if (fault == WireFault::kThreeBytes) frame.resize(3);
  if (fault == WireFault::kHalfFrame || fault == WireFault::kHalfFrameThenClose) {
    frame.resize(frame.size() / 2);
  }
  return frame;
}

}  // namespace

int RequestLength(ModbusTransport transport, const ModbusBytes& received) {
  if (transport == ModbusTransport::kTcp) {
    if (received.size() < kTcpHeader) return 0;
    const unsigned length = WordAt(received, 4);  // of the bytes after it
    if (WordAt(received, 2) != 0 || length < 2 || length > 254) return -1;
    return received.size() < 6 + length ? 0 : static_cast<int>(6 + length);
  }
  if (received.size() < kRtuRequest) return 0;
  const bool writes_many = received[1] == 15 || received[1] == 16;
  const std::size_t length = writes_many ? 9U + received[6] : kRtuRequest;
  if (received.size() < length) return 0;
  const unsigned crc = Checksum(received, length - 2);
  const bool right = received[length - 2] == (crc & 0xFFU) && received[length - 1] == crc >> 8U;
  return right ? static_cast<int>(length) : -1;
}

ModbusBytes ReplyFrame(const ModbusDeviceConfig& config, const RegisterImage& image,
                       const ModbusBytes& request, WireFault fault) {
  const bool rtu = config.transport == ModbusTransport::kRtu;
  const std::size_t header = rtu ? 1 : kTcpHeader;
  const std::uint8_t unit = request[header - 1];
  const bool mine = unit == config.unit;
  if (rtu && !mine) return {};
  const ModbusBytes body(request.begin() + static_cast<std::ptrdiff_t>(header),
                         request.end() - (rtu ? 2 : 0));
  const ModbusBytes answer = mine ? Answer(image, body, fault) : Refusal(body[0], kTargetFailed);
  const auto shown = static_cast<std::uint8_t>(unit + (fault == WireFault::kWrongUnit ? 1 : 0));
  if (!rtu) return Corrupted(TcpFrame(request, shown, answer, fault), fault);
  ModbusBytes frame = {shown};
  frame.insert(frame.end(), answer.begin(), answer.end());
  AppendChecksum(&frame, fault);
  return Corrupted(std::move(frame), fault);
}

}  // namespace flexarm
