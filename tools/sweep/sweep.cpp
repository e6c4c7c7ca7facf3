#include "tools/sweep/sweep.h"

#include <charconv>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "controller/runlog/build_info.h"
#include "controller/runlog/errors.h"
#include "controller/types/rejected_error.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/fast_moves.h"
#include "tools/sweep/plant_variant.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

constexpr double kMostPayloadKg = 100.0;  // the limit of `flexarm simulate`

double PayloadKg(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && rest == end && value >= 0.0 && value <= kMostPayloadKg) return value;
  throw InputError("payload " + text + ": expected kilograms from 0 to 100");
}

// The changes that the values of one point, or of one axis, stand for.
struct Changes {
  const Scenario* scenario = nullptr;
  std::vector<std::string> config, plant;
  std::string variant = "nominal";
  std::optional<double> payload_kg;
};

const Scenario& ScenarioNamed(const SweepPlan& plan, const std::string& name) {
  for (const Scenario& scenario : plan.scenarios) {
    if (scenario.name == name) return scenario;
  }
  throw InputError("scenario \"" + name + "\": there is no scenario of that name");
}

void Add(const SweepPlan& plan, const SweepAxis& axis, const std::string& value, Changes* changes) {
  switch (axis.target) {
    case AxisTarget::kConfig:
      changes->config.push_back(axis.key + "=" + value);
      break;
    case AxisTarget::kPlant:
      changes->plant.push_back(axis.key + "=" + value);
      break;
    case AxisTarget::kVariant:
      changes->variant = value;
      break;
    case AxisTarget::kPayload:
      changes->payload_kg = PayloadKg(value);
      break;
    case AxisTarget::kScenario: {
      const Scenario& scenario = ScenarioNamed(plan, value);
      changes->scenario = &scenario;
      changes->payload_kg = scenario.payload_kg;
      changes->variant = scenario.variant;
      changes->config.insert(changes->config.end(), scenario.config.begin(), scenario.config.end());
      changes->plant.insert(changes->plant.end(), scenario.plant.begin(), scenario.plant.end());
      break;
    }
    case AxisTarget::kSeed:
      changes->config.push_back("sim.seed=" + value);
      break;
  }
}

SimulationRequest RequestFor(const SweepPlan& plan, const Changes& changes) {
  SimulationRequest request{
      .config = changes.config.empty() ? plan.config : WithOverrides(plan.config, changes.config),
      .experiment = changes.scenario != nullptr ? changes.scenario->experiment : plan.experiment,
      .plant = {},
      .payload_kg = changes.payload_kg,
      .log = {}};
  if (changes.scenario != nullptr && changes.scenario->random) {
    const MoveRecipe& recipe = *changes.scenario->random;
    const std::uint64_t seed = request.config.sim.seed;
    const RandomMoves drawn =
        changes.scenario->fast ? MakeFastMoves(request.config, seed, recipe)
                               : MakeRandomMoves(RigidJointArm(request.config.arm), seed, recipe);
    request.experiment = drawn.experiment;
    request.payload_kg = drawn.payload_kg;
  }
  std::vector<std::string> plant = VariantOverrides(request.config, changes.variant);
  plant.insert(plant.end(), changes.plant.begin(), changes.plant.end());
  if (!plant.empty()) request.plant = PlantWith(request.config, plant);
  return request;
}

}  // namespace

void CheckPlan(const SweepPlan& plan) {
  for (const SimEvent& event : plan.experiment.sim_event) {
    if (event.kill)
      throw InputError("the experiment has a kill event, which would end the sweep too");
  }
  for (const SweepAxis& axis : plan.grid.axes()) {
    for (const std::string& value : axis.values) {
      Changes changes;
      Add(plan, axis, value, &changes);
      RequestFor(plan, changes);
    }
  }
}

SweepIdentity IdentityOf(const SweepPlan& plan) {
  std::string experiments = plan.experiment.text;
  for (const Scenario& scenario : plan.scenarios) experiments += scenario.experiment.text;
  return {.build = BuildId(),
          .config_text = plan.config.text,
          .experiment_name = plan.experiment.name,
          .experiment_text = experiments,
          .axes = plan.grid.axes()};
}

SimulationRequest RequestAt(const SweepPlan& plan, std::size_t point) {
  const std::vector<std::string> values = plan.grid.Values(point);
  Changes changes;
  for (std::size_t i = 0; i < values.size(); ++i)
    Add(plan, plan.grid.axes()[i], values[i], &changes);
  return RequestFor(plan, changes);
}

SweepRow RunPoint(const SweepPlan& plan, std::size_t point) {
  const auto started = std::chrono::steady_clock::now();
  SweepRow row;
  try {
    const SimulationRequest request = RequestAt(plan, point);
    row = RowOf(point, request, Simulate(request));
  } catch (const RejectedError& error) {
    row = RefusedRow(point, error.what());
  } catch (const ConfigError& error) {  // values that are valid one by one, but not together
    row = RefusedRow(point, error.what());
  }
  row.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return row;
}

std::vector<std::size_t> PointsToRun(SweepFile* file, const Shard& shard) {
  std::set<std::size_t> there;
  for (const SweepRow& row : file->Rows()) there.insert(row.point);
  std::vector<std::size_t> points;
  for (std::size_t point = 0; point < file->grid().size(); ++point) {
    if (shard.Has(point) && !there.contains(point)) points.push_back(point);
  }
  return points;
}

void RunSweep(const SweepPlan& plan, const std::vector<std::size_t>& points, SweepFile* file,
              std::size_t jobs, const std::function<void(std::size_t)>& progress) {
  std::mutex mutex;  // guards the file
  ParallelFor(
      points.size(),
      [&](std::size_t i) {
        const SweepRow row = RunPoint(plan, points[i]);
        const std::scoped_lock lock(mutex);
        file->Add(row);
      },
      progress, jobs);
}

std::vector<std::size_t> MergeSweeps(const std::vector<std::filesystem::path>& parts,
                                     const std::filesystem::path& output) {
  if (std::filesystem::exists(output)) {
    throw InputError(output.string() + ": exists already; results are never overwritten");
  }
  std::optional<SweepIdentity> identity;
  std::map<std::size_t, SweepRow> merged;
  for (const std::filesystem::path& part : parts) {
    SweepFile file = SweepFile::Open(part);
    if (!identity) identity = file.identity();
    const std::string difference = DifferenceOf(*identity, file.identity());
    if (!difference.empty()) {
      throw InputError(part.string() + ": does not belong to the same sweep as " +
                       parts.front().string() + ", which " + difference);
    }
    for (const SweepRow& row : file.Rows()) {
      if (SameOutcome(merged.try_emplace(row.point, row).first->second, row)) continue;
      throw InputError(part.string() + ": point " + std::to_string(row.point) +
                       " has another result than in a file before it");
    }
  }
  SweepFile all = SweepFile::Resume(output, identity.value());
  std::vector<SweepRow> rows;
  rows.reserve(merged.size());
  for (const auto& [point, row] : merged) rows.push_back(row);
  all.AddAll(rows);
  return PointsToRun(&all, {});
}

}  // namespace flexarm
