#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/torture/scenario.h"
#include "tools/torture/torture.h"

namespace flexarm {

/// A scenario that broke a rule.
struct TortureFailure {
  std::uint64_t seed;
  Violation violation;  ///< the first of it
  std::string text;     ///< what happened
};

/// The result of many scenarios.
struct TortureSummary {
  std::uint64_t first_seed = 0, last_seed = 0;
  std::size_t scenarios = 0;
  std::size_t clean = 0;       ///< of them, those in which nothing may trip
  std::size_t observable = 0;  ///< those with one fault that had to be named in time
  std::size_t tripped = 0;
  double simulated_s = 0.0;
  std::int64_t replayed_steps = 0;
  Peaks peaks{};
  std::map<std::string, std::size_t> causes{};  ///< of the trips
  std::map<std::string, std::size_t> rules{};   ///< scenarios by the first rule that they broke
  std::vector<TortureFailure> failures{};       ///< all
};

/// The scenarios of the seeds. @throws InputError  an empty list
std::vector<TortureScenario> ScenariosOf(const std::vector<std::uint64_t>& seeds,
                                         const TortureSpace& space, const RigConfig& config);

/// Runs scenarios, at least one, on all cores. The summary does not depend on `jobs`.
TortureSummary RunTorture(const TorturedRigs& rigs, const std::vector<TortureScenario>& scenarios,
                          std::size_t jobs, const std::function<void(std::size_t)>& progress = {});

nlohmann::ordered_json TortureJson(const TortureSummary& summary);

}  // namespace flexarm
