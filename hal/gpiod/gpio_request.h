#pragma once

#include <array>
#include <memory>

#include "hal/gpiod/gpiod_config.h"

namespace flexarm {

/// The lines of the safety chain, requested from the kernel and held: no other process can
/// reconfigure one. The only interface to libgpiod: gpio_request_v1.cpp is for its first generation
/// (Debian 12), gpio_request_v2.cpp for its second (Debian 13); CMake takes the one that fits.
/// Real-time: Read and Write are one ioctl each.
class GpioRequest {
 public:
  /// Requests the inputs as the hardware biases them, then relay and pump as outputs at 0.
  /// @throws HalError naming chip, line, and the process that holds the line, if any
  explicit GpioRequest(const GpiodConfig& config);
  ~GpioRequest();  ///< relay and pump to 0, then releases the lines
  GpioRequest(const GpioRequest&) = delete;
  GpioRequest& operator=(const GpioRequest&) = delete;

  /// The level of each input, 0 or 1, by Line. False if they cannot be read.
  bool Read(std::array<int, kLines>* levels) noexcept;

  /// Sets both outputs, 0 or 1. False if they cannot be set.
  bool Write(int relay, int pump) noexcept;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

/// Name of an output line in messages, by its index.
inline constexpr std::array<const char*, 2> kGpioOutputs = {"relay", "pump"};

}  // namespace flexarm
