#pragma once

#include <filesystem>
#include <string>

namespace flexarm {

/// Refuses a GPIO chip behind I2C, SPI or USB. A call to such a chip sleeps until its bus has
/// answered: for milliseconds, or until a time-out of the kernel when the bus hangs; meanwhile the
/// safety task stands still.
/// Looks at every device between the chip and the root of sysfs: the chip may be a part of a larger
/// device on such a bus. A chip that sysfs does not show is refused too.
/// @param chip_name  in the kernel: "gpiochip0"
/// @throws HalError naming chip, bus and device, and what to use instead
void RequireDirectChip(const std::string& chip_name, const std::filesystem::path& sysfs = "/sys");

}  // namespace flexarm
