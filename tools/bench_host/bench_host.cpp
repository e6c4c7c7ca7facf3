#include "tools/bench_host/bench_host.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "tools/bench_host/control_rows.h"
#include "tools/bench_host/log_rows.h"
#include "tools/bench_host/plant_rows.h"
#include "tools/bench_host/solver_rows.h"
#include "tools/bench_host/two_cores_row.h"
#include "tools/bench_host/wake_up_row.h"
#include "tools/support/scratch_folder.h"

namespace flexarm {
namespace {

// The table as it grows.
class Bench {
 public:
  Bench(BenchReport* report, std::size_t rows, const std::function<void(std::size_t)>& progress)
      : report_(report), expected_(rows), progress_(progress) {}

  // A row that fails says why, and the others are measured all the same.
  void Add(const std::string& name, const std::function<BenchRow()>& measure) {
    try {
      report_->rows.push_back(measure());
    } catch (const std::exception& error) {
      report_->rows.push_back(NotMeasured(name, "`" + name + "`", error.what()));
    }
    if (progress_) progress_(std::min(report_->rows.size(), expected_));
  }
  const BenchRow& Row(const std::string& name) const {
    return *std::find_if(report_->rows.begin(), report_->rows.end(),
                         [&name](const BenchRow& row) { return row.name == name; });
  }

 private:
  BenchReport* report_;
  std::size_t expected_;
  const std::function<void(std::size_t)>& progress_;
};

// The config's own law, and two others: the one that adapts, and the one that plans.
std::vector<std::string> LawsOf(const RigConfig& config) {
  std::vector<std::string> laws = {LawOf(config.controller.kind).name};
  for (const char* law : {"sobel", "receding-horizon"}) {
    if (std::find(laws.begin(), laws.end(), law) == laws.end()) laws.emplace_back(law);
  }
  return laws;
}

}  // namespace

std::size_t BenchRowsOf(const BenchSetting& setting) { return 11 + LawsOf(setting.config).size(); }

BenchReport RunBenchHost(const BenchSetting& setting,
                         const std::function<void(std::size_t)>& progress) {
  const Repetitions bound{.count = setting.quick ? 5U : 51U, .each_s = setting.quick ? 1e-3 : 5e-3};
  BenchReport report{.quick = setting.quick,
                     .config = setting.config_file.string(),
                     .machine = ReadMachine(HostFiles()),
                     .bounds = MeasureFloatBounds(bound),
                     .rows = {}};
  const ScratchFolder scratch;
  const RecordedRun run = RecordRun(setting, scratch.path());
  Bench bench(&report, BenchRowsOf(setting), progress);
  const std::vector<std::string> laws = LawsOf(setting.config);
  for (const std::string& law : laws) {
    bench.Add("step-" + law, [&] { return StepRow(setting, run, law); });
  }
  bench.Add("plan", [&] { return PlanRow(setting); });
  bench.Add("right-hand-side", [&] { return RateRow(setting); });
  bench.Add("integrator-step", [&] { return IntegratorRow(setting); });
  bench.Add("experiment", [&] {
    return ExperimentRow(setting, bench.Row("integrator-step"), bench.Row("step-" + laws.front()));
  });
  bench.Add("plant-cvode", [&] { return CvodeRow(setting, scratch.path()); });
  bench.Add("plant-ode45", [&] { return OctaveRow(setting, scratch.path()); });
  bench.Add("replay", [&] { return ReplayRow(setting, run); });
  bench.Add("export", [&] { return ExportRow(run, setting); });
  bench.Add("sweep-two-cores", [&] { return TwoCoresRow(setting, scratch.path()); });
  bench.Add("wake-up", [&] { return WakeUpRow(setting, scratch.path()); });
  bench.Add("wake-up-under-load", [&] { return LoadedWakeUpRow(setting, scratch.path()); });
  return report;
}

bool AnyCheckFailed(const BenchReport& report) {
  return std::any_of(report.rows.begin(), report.rows.end(),
                     [](const BenchRow& row) { return row.check_failed; });
}

}  // namespace flexarm
