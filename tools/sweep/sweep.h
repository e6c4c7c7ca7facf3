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

/// A sweep: the runs of one experiment over a grid.
struct SweepPlan {
  RigConfig config;  ///< of every point, before its axes
  Experiment experiment;
  SweepGrid grid;
  std::vector<Scenario> scenarios{};  ///< named by an axis of kScenario; each has its experiment
};

/// @throws InputError, ConfigError  a value of an axis is not valid by itself; the experiment would
/// kill the program
void CheckPlan(const SweepPlan& plan);

SweepIdentity IdentityOf(const SweepPlan& plan);

/// The simulation of one point. Changes apply in this order: scenario, config axes, the plant's
/// variant, plant axes.
SimulationRequest RequestAt(const SweepPlan& plan, std::size_t point);

/// One run. A refused design or experiment is a result, not an error.
SweepRow RunPoint(const SweepPlan& plan, std::size_t point);

/// The points of a shard that the file does not have yet.
std::vector<std::size_t> PointsToRun(SweepFile* file, const Shard& shard);

/// Runs `points` and adds each result to the file when its run ends. Results do not depend on
/// `jobs`.
void RunSweep(const SweepPlan& plan, const std::vector<std::size_t>& points, SweepFile* file,
              std::size_t jobs, const std::function<void(std::size_t)>& progress = {});

/// Merges result files. @returns the points that no file has
std::vector<std::size_t> MergeSweeps(const std::vector<std::filesystem::path>& parts,
                                     const std::filesystem::path& output);

}  // namespace flexarm
