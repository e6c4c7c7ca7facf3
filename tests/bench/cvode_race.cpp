// The simulated arm against CVODE (SUNDIALS) at equal accuracy, on the same right-hand side. Run by
// `flexarm bench-host`, which finds this program beside its own; prints one JSON object.
// Usage: flexarm-cvode-race CONFIG REPETITIONS

#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "config/config.h"
#include "tests/bench/cvode_solver.h"
#include "tools/bench_host/timing.h"

namespace flexarm {
namespace {

// From loose to tight, a factor of 10^(1/4) each.
constexpr double kLoosest = 1e-2, kTightest = 1e-10, kTighter = 0.5623413251903491;

struct Entry {
  CvodeSettings settings;
  double error_m, time_s;
};

// With the absolute tolerance as a share of the relative one, the loosest whose error is not above
// `error_m`.
std::optional<Entry> LoosestWithin(const SolverProblem& problem, const SolverReference& reference,
                                   double error_m, bool stiff, double absolute_share) {
  for (double relative = kLoosest; relative > kTightest; relative *= kTighter) {
    const CvodeSettings settings{.stiff = stiff,
                                 .relative = relative,
                                 .absolute = absolute_share * relative,
                                 .most_steps = 1'000'000};
    try {
      CvodeSolver solver(problem, settings);
      const double begin_s = ThreadTime_s();
      const SolverProblem::Motion motion = solver.Solve();
      const double time_s = ThreadTime_s() - begin_s;
      const double found_m = problem.TipError_m(motion, reference.motion);
      if (found_m <= error_m) return Entry{settings, found_m, time_s};
    } catch (const std::runtime_error&) {
      continue;  // too loose to get through
    }
  }
  return std::nullopt;
}

// The fastest of CVODE's settings at this accuracy: both methods, each with several absolute
// tolerances.
Entry FastestWithin(const SolverProblem& problem, const SolverReference& reference,
                    double error_m) {
  std::optional<Entry> best;
  for (const bool stiff : {true, false}) {
    for (const double absolute_share : {1.0, 0.1, 1e-2, 1e-3}) {
      const std::optional<Entry> entry =
          LoosestWithin(problem, reference, error_m, stiff, absolute_share);
      if (entry && (!best || entry->time_s < best->time_s)) best = entry;
    }
  }
  if (!best) throw std::runtime_error("CVODE does not reach the accuracy of the plant");
  return *best;
}

nlohmann::ordered_json JsonOf(const Timing& timing, double error_m) {
  return {{"median_s", timing.median_s},
          {"lower_quartile_s", timing.lower_quartile_s},
          {"upper_quartile_s", timing.upper_quartile_s},
          {"error_m", error_m}};
}

void Race(const std::string& file, std::size_t repetitions) {
  const RigConfig config = LoadConfig(file);
  const SolverProblem problem(config.arm, config.safety.torque_limit_nm);
  const SolverReference reference = MakeReference(problem);
  const double step_s = 1e-3 * config.sim.step_ms;
  const double error_m = problem.TipError_m(problem.ByPlant(step_s), reference.motion);
  const Entry best = FastestWithin(problem, reference, error_m);
  CvodeSolver solver(problem, best.settings);
  std::vector<double> plant_s, cvode_s, ratio;
  for (std::size_t i = 0; i < repetitions; ++i) {  // in turn, so that load meets both
    const double begin_s = ThreadTime_s();
    problem.ByPlant(step_s);
    const double between_s = ThreadTime_s();
    solver.Solve();
    plant_s.push_back(between_s - begin_s);
    cvode_s.push_back(ThreadTime_s() - between_s);
    ratio.push_back(cvode_s.back() / plant_s.back());
  }
  nlohmann::ordered_json json;
  json["repetitions"] = repetitions;
  json["reference_error_m"] = reference.error_m;
  json["step_s"] = step_s;
  json["plant"] = JsonOf(TimingOf(plant_s), error_m);
  json["cvode"] = JsonOf(TimingOf(cvode_s), best.error_m);
  json["cvode"]["method"] = best.settings.stiff ? "BDF" : "Adams";
  json["cvode"]["relative_tolerance"] = best.settings.relative;
  json["cvode"]["absolute_tolerance"] = best.settings.absolute;
  json["cvode"]["rate_calls"] = solver.rate_calls();
  json["ratio"] = Quantile(ratio, 0.5);
  std::cout << json.dump(2) << '\n';
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw std::runtime_error("usage: flexarm-cvode-race CONFIG REPETITIONS");
    flexarm::Race(argv[1], std::stoul(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flexarm-cvode-race: %s\n", error.what());
    return 1;
  }
}
