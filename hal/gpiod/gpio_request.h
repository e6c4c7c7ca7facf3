#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "hal/gpiod/gpiod_config.h"

namespace flexarm {

/// Every Line, and the relay's mirror contact.
inline constexpr std::size_t kMostGpioInputs = kLines + 1;

/// An input of the safety chain.
struct GpioInput {
  std::string name;  ///< of the line in messages
  unsigned offset;
};

/// Every Line, then the relay's mirror contact if there is one.
std::vector<GpioInput> InputsOf(const GpiodConfig& config);

/// The lines of the safety chain, requested from the kernel and held: no other process can
/// reconfigure one. The only interface to libgpiod: gpio_request_v1.cpp is for its first generation
/// (Debian 12), gpio_request_v2.cpp for its second (Debian 13); CMake takes the one that fits.
/// Real-time: Read and Write are one ioctl each.
class GpioRequest {
 public:
  /// Requests the inputs with pull-down, so that a cut wire reads 0, and reads that back; then
  /// relay and pump as outputs at 0. The read-back shows that the kernel took the flag, not that
  /// the chip has such resistors: a driver without them is no error to the kernel, and the flag
  /// reads as set. So the circuit has resistors of its own (docs/hardware.md).
  /// @throws HalError naming chip, line, and the process that holds the line, if any
  explicit GpioRequest(const GpiodConfig& config);
  ~GpioRequest();  ///< relay and pump to 0, then releases the lines
  GpioRequest(const GpioRequest&) = delete;
  GpioRequest& operator=(const GpioRequest&) = delete;

  /// Name of the chip in the kernel: "gpiochip0".
  const std::string& chip_name() const noexcept { return chip_name_; }

  /// The level of each input, 0 or 1, in the order of InputsOf. False if they cannot be read.
  bool Read(std::array<int, kMostGpioInputs>* levels) noexcept;

  /// Sets both outputs, 0 or 1; 0 after HoldOff. False if they cannot be set.
  bool Write(int relay, int pump) noexcept;

  /// SafetyLines::HoldOff. Writing is one ioctl in both generations of the library, without lock or
  /// heap, so a signal handler may do it beside the safety thread.
  void HoldOff() noexcept {
    held_off_.store(true);
    static_cast<void>(Write(0, 0));
  }

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
  std::string chip_name_;
  std::atomic<bool> held_off_{false};
};

/// Name of an output line in messages, by its index.
inline constexpr std::array<const char*, 2> kGpioOutputs = {"relay", "pump"};

/// The refusal of a chip that does not report the pull-down of an input.
std::string NoPullDown(const GpiodConfig& config, const GpioInput& input);

}  // namespace flexarm
