#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "hal/modbus/modbus_config.h"

namespace flexarm {

/// What a device can do wrong.
enum class Misbehaviour : std::uint8_t {
  kNone,
  kSilent,            ///< takes requests, never answers
  kHeld,              ///< keeps its reply until ReleaseHeld
  kOneBehind,         ///< answers each request with the reply to the one before, for ever
  kByteByByte,        ///< a byte every 20 ms
  kWrongTransaction,  ///< TCP
  kWrongProtocol,     ///< TCP
  kWrongFrameLength,  ///< TCP: the header's length field is not the frame's
  kWrongUnit,
  kWrongFunction,
  kLongPayload,   ///< a register more than asked for, all lengths consistent
  kShortPayload,  ///< nothing where something was asked for
  kHugePayload,   ///< says 255 bytes
  kBadChecksum,   ///< RTU
  kGarbage,       ///< 64 bytes 0xFF in place of a reply
  kThreeBytes,    ///< and nothing after them
  kHalfFrame,     ///< and nothing after it
  kHalfFrameThenClose,
  kTwice,  ///< each reply twice
  kException,
  kFlood,       ///< sends without being asked, as fast as it can
  kReset,       ///< TCP: RST in place of a reply
  kClose,       ///< in place of a reply
  kNeverReads,  ///< TCP: leaves requests in its buffer, which is small
};

/// A Modbus device made of sockets and bytes, without libmodbus and without a line of the driver:
/// it has the identification of Amplifier(), shows `reading` in every input register and 1 in every
/// discrete input, and misbehaves on request.
class HostilePeer {
 public:
  /// TCP: any free port of the loopback. RTU: a pseudo-terminal behind a link.
  explicit HostilePeer(ModbusTransport transport);
  ~HostilePeer();
  HostilePeer(const HostilePeer&) = delete;
  HostilePeer& operator=(const HostilePeer&) = delete;

  int port() const { return port_; }
  const std::string& path() const { return path_; }

  void Behave(Misbehaviour how) { how_ = how; }
  void Show(std::uint16_t reading) { reading_ = reading; }
  /// Sends what kHeld kept; it has left when this returns.
  void ReleaseHeld();
  /// The cable is out, the device is gone: connection, listener or terminal closed.
  void Leave();
  /// It is back, at the same place.
  void Return();

  int requests() const { return requests_; }
  std::int64_t bytes_flooded() const { return flooded_; }

 private:
  using Bytes = std::vector<std::uint8_t>;

  bool rtu() const { return transport_ == ModbusTransport::kRtu; }
  void Open();
  void CloseAll();
  void CloseClient();
  void Serve();
  void Handle(const Bytes& request);
  void Answer(Misbehaviour how, const Bytes& request);
  void Misanswer(Misbehaviour how, const Bytes& request);
  Bytes Payload(const Bytes& body) const;
  Bytes Frame(const Bytes& request, Misbehaviour how) const;
  void SendAll(const Bytes& bytes);
  void Dribble(const Bytes& bytes);

  const ModbusTransport transport_;
  int port_ = 0;
  std::string path_;
  int listener_ = -1;
  int client_ = -1;  // or the pseudo-terminal
  int held_open_ = -1;
  Bytes received_, held_, previous_;
  std::atomic<Misbehaviour> how_{Misbehaviour::kNone};
  std::atomic<std::uint16_t> reading_{0};
  std::atomic<int> requests_{0};
  std::atomic<std::int64_t> flooded_{0};
  std::atomic<bool> release_{false}, leave_{false}, away_{false}, return_{false}, stop_{false};
  std::jthread thread_;
};

}  // namespace flexarm
