#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "controller/realtime/clock.h"
#include "controller/types/rejected_error.h"
#include "hal/emulation/emulated_rig.h"
#include "hal/emulation/rig_commands.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSliceNs = 1'000'000;

struct RigOptions {
  ConfigOptions config;
  std::optional<double> payload_kg;
  std::optional<double> run_for_s;
  bool relay_feeds_drives = false;
  bool json = false;
};

volatile std::sig_atomic_t end_asked = 0;

void AskEnd(int /*signal*/) { end_asked = 1; }

/// Reads whole lines from stdin without waiting.
class Commands {
 public:
  bool Next(std::string* line) {
    pollfd ready{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    while (open_ && poll(&ready, 1, 0) > 0) {
      std::array<char, 256> chunk;
      const ssize_t count = read(STDIN_FILENO, chunk.data(), chunk.size());
      if (count <= 0) open_ = false;
      if (count > 0) pending_.append(chunk.data(), static_cast<std::size_t>(count));
    }
    const std::size_t end = pending_.find('\n');
    if (end == std::string::npos) return false;
    *line = pending_.substr(0, end);
    pending_.erase(0, end + 1);
    return true;
  }

 private:
  std::string pending_;
  bool open_ = true;
};

void Report(const EmulatedRig& rig, bool json) {
  const EmulatedRig::Observed& seen = rig.observed();
  if (json) {
    nlohmann::ordered_json out;
    out["torque_nm"] = {seen.torque_nm[0], seen.torque_nm[1]};
    out["relay_closed"] = seen.relay_closed;
    out["pump_alive"] = seen.pump_alive;
    out["powered_ms"] = seen.powered_slices;
    out["drives_active_ms"] = seen.active_slices;
    std::cout << out.dump() << '\n' << std::flush;
    return;
  }
  std::printf("torque %.3f, %.3f N m; relay %s; charge pump %s; %lld ms under power\n",
              seen.torque_nm[0], seen.torque_nm[1], seen.relay_closed ? "closed" : "open",
              seen.pump_alive ? "alive" : "dead", static_cast<long long>(seen.powered_slices));
  std::fflush(stdout);
}

int Run(const RigOptions& options) {
  const RigConfig config = options.config.Load();
  if (config.hal.empty()) {
    throw RejectedError(options.config.file.string() +
                        ": has no devices to emulate; expected [[hal.canopen]], [[hal.modbus]] and "
                        "[hal.gpiod], as config/hil-wire.toml");
  }
  ArmParameters arm = config.arm;
  if (options.payload_kg) arm.payload_mass_kg = *options.payload_kg;
  EmulatedRig rig(arm, config.sensors, config.sim, config.hal,
                  {.monotonic_ns = MonotonicNow, .realtime_ns = RealtimeNow},
                  options.relay_feeds_drives ? std::optional(DriveSupplyModel{}) : std::nullopt);
  std::signal(SIGTERM, AskEnd);
  std::signal(SIGINT, AskEnd);
  std::cerr << "flexarm rig: emulating " << config.rig_name << "; commands on stdin\n";

  Commands commands;
  std::string line;
  const std::int64_t start_ns = MonotonicNow();
  const std::int64_t end_ns =
      options.run_for_s ? start_ns + std::llround(*options.run_for_s * 1e9) : INT64_MAX;
  // A late time slice is caught up: simulated time follows wall-clock time.
  for (std::int64_t due_ns = start_ns; end_asked == 0 && due_ns < end_ns; due_ns += kSliceNs) {
    SleepUntil(due_ns);
    rig.Step(due_ns);
    while (commands.Next(&line)) {
      if (line == "report") {
        Report(rig, options.json);
      } else {
        const std::string complaint = ExecuteRigCommand(line, &rig);
        if (!complaint.empty()) std::cerr << "flexarm rig: " << line << ": " << complaint << '\n';
      }
    }
  }
  Report(rig, options.json);
  return Exit::kDone;
}

}  // namespace

void RegisterRig(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<RigOptions>();
  CLI::App* verb = app.add_subcommand(
      "rig",
      "Emulate the devices of a hardware rig on their buses, with the simulated arm as plant");
  options->config.AddTo(verb, true);
  verb->add_option("--payload-kg", options->payload_kg,
                   "Payload of the plant, instead of the config's")
      ->check(CLI::Range(0.0, 100.0));
  verb->add_option("--run-for", options->run_for_s, "End after this time")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--relay-feeds-drives", options->relay_feeds_drives,
                 "The relay feeds the CANopen drives: without it they report undervoltage");
  AddJson(verb, &options->json);
  verb->footer(
      std::string(
          "Serves the Modbus devices, CANopen nodes and gpio-sim lines of the config; then start\n"
          "flexarmd with the same config. An amplifier with transport = \"rtu\" is served on a\n"
          "pseudo-terminal. The configured `device` becomes a link to it: choose a path that does\n"
          "not exist yet, such as /tmp/strain-amplifier-1; the daemon opens that path.\n"
          "At the end the verb prints the last torques, the relay, the charge pump and the time\n"
          "with power, as the devices received them.\n"
          "\n") +
      kRigCommands +
      "\nExamples: flexarm rig -c config/hil-wire.toml\n"
      "          mkfifo rig.in; flexarm rig -c config/hil-wire.toml <rig.in & exec 3>rig.in\n"
      "          echo amplifier strain-amplifier-1 late 30 >&3");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
