#include "tools/health/log_health.h"

#include <algorithm>

#include "controller/runlog/run_reader.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

// The simulated arm takes up or loses a payload in the middle of the experiment.
bool ChangesPayload(const RunInfo& info) {
  if (info.experiment_text.empty()) return false;
  const Experiment experiment = ParseExperiment(info.experiment_text, info.experiment_name);
  return std::ranges::any_of(experiment.sim_event,
                             [](const SimEvent& event) { return event.payload_kg.has_value(); });
}

}  // namespace

NominalPlant NominalPlantOf(const RigConfig& config, double payload_kg) {
  return {.payload_kg = payload_kg,
          .motor_lag_s = {1e-3 * config.sim.motor_lag_ms[0], 1e-3 * config.sim.motor_lag_ms[1]},
          .drift = {}};
}

LogHealth HealthOfLog(const std::filesystem::path& file) {
  RunReader reader(file);
  LogHealth health{.config = ConfigOf(reader), .record = {}, .figures = {}};
  const RunInfo& info = reader.info();
  const double payload_kg = info.payload_kg.value_or(health.config.arm.payload_mass_kg);
  RunHealth run(health.config, NominalPlantOf(health.config, payload_kg));
  Calibration calibration{};
  reader.ForEachTick([&](const TickRecord& tick) {
    if (run.ended()) return;
    run.Take(tick.input, tick.output);
    calibration = tick.input.calibration;
  });
  health.figures = run.Figures();
  if (ChangesPayload(info)) health.figures.unused = kPayloadChanges;
  health.record = RecordOf(health.config, calibration, health.figures);
  health.record.run = file.string();
  health.record.start_utc = info.start_utc;
  return health;
}

}  // namespace flexarm
