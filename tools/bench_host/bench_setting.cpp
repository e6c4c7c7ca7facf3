#include "tools/bench_host/bench_setting.h"

#include "controller/host/simulation.h"
#include "controller/runlog/run_reader.h"

namespace flexarm {

RecordedRun RecordRun(const BenchSetting& setting, const std::filesystem::path& folder) {
  RecordedRun run{.log = folder / "recorded.flexarm", .inputs = {}};
  Simulate({.config = setting.config,
            .experiment = setting.experiment,
            .payload_kg = {},
            .log = run.log});
  RunReader reader(run.log);
  reader.ForEachTick([&run](const TickRecord& tick) { run.inputs.push_back(tick.input); });
  return run;
}

}  // namespace flexarm
