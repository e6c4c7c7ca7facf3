#include "tools/bench_host/log_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "controller/design/run_design.h"
#include "controller/law/design.h"
#include "controller/runlog/csv.h"
#include "controller/runlog/replay.h"
#include "controller/runlog/run_reader.h"
#include "controller/step/control_step.h"

namespace flexarm {
namespace {

// Samples a second, in words.
std::string RateText(std::int64_t samples, const Timing& time) {
  return fmt::format("{:.0f} samples a second", static_cast<double>(samples) / time.median_s);
}

}  // namespace

BenchRow ReplayRow(const BenchSetting& setting, const RecordedRun& run) {
  BenchRow row{.name = "replay",
               .what = "Replay of a log of " + std::to_string(run.inputs.size()) + " samples"};
  const Design design = DesignFor(setting.config);
  ReplayResult result;
  const auto work = [&] {
    RunReader reader(run.log);
    ControlStep step(setting.config, design);
    Replay replay([&step](const StepInput& input) { return step.Step(input); }, false);
    reader.ForEachTick([&](const TickRecord& record) { replay.Tick(record); });
    reader.ForEachSafety([&](const SafetyRecord& record) { replay.Safety(record); });
    result = replay.Result();
  };
  row.time = TimeWork(work, {.count = setting.long_count(), .each_s = 0.0});
  row.result = RateText(result.ticks, *row.time);
  const bool exact = result.bit_exact.value_or(false) && result.safety_exact.value_or(false);
  row.check_failed = !exact;
  row.result += exact ? ", bit-exact" : ", NOT exact";
  return row;
}

BenchRow ExportRow(const RecordedRun& run, const BenchSetting& setting) {
  BenchRow row{.name = "export", .what = "Export of the same log as CSV"};
  std::size_t bytes = 0;
  const auto work = [&] {
    RunReader reader(run.log);
    std::ostringstream csv;
    CsvWriter writer(&csv, setting.config.sensors, reader.info().start_ns);
    reader.ForEachTick([&](const TickRecord& record) { writer.Row(record.input); });
    bytes = csv.view().size();
  };
  row.time = TimeWork(work, {.count = setting.long_count(), .each_s = 0.0});
  row.result = RateText(static_cast<std::int64_t>(run.inputs.size()), *row.time) + ", " +
               std::to_string(bytes) + " bytes";
  return row;
}

}  // namespace flexarm
