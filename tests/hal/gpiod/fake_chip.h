#pragma once

#include <array>
#include <string>

namespace flexarm {

/// A GPIO chip behind the functions of libgpiod, which fake_gpiod_v1.cpp and fake_gpiod_v2.cpp
/// replace in the test's program: what a driver, a kernel and wires may do that gpio-sim does not.
struct FakeChip {
  static constexpr int kLines = 9;
  enum class Wire { kClosed, kFloats };  // to + through the contact; to nothing

  std::string name = "gpiochip0";
  std::array<Wire, kLines> wire{};
  bool takes_bias = true;     ///< false: the request with a bias is refused (EINVAL)
  bool reports_bias = true;   ///< false: the request succeeds, the flag reads as not set
  bool has_resistors = true;  ///< false: a floating pin reads 1 whatever the flag says
  bool reads = true, writes = true;

  // What the driver did.
  std::array<bool, kLines> pulled_down{};
  std::array<int, kLines> output{};
  std::array<bool, kLines> held{};

  int LevelOf(std::size_t line) const {
    if (wire[line] == Wire::kClosed) return 1;
    return pulled_down[line] && has_resistors ? 0 : 1;
  }
};

/// The one chip of the machine.
FakeChip& TheChip();

}  // namespace flexarm
