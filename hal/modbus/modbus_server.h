#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/modbus/modbus_config.h"
#include "hal/modbus/register_image.h"

namespace flexarm {

/// The simulated amplifier or remote I/O on the wire: serves a register image over TCP, to several
/// clients, or over a pseudo-terminal as RTU.
///
/// Reads of the four tables are answered, anything else is an illegal function: nobody but the
/// image's writer changes it. Another unit is gateway-target-failed over TCP, and silence over RTU.
/// A client that sends half a request holds the others up for at most 20 ms, and is closed. Thread:
/// Run blocks, on a thread that the owner starts for it; Stop and SetSilent from any other. Not
/// real-time: it allocates when a client comes.
class ModbusServer {
 public:
  /// TCP: listens on config.host and config.port; port 0 takes a free one. RTU: makes a
  /// pseudo-terminal and puts a symbolic link to it at config.device, if that is not empty.
  /// @param image  outlives the server
  /// @throws HalError
  ModbusServer(ModbusDeviceConfig config, const RegisterImage& image);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  /// Serves until Stop.
  void Run();

  /// Run returns within 20 ms; it stays stopped.
  void Stop() noexcept;

  /// A silent server takes requests and does not answer: a hung device.
  void SetSilent(bool silent) noexcept { silent_.store(silent, std::memory_order_relaxed); }

  int port() const noexcept { return port_; }                 ///< TCP
  const std::string& path() const noexcept { return path_; }  ///< RTU: the pseudo-terminal
  std::uint64_t requests() const noexcept { return requests_.load(std::memory_order_relaxed); }

 private:
  struct Context;

  void Listen();
  void OpenPseudoTerminal();
  void Accept();
  /// False if the client is gone or must go.
  bool Serve(int fd);
  int Reply(const std::uint8_t* request, int length);

  const ModbusDeviceConfig config_;
  const RegisterImage& image_;
  std::unique_ptr<Context> context_;
  int stop_ = -1;
  int listener_ = -1;
  int terminal_ = -1;  // the master's side
  int held_ = -1;  // the slave's side: without it, the master sees a hang-up when a client leaves
  int port_ = 0;
  std::string path_;
  std::vector<int> clients_;
  std::vector<std::uint16_t> cells_;
  std::atomic<bool> silent_{false};
  std::atomic<std::uint64_t> requests_{0};
};

}  // namespace flexarm
