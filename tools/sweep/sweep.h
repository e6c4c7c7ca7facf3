#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/host/simulation.h"
#include "tools/sweep/scenario.h"
#include "tools/sweep/sweep_file.h"
#include "tools/sweep/sweep_grid.h"

namespace flexarm {

/// Runs of one experiment over a grid.
struct SweepPlan {
  RigConfig config;  ///< of every point, before its axes
  Experiment experiment;
  SweepGrid grid;
  std::vector<Scenario> scenarios{};  ///< that an axis of kScenario names; each has its experiment
};

/// @throws InputError, ConfigError  a value of an axis that by itself is no config, payload or
///         seed; an experiment that would kill the program
void CheckPlan(const SweepPlan& plan);

SweepIdentity IdentityOf(const SweepPlan& plan);

/// What runs at a point. A scenario comes first, then config axes, then the plant's variant, then
/// plant axes.
SimulationRequest RequestAt(const SweepPlan& plan, std::size_t point);

/// One run. A design or an experiment that is refused there is a result, not an error.
SweepRow RunPoint(const SweepPlan& plan, std::size_t point);

/// The points of a shard that the file does not have yet.
std::vector<std::size_t> PointsToRun(SweepFile* file, const Shard& shard);

/// Runs `points` and adds each to the file as it ends. Results do not depend on `jobs`.
void RunSweep(const SweepPlan& plan, const std::vector<std::size_t>& points, SweepFile* file,
              std::size_t jobs, const std::function<void(std::size_t)>& progress = {});

/// What a merge found: points that no file has.
std::vector<std::size_t> MergeSweeps(const std::vector<std::filesystem::path>& parts,
                                     const std::filesystem::path& output);

}  // namespace flexarm
