#include "tools/bench_host/wake_up_row.h"

#include <fmt/format.h>

#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "controller/files/write_file.h"
#include "controller/runlog/run_reader.h"
#include "controller/tasks/control_task.h"
#include "tools/bench_host/child_program.h"

namespace flexarm {
namespace {

// End of cyclictest's histogram: five periods of the shipped config.
constexpr int kHistogram_us = 100'000;

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

// s.
std::vector<double> CyclictestLateness_s(const RigConfig& config, std::size_t wake_ups,
                                         const std::filesystem::path& scratch) {
  const ProgramResult result = RunChild(
      {"cyclictest", "--quiet", "--mlockall", "--threads=1",
       "--priority=" + std::to_string(ControlTask::kPriority),
       "--interval=" + std::to_string(config.loop.period_ns() / 1000),
       "--loops=" + std::to_string(wake_ups), "--histogram=" + std::to_string(kHistogram_us)},
      scratch);
  if (result.exit_code != 0) throw std::runtime_error("cyclictest: " + ReasonOf(result));
  std::vector<double> late = ParseCyclictest(result.output);
  if (late.size() != wake_ups) {
    throw std::runtime_error(
        fmt::format("cyclictest counted {} of {} wake-ups", late.size(), wake_ups));
  }
  for (double& one : late) one *= 1e-6;
  return late;
}

// How late a thread woke, us.
struct LatenessFigures {
  double mean_us, p999_us, worst_us;
};

LatenessFigures FiguresOf(const std::vector<double>& late_s) {
  const double sum_s = std::accumulate(late_s.begin(), late_s.end(), 0.0);
  return {.mean_us = 1e6 * sum_s / static_cast<double>(late_s.size()),
          .p999_us = 1e6 * Quantile(late_s, 0.999),
          .worst_us = 1e6 * Quantile(late_s, 1.0)};
}

std::string TextOf(const LatenessFigures& figures) {
  return fmt::format("mean {:.0f} us, 99.9th percentile {:.0f} us, worst {:.0f} us",
                     figures.mean_us, figures.p999_us, figures.worst_us);
}

// @param scratch  empty
void AddFigures(const BenchSetting& setting, const std::filesystem::path& scratch, BenchRow* row) {
  const std::vector<double> late_s = DaemonLateness_s(setting, setting.quick ? 1 : 40, scratch);
  const LatenessFigures daemon = FiguresOf(late_s);
  const LatenessFigures other =
      FiguresOf(CyclictestLateness_s(setting.config, late_s.size(), scratch));
  row->time = TimingOf(late_s);
  row->ratio = {.name = "mean_over_cyclictest",
                .unit = "times cyclictest's mean",
                .value = daemon.mean_us / other.mean_us,
                .bar = {}};
  row->result = TextOf(daemon) + "; cyclictest " + TextOf(other);
}

// The stressors of tests/guest/daemon_in_guest/load.sh, with one of the processor for each of them.
const std::vector<std::string> kStress = {"stress-ng", "--quiet", "--cpu", "0",          "--io",
                                          "1",         "--vm",    "1",     "--vm-bytes", "64M"};

// Why this cannot be measured here; empty: it can.
std::string Obstacle(const BenchSetting& setting, bool loaded) {
  if (setting.config.backend != "sim") {
    return "the config is not of the simulated arm: add --set hal.backend=sim";
  }
  if (!IsInPath("cyclictest")) {
    return "there is no cyclictest in PATH: `apt-get install rt-tests`";
  }
  if (loaded && !IsInPath(kStress.front())) {
    return "there is no stress-ng in PATH: `apt-get install stress-ng`";
  }
  return "";
}

// `row` with its figures, measured in a folder of its own.
BenchRow Measured(BenchRow row, const BenchSetting& setting, const std::filesystem::path& scratch,
                  bool loaded) {
  const std::string obstacle = Obstacle(setting, loaded);
  if (!obstacle.empty()) return NotMeasured(row.name, row.what, obstacle);
  const std::filesystem::path folder = scratch / row.name, stress_folder = folder / "stress";
  std::filesystem::create_directories(stress_folder);
  try {
    std::optional<BackgroundChild> stress;
    if (loaded) stress.emplace(kStress, stress_folder);
    AddFigures(setting, folder, &row);
    if (stress) stress->RequireRunning();
    return row;
  } catch (const std::runtime_error& error) {
    return NotMeasured(
        row.name, row.what,
        std::string(error.what()) + " (real time must be permitted: see `flexarm check-host`)");
  }
}

constexpr const char* kWhat = "Daemon: wake-up of the control thread after its instant";

}  // namespace

BenchRow WakeUpRow(const BenchSetting& setting, const std::filesystem::path& scratch) {
  return Measured({.name = "wake-up", .what = kWhat}, setting, scratch, false);
}

BenchRow LoadedWakeUpRow(const BenchSetting& setting, const std::filesystem::path& scratch) {
  return Measured({.name = "wake-up-under-load", .what = std::string(kWhat) + ", under stress-ng"},
                  setting, scratch, true);
}

// With --histogram: lines "000003 000017" of lateness and count, then, behind #, figures of all.
std::vector<double> ParseCyclictest(const std::string& output) {
  const auto number_after = [&output](const std::string& name) {
    const std::size_t at = output.find(name);
    std::istringstream rest(at == std::string::npos ? "" : output.substr(at + name.size()));
    double value = 0.0;
    if (!(rest >> value)) throw std::runtime_error("cyclictest printed no " + name);
    return value;
  };
  const double worst_us = number_after("# Max Latencies:");
  const auto beyond = static_cast<std::size_t>(number_after("# Histogram Overflows:"));
  std::vector<double> late_us;
  std::istringstream lines(output);
  double end_us = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::size_t count = 0;
    double us = 0.0;
    if (!(words >> us >> count)) continue;
    late_us.insert(late_us.end(), count, us);
    end_us = us + 1.0;
  }
  late_us.insert(late_us.end(), beyond, end_us);
  if (late_us.empty()) throw std::runtime_error("cyclictest counted no wake-up");
  if (beyond > 0) late_us.back() = worst_us;
  return late_us;
}

}  // namespace flexarm
