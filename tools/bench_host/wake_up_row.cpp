#include "tools/bench_host/wake_up_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "controller/files/write_file.h"
#include "controller/runlog/run_reader.h"
#include "controller/tasks/control_task.h"
#include "tools/bench_host/child_program.h"

namespace flexarm {
namespace {

// A move that any arm may make.
std::string ExperimentText(int duration_s) {
  return "name = \"bench-host\"\nduration_s = " + std::to_string(duration_s) +
         ".0\n\n[[doublet]]\nstart_s = 0.0\nduration_s = 1.0\nshape = \"square\"\n"
         "move_deg = [5.0, 5.0]\n";
}

// How late the control thread woke in each sample of the only run below a folder, s.
std::vector<double> Lateness_s(const std::filesystem::path& folder) {
  std::vector<double> late_s;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".flexarm") continue;
    RunReader(entry.path()).ForEachTiming([&late_s](const TimingRecord& record) {
      late_s.push_back(1e-9 * static_cast<double>(record.woke_ns - record.due_ns));
    });
  }
  return late_s;
}

std::vector<double> DaemonLateness_s(const BenchSetting& setting, int duration_s,
                                     const std::filesystem::path& scratch) {
  const std::filesystem::path config = scratch / "rig.toml", move = scratch / "move.toml";
  WriteFile(config, setting.config.text, ReplaceAny("a config"));
  WriteFile(move, ExperimentText(duration_s), ReplaceAny("an experiment"));
  const std::filesystem::path logs = scratch / "runs";
  const ProgramResult daemon =
      RunChild({(setting.programs / "flexarmd").string(), "--config", config.string(),
                "--experiment", move.string(), "--log-dir", logs.string(), "--state-dir",
                (scratch / "state").string(), "--socket", (scratch / "socket").string()},
               scratch);
  if (daemon.exit_code != 0) throw std::runtime_error("flexarmd: " + ReasonOf(daemon));
  std::vector<double> late_s = Lateness_s(logs);
  if (late_s.empty()) throw std::runtime_error("flexarmd logged no wake-up");
  return late_s;
}

CyclictestResult RunCyclictest(const RigConfig& config, std::size_t wake_ups,
                               const std::filesystem::path& scratch) {
  const ProgramResult result =
      RunChild({"cyclictest", "--quiet", "--mlockall", "--threads=1",
                "--priority=" + std::to_string(ControlTask::kPriority),
                "--interval=" + std::to_string(config.loop.period_ns() / 1000),
                "--loops=" + std::to_string(wake_ups)},
               scratch);
  if (result.exit_code != 0) throw std::runtime_error("cyclictest: " + ReasonOf(result));
  return ParseCyclictest(result.output);
}

}  // namespace

BenchRow WakeUpRow(const BenchSetting& setting, const std::filesystem::path& scratch) {
  BenchRow row{.name = "wake-up",
               .what = "Daemon: wake-up of the control thread after its instant"};
  if (setting.config.backend != "sim") {
    return NotMeasured(row.name, row.what,
                       "the config is not of the simulated arm: add --set hal.backend=sim");
  }
  if (!IsInPath("cyclictest")) {
    return NotMeasured(row.name, row.what,
                       "there is no cyclictest in PATH: `apt-get install rt-tests`");
  }
  try {
    const std::vector<double> late_s = DaemonLateness_s(setting, setting.quick ? 1 : 10, scratch);
    const CyclictestResult other =
        RunCyclictest(setting.config, setting.quick ? 30 : late_s.size(), scratch);
    row.time = TimingOf(late_s);
    const double mean_us = 1e6 * std::accumulate(late_s.begin(), late_s.end(), 0.0) /
                           static_cast<double>(late_s.size());
    row.ratio = {.name = "mean_over_cyclictest",
                 .unit = "times cyclictest's mean",
                 .value = mean_us / other.mean_us,
                 .bar = {}};
    row.result = fmt::format(
        "mean {:.0f} us, worst {:.0f} us; cyclictest mean {:.0f} us, worst {:.0f} us", mean_us,
        1e6 * *std::max_element(late_s.begin(), late_s.end()), other.mean_us, other.worst_us);
    return row;
  } catch (const std::runtime_error& error) {
    return NotMeasured(
        row.name, row.what,
        std::string(error.what()) + " (real time must be permitted: see `flexarm check-host`)");
  }
}

// "T: 0 ( 1234) P:80 I:20000 C:    300 Min:      3 Act:    5 Avg:    6 Max:      40"
CyclictestResult ParseCyclictest(const std::string& output) {
  const auto number_after = [&output](const std::string& name) {
    const std::size_t at = output.find(name);
    std::istringstream rest(at == std::string::npos ? "" : output.substr(at + name.size()));
    double value = 0.0;
    if (!(rest >> value)) throw std::runtime_error("cyclictest printed no " + name);
    return value;
  };
  return {.mean_us = number_after("Avg:"), .worst_us = number_after("Max:")};
}

}  // namespace flexarm
