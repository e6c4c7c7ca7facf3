#include "hal/gpiod/gpio_request.h"
#include "hal/line_names.h"

namespace flexarm {

std::string NoPullDown(const GpiodConfig& config, Line line) {
  return "gpiod " + config.chip + ": " + ToString(line) + " = line " +
         std::to_string(config.input[static_cast<std::size_t>(line)]) +
         " does not report the pull-down that was requested: a cut wire could read as a closed "
         "contact. Use a chip and a kernel that know pull-down (`gpioinfo` shows it), with a "
         "resistor of your own at every input; see docs/hardware.md";
}

}  // namespace flexarm
