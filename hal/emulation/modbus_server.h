#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "hal/emulation/modbus_reply.h"
#include "hal/emulation/register_image.h"
#include "hal/emulation/wire_fault.h"
#include "hal/modbus/modbus_config.h"

namespace flexarm {

/// Modbus server of the emulated amplifier or remote I/O: serves a register image over TCP, to
/// several clients, or over a pseudo-terminal as RTU; with fault injection.
///
/// Reads of the four tables are answered, other functions are an illegal function: only the image's
/// writer changes it. Another unit is gateway-target-failed over TCP, and silence over RTU.
/// Thread: Run blocks, on a thread that the owner starts for it; Stop, Behave and the calls after
/// them from any other. Not real-time.
class ModbusServer {
 public:
  /// TCP: listens on config.host and config.port; port 0: a free one. RTU: creates a
  /// pseudo-terminal and a symbolic link to it at config.device, if that is not empty.
  /// @param image  outlives the server
  /// @throws HalError
  ModbusServer(ModbusDeviceConfig config, const RegisterImage& image);
  ~ModbusServer();
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  /// Serves until Stop.
  void Run();

  /// Ends Run; the server cannot be restarted.
  void Stop() noexcept;

  /// Sets the fault; replies that were held back are dropped. `late`: the delay of kLate.
  void Behave(WireFault fault, std::chrono::milliseconds late = {});

  /// Sends the replies that kLate holds back at once; over RTU, settled() means that they arrived.
  void ReleaseLate();

  /// True if the last request of Behave or ReleaseLate is in effect.
  bool settled() const noexcept { return taken_.load() == asked_.load(); }

  int port() const noexcept { return port_; }  ///< TCP
  /// RTU: the pseudo-terminal. kAway replaces it: the link leads to the new one.
  const std::string& path() const noexcept { return path_; }
  std::uint64_t requests() const noexcept { return requests_.load(); }
  std::int64_t bytes_flooded() const noexcept { return flooded_.load(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    int fd;
    ModbusBytes received;
  };
  struct Held {  // sent at its due time
    Clock::time_point at;
    int fd;
    ModbusBytes bytes;
  };
  struct Order {
    WireFault fault = WireFault::kNone;
    std::chrono::milliseconds late{};
    bool release = false;
  };

  bool rtu() const noexcept { return config_.transport == ModbusTransport::kRtu; }
  void Open();
  void Listen();
  void OpenPseudoTerminal();
  void CloseAll() noexcept;
  void CloseClient(int fd) noexcept;
  void Give(const Order& order);
  void TakeOrder();
  void Release();
  void SendDue();
  void Flood();
  void Wait();
  int Timeout() const;
  void Accept();
  void Read(int fd);
  void Serve(int fd, const ModbusBytes& request);
  void Send(int fd, const ModbusBytes& bytes);
  void Hold(int fd, Clock::time_point at, ModbusBytes bytes);

  const ModbusDeviceConfig config_;
  const RegisterImage& image_;
  int wake_ = -1;
  int listener_ = -1;
  int slave_ = -1;  // kept open: otherwise the master gets a hang-up when a client closes
  int port_ = 0;
  std::string path_;
  std::vector<Client> clients_;  // RTU: the master's side of the terminal
  std::deque<Held> held_;
  ModbusBytes previous_;
  Order now_;

  std::mutex mutex_;
  Order order_;  // requested, not yet in effect
  std::atomic<std::uint64_t> asked_{0}, taken_{0}, requests_{0};
  std::atomic<std::int64_t> flooded_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace flexarm
