#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "hal/gpiod/gpio_request.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

int LinesOff(const RigConfig& config) {
  if (!config.hal.gpiod) {
    std::cout << "backend '" << config.backend << "' has no safety lines\n";
    return Exit::kDone;
  }
  const GpioRequest lines(*config.hal.gpiod);  // both outputs are 0 from here on
  std::cout << "relay and charge pump are low: lines " << config.hal.gpiod->relay << " and "
            << config.hal.gpiod->pump << " of " << config.hal.gpiod->chip << '\n';
  return Exit::kDone;
}

}  // namespace

void RegisterLinesOff(CLI::App& app, Exit& exit) {
  const auto config = std::make_shared<ConfigOptions>();
  CLI::App* verb = app.add_subcommand(
      "lines-off", "Drive relay and charge pump of a rig low, after a daemon that was killed");
  config->AddTo(verb, true);
  verb->footer(
      "flexarmd drives both low when it ends. A kernel may leave the lines of a killed process as\n"
      "they were; the service runs this verb whenever the daemon has ended. While a daemon runs "
      "it\n"
      "holds the lines: this verb then fails and names it. Use flexarm stop and flexarm disarm.\n"
      "Exit code 0 both are low, or the rig is simulated; 1 the lines cannot be had.\n"
      "Example: flexarm lines-off -c config/hil-wire.toml");
  verb->callback([config, &exit] { exit.code = LinesOff(config->Load()); });
}

}  // namespace flexarm
