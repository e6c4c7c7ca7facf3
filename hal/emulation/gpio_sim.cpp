#include "hal/emulation/gpio_sim.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <string_view>

#include "hal/bus_device.h"

namespace flexarm {
namespace {

constexpr std::size_t kMaxLines = 1024;

int OpenAttribute(const std::string& folder, int offset, const char* name, int flags) {
  const std::string path = folder + "/sim_gpio" + std::to_string(offset) + "/" + name;
  return open(path.c_str(), flags | O_CLOEXEC);
}

}  // namespace

GpioSim::GpioSim(const std::string& chip) : lines_(kMaxLines) {
  folder_ = "/sys/bus/gpio/devices/" + std::filesystem::path(chip).filename().string();
  if (!std::filesystem::exists(folder_ + "/sim_gpio0")) {
    throw HalError("gpio " + chip + ": is not a gpio-sim chip (no " + folder_ + "/sim_gpio0)");
  }
}

GpioSim::~GpioSim() {
  for (const Line& line : lines_) {
    if (line.pull_fd >= 0) close(line.pull_fd);
    if (line.value_fd >= 0) close(line.value_fd);
  }
}

GpioSim::Line& GpioSim::At(int offset) noexcept { return lines_[static_cast<std::size_t>(offset)]; }

void GpioSim::Pull(int offset, bool high) noexcept {
  Line& line = At(offset);
  if (line.pulled == static_cast<int>(high)) return;
  if (line.pull_fd < 0) line.pull_fd = OpenAttribute(folder_, offset, "pull", O_WRONLY);
  const std::string_view word = high ? "pull-up" : "pull-down";
  if (pwrite(line.pull_fd, word.data(), word.size(), 0) == static_cast<ssize_t>(word.size())) {
    line.pulled = static_cast<int>(high);
  }
}

bool GpioSim::Value(int offset) noexcept {
  Line& line = At(offset);
  if (line.value_fd < 0) line.value_fd = OpenAttribute(folder_, offset, "value", O_RDONLY);
  char level = '0';
  return pread(line.value_fd, &level, 1, 0) == 1 && level == '1';
}

}  // namespace flexarm
