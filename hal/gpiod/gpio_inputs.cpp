#include "hal/gpiod/gpio_request.h"
#include "hal/line_names.h"

namespace flexarm {

std::vector<GpioInput> InputsOf(const GpiodConfig& config) {
  std::vector<GpioInput> inputs;
  for (std::size_t i = 0; i < kLines; ++i) {
    inputs.push_back({ToString(static_cast<Line>(i)), static_cast<unsigned>(config.input[i])});
  }
  if (config.relay_contact) {
    inputs.push_back({"relay_contact", static_cast<unsigned>(*config.relay_contact)});
  }
  return inputs;
}

std::string NoPullDown(const GpiodConfig& config, const GpioInput& input) {
  return "gpiod " + config.chip + ": " + input.name + " = line " + std::to_string(input.offset) +
         " does not report the pull-down that was requested: a cut wire could read as a closed "
         "contact. Use a chip and a kernel that know pull-down (`gpioinfo` shows it), with a "
         "resistor of your own at every input; see docs/hardware.md";
}

}  // namespace flexarm
