#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/host/simulation.h"
#include "controller/runlog/run_reader.h"

namespace flexarm {

/// Every StepInput of a simulated run of the shipped rig, from arm to disarm, in order of tick:
/// identical to the input of the control thread in that run: sensor noise, reference, states.
inline std::vector<StepInput> RecordedInputs(const RigConfig& config) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("recorded-inputs-" + std::to_string(getpid()) + ".flexarm");
  const Experiment experiment =
      LoadExperiment(FLEXARM_SOURCE_DIR "/config/experiments/square-30deg.toml");
  Simulate({.config = config, .experiment = experiment, .payload_kg = {}, .log = file});
  std::vector<StepInput> inputs;
  {
    RunReader reader(file);
    reader.ForEachTick([&inputs](const TickRecord& tick) { inputs.push_back(tick.input); });
  }
  std::filesystem::remove(file);
  return inputs;
}

}  // namespace flexarm
