// Drifts of the simulated rig, found by the parallel plant from the logs of varied runs.
// docs/health.md has the figures of the whole campaign (FLEXARM_CAMPAIGN=whole).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "controller/health/drift_trend.h"
#include "controller/host/simulation.h"
#include "tests/support/campaign.h"
#include "tools/health/log_health.h"
#include "tools/support/parallel_for.h"
#include "tools/support/scratch_folder.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

constexpr int kMostRuns = 10;  // issue: each drift is named in at most ten runs

std::filesystem::path Source(const std::string& file) {
  return std::filesystem::path(FLEXARM_SOURCE_DIR) / file;
}

// What a run does. Both joints move in each; the laws are those that these experiments allow.
struct Task {
  const char* experiment;
  const char* law;
};
constexpr std::array<Task, 14> kTasks = {{{"square-30deg", "sobel"},
                                          {"waypoints", "sobel"},
                                          {"square-20deg", "sobel"},
                                          {"sine", "sobel"},
                                          {"square-30deg", "sobel-thesis"},
                                          {"moves", "gain-scheduled"},
                                          {"benchmark-square", "lqr-cgt"},
                                          {"waypoints", "gain-scheduled"},
                                          {"trajectory", "sobel"},
                                          {"benchmark-unseen", "sobel"},
                                          {"fast-moves", "gain-scheduled"},
                                          {"chirp", "sobel"},
                                          {"prbs", "sobel"},
                                          {"tip-positions", "gain-scheduled"}}};

// The runs of the sample take 6 to 12 s, so that it ends in seconds.
constexpr std::size_t kShortTasks = 4;

struct RunOrder {
  std::string config;
  Task task;
  double payload_kg;
  std::uint64_t seed;
  std::vector<std::string> drift;  // overrides
};

HealthRecord RunOne(const RunOrder& order) {
  const ScratchFolder folder;
  std::vector<std::string> overrides = order.drift;
  overrides.push_back(std::string("controller.name=") + order.task.law);
  overrides.push_back("sim.seed=" + std::to_string(order.seed));
  SimulationRequest request;
  request.config = LoadConfig(Source("config/" + order.config + ".toml"), overrides);
  request.experiment =
      LoadExperiment(Source(std::string("config/experiments/") + order.task.experiment + ".toml"));
  request.payload_kg = order.payload_kg;
  request.log = folder.path() / "run.flexarm";
  const SimulationResult result = Simulate(request);
  EXPECT_TRUE(result.completed) << order.task.experiment << " " << order.task.law << " "
                                << order.payload_kg << " kg";
  return HealthOfLog(*request.log).record;
}

// Varied and the same on every machine.
RunOrder Varied(const std::string& config, std::uint64_t seed, std::size_t tasks) {
  UniformNumbers random(seed);
  const auto task = static_cast<std::size_t>(random.Between(0.0, static_cast<double>(tasks)));
  return {.config = config,
          .task = kTasks[std::min(task, tasks - 1)],
          .payload_kg = random.Between(0.0, 0.3),
          .seed = seed,
          .drift = {}};
}

std::vector<HealthRecord> RunAll(const std::vector<RunOrder>& orders) {
  std::vector<HealthRecord> records(orders.size());
  ParallelFor(orders.size(), [&](std::size_t i) { records[i] = RunOne(orders[i]); });
  return records;
}

struct Rig {
  explicit Rig(const std::string& config_name)
      : config(LoadConfig(Source("config/" + config_name + ".toml"))),
        channels(DriftChannels(config.arm, config.sensors)),
        scales(ScalesOf(channels, config.arm, config.sensors)) {}

  std::vector<std::string> Alarms(const HealthHistory& history) const {
    std::vector<std::string> keys;
    const std::vector<DriftTrend> trends = DriftTrends(channels, scales, history);
    for (std::size_t i = 0; i < trends.size(); ++i) {
      if (trends[i].verdict == DriftVerdict::kDrifts) keys.push_back(channels[i].Key());
    }
    return keys;
  }

  RigConfig config;
  std::vector<DriftChannel> channels;
  std::vector<DriftScale> scales;
};

// A drift that grows by `step` from run to run.
struct Drift {
  std::string key;  // of the channel
  std::string setting;
  int place, places;  // of the number in the list; 0 places: no list
  double step;

  std::vector<std::string> At(int run) const {
    const std::string number = std::to_string(run * step);
    if (places == 0) return {setting + "=" + number};
    std::string list;
    for (int i = 0; i < places; ++i) list += (i == 0 ? "" : ", ") + (i == place ? number : "0.0");
    return {setting + "=[" + list + "]"};
  }
};

Drift OfGauge(int link, int gauge, bool gain, double step) {
  const int place = (link - 1) * 10 + gauge - 1;
  return {.key = "link" + std::to_string(link) + ".gauge" + std::to_string(gauge) +
                 (gain ? ".gain" : ".zero"),
          .setting = gain ? "sim.drift.gauge_gain_error" : "sim.drift.gauge_zero_share",
          .place = place,
          .places = place + 1,
          .step = step};
}

Drift OfPart(const char* key, const char* setting, int part, double step) {
  return {.key = key, .setting = setting, .place = part - 1, .places = 2, .step = step};
}

