#include "tools/bench_host/solver_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "tools/bench_host/child_program.h"
#include "tools/bench_host/octave_files.h"
#include "tools/bench_host/solver_problem.h"

namespace flexarm {
namespace {

constexpr double kCvodeBar = 3.0;

// Both compute in doubles; the mass matrix of the script has a condition of some 1e5.
constexpr double kSameRates = 1e-8;

Timing TimingFrom(const nlohmann::ordered_json& json, std::size_t repetitions) {
  return {.least_s = 0.0,
          .median_s = JsonNumber(json, "median_s", "flexarm-cvode-race"),
          .lower_quartile_s = JsonNumber(json, "lower_quartile_s", "flexarm-cvode-race"),
          .upper_quartile_s = JsonNumber(json, "upper_quartile_s", "flexarm-cvode-race"),
          .repetitions = repetitions};
}

// Largest difference of a rate, as a share of the largest rate of that state.
double RateDifference(const SolverProblem& problem, const std::vector<SolverProblem::State>& states,
                      const std::vector<std::vector<double>>& found) {
  PlantRate rate(problem.model());
  rate.Push(problem.PushBefore(0));
  double most = found.size() == states.size() ? 0.0 : HUGE_VAL;
  for (std::size_t i = 0; i < std::min(states.size(), found.size()); ++i) {
    SolverProblem::State own{};
    rate(states[i].data(), own.data());
    double largest = 0.0, apart = 0.0;
    for (std::size_t k = 0; k < own.size(); ++k) {
      largest = std::max(largest, std::fabs(own[k]));
      apart = std::max(apart, std::fabs(own[k] - found[i][k]));
    }
    most = std::max(most, apart / largest);
  }
  return most;
}

OctaveRace RunOctave(const SolverProblem& problem, const std::vector<SolverProblem::State>& states,
                     const std::filesystem::path& scratch) {
  const std::vector<double> tolerances = {1e-1, 1e-2, 1e-3, 1e-4};
  const OutputRules rules = ReplaceAny("a script");
  WriteFile(scratch / "arm_rate.m", ArmRateFile(), rules);
  WriteFile(scratch / "ode45_race.m", Ode45RaceFile(), rules);
  WriteFile(scratch / "arm_data.m", ArmDataText(problem, states, tolerances), rules);
  const ProgramResult result = RunChild(
      {"octave-cli", "--no-init-file", "--no-history", "--quiet", "ode45_race.m"}, scratch);
  if (result.exit_code != 0) throw std::runtime_error("octave-cli failed: " + ReasonOf(result));
  return ParseOctaveRace(result.output);
}

}  // namespace

BenchRow CvodeRow(const BenchSetting& setting, const std::filesystem::path& scratch) {
  BenchRow row{.name = "plant-cvode", .what = "1 s of the plant, beside CVODE at equal accuracy"};
  const std::filesystem::path program = setting.programs / "flexarm-cvode-race";
  if (!std::filesystem::exists(program)) {
    return NotMeasured(row.name, row.what,
                       "there is no " + program.filename().string() +
                           " beside flexarm: install libsundials-dev and build it, `cmake --build "
                           "--preset release --target flexarm-cvode-race`");
  }
  const std::filesystem::path config = scratch / "config.toml";
  WriteFile(config, setting.config.text, ReplaceAny("a config"));
  const std::size_t repetitions = setting.quick ? 3 : 51;
  const ProgramResult result =
      RunChild({program.string(), config.string(), std::to_string(repetitions)}, scratch);
  if (result.exit_code != 0) return NotMeasured(row.name, row.what, ReasonOf(result));
  const std::string name = program.filename().string();
  const nlohmann::ordered_json json = ParseJson(result.output, name, "the result of a race");
  const nlohmann::ordered_json &plant = json.at("plant"), &cvode = json.at("cvode");
  row.time = TimingFrom(plant, repetitions);
  row.ratio = {.name = "speed_over_cvode",
               .unit = "times CVODE's speed",
               .value = JsonNumber(json, "ratio", name),
               .bar = kCvodeBar};
  row.result = fmt::format(
      "CVODE {} takes {:.2f} ms with tolerances {:.1e} and {:.1e}; errors of the tip {:.1f} um "
      "(plant), {:.1f} um (CVODE), {:.1e} um (reference)",
      JsonText(cvode, "method", name), 1e3 * JsonNumber(cvode, "median_s", name),
      JsonNumber(cvode, "relative_tolerance", name), JsonNumber(cvode, "absolute_tolerance", name),
      1e6 * JsonNumber(plant, "error_m", name), 1e6 * JsonNumber(cvode, "error_m", name),
      1e6 * JsonNumber(json, "reference_error_m", name));
  return row;
}

BenchRow OctaveRow(const BenchSetting& setting, const std::filesystem::path& scratch) {
  BenchRow row{.name = "plant-ode45",
               .what = "1 s of the plant, beside ode45 of GNU Octave at equal accuracy"};
  if (!IsInPath("octave-cli")) {
    return NotMeasured(row.name, row.what,
                       "there is no octave-cli in PATH: `apt-get install --no-install-recommends "
                       "octave`, and run this again");
  }
  if (setting.quick) return NotMeasured(row.name, row.what, "left out by --quick: takes a minute");
  const SolverProblem problem(setting.config.arm, setting.config.safety.torque_limit_nm);
  const SolverReference reference = MakeReference(problem);
  const double step_s = 1e-3 * setting.config.sim.step_ms;
  const SolverProblem::Motion own = problem.ByPlant(step_s);
  const std::vector<SolverProblem::State> states = {own[2], own[5], own[9], own[14]};
  const OctaveRace race = RunOctave(problem, states, scratch);
  const double apart = RateDifference(problem, states, race.rates);
  row.check_failed = !(apart <= kSameRates);
  if (row.check_failed) {
    row.not_measured = fmt::format("arm_rate.m differs from the C++ by {:.1e} of a rate", apart);
    return row;
  }
  const double error_m = problem.TipError_m(own, reference.motion);
  for (const OctaveRace::Entry& entry : race.entries) {
    const double found_m = problem.TipError_m(entry.motion, reference.motion);
    if (!(found_m <= error_m)) continue;
    row.time = TimeWork([&] { problem.ByPlant(step_s); }, setting.short_work());
    row.ratio = {.name = "speed_over_ode45",
                 .unit = "times ode45's speed",
                 .value = entry.time_s / row.time->median_s,
                 .bar = {}};
    row.result = fmt::format(
        "ode45 takes {:.1f} s and {} evaluations with tolerance {:.0e}; errors of the tip {:.1f} "
        "um "
        "(plant), {:.1f} um (ode45); arm_rate.m differs by {:.0e} of a rate",
        entry.time_s, entry.calls, entry.tolerance, 1e6 * error_m, 1e6 * found_m, apart);
    return row;
  }
  return NotMeasured(row.name, row.what, "ode45 does not reach the accuracy of the plant");
}

}  // namespace flexarm
