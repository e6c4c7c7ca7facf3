#include "tools/tuning/move_check.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "controller/host/simulation.h"
#include "controller/types/rejected_error.h"
#include "controller/types/rounded_text.h"
#include "controller/types/tip_tolerance.h"
#include "model/units.h"
#include "tools/sweep/fast_moves.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

constexpr int kMoves = 4;
constexpr double kRest_s = 2.0;
constexpr double kFirstGap_s = 5.0, kLongestGap_s = 40.0;

Experiment RandomTargets(const RigConfig& config, std::uint64_t seed, double gap_s) {
  UniformNumbers random(seed);
  Experiment experiment{};
  experiment.name = "random-targets";
  experiment.duration_s = kMoves * gap_s;
  constexpr double kShareOfSoftAngle = 2.0 / 3.0;
  for (int i = 0; i < kMoves; ++i) {
    Move move{.start_s = i * gap_s};
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double most_deg = kShareOfSoftAngle * config.safety.soft_angle_deg[joint];
      move.to_deg[joint] = random.Between(-most_deg, most_deg);
    }
    experiment.move.push_back(move);
  }
  return experiment;
}

// Room that the moves leave before the next one, s.
double ShortestRest_s(const SimulationResult& result, double gap_s) {
  double shortest = gap_s;
  for (const double duration_s : result.move_duration_s) {
    shortest = std::min(shortest, gap_s - duration_s);
  }
  return shortest;
}

// The same with more time between the moves, where they need it.
SimulationResult SimulateMoves(const RigConfig& config, double payload_kg, std::uint64_t seed) {
  for (double gap_s = kFirstGap_s;; gap_s *= 2.0) {
    SimulationRequest request;
    request.config = config;
    request.config.sim.seed = seed;
    request.experiment = RandomTargets(config, seed, gap_s);
    request.payload_kg = payload_kg;
    try {
      const SimulationResult result = Simulate(request);
      if (gap_s >= kLongestGap_s || ShortestRest_s(result, gap_s) >= kRest_s) return result;
    } catch (const RejectedError&) {  // the last move may not fit in
      if (gap_s >= kLongestGap_s) throw;
    }
  }
}

// Bound on the distance of the tip from its target at rest.
double TipError_m(const RigConfig& config, const RunMetrics& metrics) {
  const double upper = config.arm.link[1].length_m();
  const double reach = config.arm.link[0].length_m() + upper;
  return kRadPerDeg *
         (reach * metrics.joint_final_error_deg[0] + upper * metrics.joint_final_error_deg[1]);
}

std::string With(const std::string& what, double payload_kg) {
  return what + ", with " + RoundedText(payload_kg, 3) + " kg";
}

/// How the moves with one payload end.
struct Ending {
  double error_m;       ///< 0 if they do not
  std::string problem;  ///< "" if they end well
};

Ending EndingOf(const RigConfig& config, double payload_kg, std::uint64_t seed, double most_m) {
  try {
    const SimulationResult result = SimulateMoves(config, payload_kg, seed);
    if (!result.completed) {
      return {.error_m = 0.0,
              .problem = With(std::string("it trips: ") + ToString(result.trip), payload_kg)};
    }
    const double error_m = TipError_m(config, result.metrics);
    if (error_m <= most_m) return {.error_m = error_m, .problem = {}};
    const std::string end =
        "a move ends " + RoundedText(1e3 * error_m, 1, true) + " mm from its target";
    return {.error_m = error_m, .problem = With(end, payload_kg)};
  } catch (const std::exception& error) {
    return {.error_m = 0.0, .problem = With(error.what(), payload_kg)};
  }
}

}  // namespace

MoveCheck CheckMoves(const RigConfig& config, const std::vector<double>& payload_kg,
                     std::span<const std::uint64_t> seeds, double share) {
  const double permitted_m =
      std::min(kLargestTipError_m, kLargestTipErrorOfReach * Reach_m(config)) +
      CountAtTip_m(config);
  MoveCheck check{
      .passed = true, .problem = {}, .largest_error_mm = 0.0, .permitted_mm = 1e3 * permitted_m};
  for (const std::uint64_t seed : seeds) {
    for (const double payload : payload_kg) {
      const Ending ending = EndingOf(config, payload, seed, share * permitted_m);
      check.largest_error_mm = std::max(check.largest_error_mm, 1e3 * ending.error_m);
      if (ending.problem.empty()) continue;
      check.passed = false;
      check.problem = ending.problem;
      return check;
    }
  }
  return check;
}

std::string ProblemOfFastMoves(const RigConfig& config, const std::vector<double>& payload_kg,
                               std::span<const std::uint64_t> seeds) {
  for (const std::uint64_t seed : seeds) {
    for (const double payload : payload_kg) {
      SimulationRequest request;
      request.config = config;
      request.config.sim.seed = seed;
      request.experiment = MakeFastMoves(config, seed, RecipeFor(config)).experiment;
      request.payload_kg = payload;
      try {
        const SimulationResult result = Simulate(request);
        if (!result.completed) {
          return With(std::string("fast moves trip: ") + ToString(result.trip), payload);
        }
        const std::vector<Arrival>& arrival = result.metrics.arrival;
        if (!std::all_of(arrival.begin(), arrival.end(),
                         [](const Arrival& move) { return move.at_rest_s.has_value(); })) {
          return With("a fast move does not come to rest", payload);
        }
      } catch (const std::exception& error) {
        return With(error.what(), payload);
      }
    }
  }
  return {};
}

}  // namespace flexarm