// The drifts of the issue: gain 1 %, zero 1 % of range, friction 10 %, stiffness 1 %, payload 20 g.
// Those in front are the sample.
std::vector<Drift> Drifts() {
  std::vector<Drift> drifts = {
      OfGauge(1, 7, true, -0.01),
      OfGauge(2, 3, false, 0.01),
      OfPart("joint2.friction", "sim.drift.friction_error", 2, 0.1),
      OfPart("link1.stiffness", "sim.drift.link_stiffness_error", 1, -0.01),
      {.key = "payload",
       .setting = "sim.drift.payload_error_kg",
       .place = 0,
       .places = 0,
       .step = 0.02},
      OfPart("joint1.friction", "sim.drift.friction_error", 1, 0.1),
      OfPart("joint1.friction", "sim.drift.friction_error", 1, -0.09),
      OfPart("joint2.friction", "sim.drift.friction_error", 2, -0.09),
      OfPart("link1.stiffness", "sim.drift.link_stiffness_error", 1, 0.01),
      OfPart("link2.stiffness", "sim.drift.link_stiffness_error", 2, -0.01),
      OfPart("link2.stiffness", "sim.drift.link_stiffness_error", 2, 0.01),
      OfPart("joint1.stiffness", "sim.drift.joint_stiffness_error", 1, -0.01),
      OfPart("joint1.stiffness", "sim.drift.joint_stiffness_error", 1, 0.01),
      OfPart("joint2.stiffness", "sim.drift.joint_stiffness_error", 2, -0.01),
      OfPart("joint2.stiffness", "sim.drift.joint_stiffness_error", 2, 0.01),
      {.key = "payload",
       .setting = "sim.drift.payload_error_kg",
       .place = 0,
       .places = 0,
       .step = -0.02}};
  for (const int link : {1, 2}) {
    for (const int gauge : {1, 4, 7, 10}) {
      drifts.push_back(OfGauge(link, gauge, true, gauge % 2 == 0 ? 0.01 : -0.01));
      drifts.push_back(OfGauge(link, gauge, false, gauge % 2 == 0 ? -0.01 : 0.01));
    }
  }
  return drifts;
}

// Each case runs until it is named, with other experiments, payloads and noise, with its drift from
// the first run on. A payload that shrinks begins with enough to lose.
void FindEach(const std::vector<Drift>& drifts, std::size_t tasks, std::uint64_t seed) {
  const Rig rig("thesis-rig");
  std::vector<int> found(drifts.size(), 0);
  std::vector<std::vector<std::string>> alarms(drifts.size());
  ParallelFor(drifts.size(), [&](std::size_t i) {
    HealthHistory history;
    for (int run = 1; run <= kMostRuns && found[i] == 0; ++run) {
      RunOrder order = Varied("thesis-rig", seed + 100 * i + static_cast<std::size_t>(run), tasks);
      if (drifts[i].key == "payload" && drifts[i].step < 0.0) order.payload_kg = 0.2;
      order.drift = drifts[i].At(run);
      history.Add(RunOne(order));
      alarms[i] = rig.Alarms(history);
      if (!alarms[i].empty()) found[i] = run;
    }
  });
  for (std::size_t i = 0; i < drifts.size(); ++i) {
    std::printf("%-22s %+6.2f a run: named in run %d\n", drifts[i].key.c_str(), drifts[i].step,
                found[i]);
    EXPECT_EQ(alarms[i], std::vector<std::string>{drifts[i].key}) << "step " << drifts[i].step;
  }
}

TEST(HealthCampaign, EachDriftIsNamedWithItsChannelInAtMostTenRuns) {
  std::vector<Drift> drifts = Drifts();
  const long cases = CampaignCases(5, static_cast<long>(drifts.size()));
  const bool whole = cases >= static_cast<long>(drifts.size());
  if (!whole) drifts.resize(static_cast<std::size_t>(std::max(1L, cases)));
  FindEach(drifts, whole ? kTasks.size() : kShortTasks, 1);
}

TEST(HealthCampaign, NoAlarmInRunsWithoutDrift) {
  const Rig rig("thesis-rig");
  const long runs = CampaignCases(8, 500);
  std::vector<RunOrder> orders;
  for (long run = 0; run < runs; ++run) {
    orders.push_back(Varied("thesis-rig", 10'000 + static_cast<std::uint64_t>(run),
                            runs >= 100 ? kTasks.size() : kShortTasks));
  }
  HealthHistory history;
  std::map<std::string, double> largest;
  for (HealthRecord& record : RunAll(orders)) {
    EXPECT_EQ(record.unused, "");
    history.Add(std::move(record));
    EXPECT_EQ(rig.Alarms(history), std::vector<std::string>{}) << "run " << history.run.size();
    const std::vector<DriftTrend> trends = DriftTrends(rig.channels, rig.scales, history);
    for (std::size_t i = 0; i < trends.size(); ++i) {
      double& most = largest[rig.channels[i].Key()];
      most = std::max(most, std::abs(trends[i].sigmas));
    }
  }
  for (const auto& [key, sigmas] : largest) {
    std::printf("%-22s at most %.1f sigmas\n", key.c_str(), sigmas);
  }
}

}  // namespace
}  // namespace flexarm
