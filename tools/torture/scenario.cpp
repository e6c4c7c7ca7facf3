#include "tools/torture/scenario.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "controller/types/law_table.h"
#include "model/units.h"
#include "tools/sweep/plant_variant.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, kSituations> kNames = {
    "Starting", "Idle", "Armed", "Running", "Stopping", "Disarming", "Tripped", "FaultStopping"};

// Draws from one generator: the same numbers on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : uniform_(seed) {}

  double Between(double low, double high) { return uniform_.Between(low, high); }
  int Below(int n) { return std::min(static_cast<int>(uniform_.Between(0.0, n)), n - 1); }
  bool With(double probability) { return uniform_.Between(0.0, 1.0) < probability; }
  std::int64_t Ms(double low, double high) {
    return std::llround(uniform_.Between(low, high)) * kMs;
  }
  std::uint64_t Seed() { return static_cast<std::uint64_t>(uniform_.Between(1.0, 0x1p52)); }
  template <typename T>
  const T& Of(const std::vector<T>& all) {
    return all[static_cast<std::size_t>(Below(static_cast<int>(all.size())))];
  }

 private:
  UniformNumbers uniform_;
};

const LawRow* RowOf(const std::string& law) {
  const auto* const row = std::find_if(kLaws.begin(), kLaws.end(),
                                       [&law](const LawRow& one) { return law == one.name; });
  return row == kLaws.end() ? nullptr : row;
}

Fault DrawFault(const TortureSpace& space, const std::string& law, Draw* draw) {
  for (;;) {
    const auto place = static_cast<FaultPlace>(draw->Below(kFaultPlaces));
    const auto kind = static_cast<FaultKind>(draw->Below(kFaultKinds));
    const int index = draw->Below(CountOf(place, space.gauges));
    if (!Exists(place, kind) || !Has(law, place)) continue;
    const std::int64_t from_ns = draw->Ms(0.0, 40.0);
    // Half of them stay until the recovery.
    const std::int64_t to_ns = draw->With(0.5) ? INT64_MAX : from_ns + draw->Ms(1.0, 400.0);
    return {.place = place,
            .index = index,
            .kind = kind,
            .from_ns = from_ns,
            .to_ns = to_ns,
            .seed = draw->Seed()};
  }
}

std::vector<std::string> DrawPlant(Draw* draw, const RigConfig& config) {
  std::vector<std::string> plant;
  if (draw->With(0.5)) {
    plant = VariantOverrides(config, draw->Of(PlantVariants()).name);
  } else {
    const auto scaled = [&](const char* key, double value, double low, double high) {
      plant.push_back(std::string(key) + "=" + std::to_string(value * draw->Between(low, high)));
    };
    scaled("joint1.coulomb_friction_nm", config.arm.joint[0].coulomb_friction_nm, 0.5, 2.0);
    scaled("joint2.coulomb_friction_nm", config.arm.joint[1].coulomb_friction_nm, 0.5, 2.0);
    scaled("joint1.stiffness_nm_per_rad", config.arm.joint[0].stiffness_nm_per_rad, 0.8, 1.2);
    scaled("joint2.stiffness_nm_per_rad", config.arm.joint[1].stiffness_nm_per_rad, 0.8, 1.2);
    plant.push_back("joint2.backlash_rad=" + std::to_string(draw->Between(0.0, 0.003)));
  }
  if (draw->With(0.3)) {
    plant.push_back("sim.lost_frame_fraction=" + std::to_string(draw->Between(0.0, 0.01)));
  }
  return plant;
}

nlohmann::json Command(const char* name) { return {{"command", name}}; }

std::string DrawCommand(Draw* draw) {
  constexpr std::array<const char*, 8> kPlain = {"stop",   "disarm", "arm",  "reset",
                                                 "status", "zero",   "tare", "stop"};
  const int which = draw->Below(10);
  if (which < 8) return Command(kPlain.at(static_cast<std::size_t>(which))).dump();
  nlohmann::json run = Command("run");
  run["experiment"] =
      "name = \"other\"\nduration_s = 0.6\n[[move]]\nstart_s = 0.0\nduration_s = 0.4\nto_deg = [" +
      std::to_string(draw->Below(5)) + ".0, 0.0]\n";
  return run.dump();
}

bool FollowsPayload(const std::string& law) {
  const LawRow* const row = RowOf(law);
  return row != nullptr && (row->is_scheduled || row->plans_ahead);
}

// A change of the path that goes on.
std::string DrawChange(Draw* draw) {
  constexpr std::array<const char*, 4> kChanges = {"pause", "resume", "speed", "retarget"};
  const std::string name = kChanges.at(static_cast<std::size_t>(draw->Below(4)));
  nlohmann::json change = Command(name.c_str());
  if (name == "speed") change["speed_percent"] = draw->Between(10.0, 100.0);
  if (name == "retarget") {
    change["to_deg"] = {draw->Between(-30.0, 30.0), draw->Between(-40.0, 40.0)};
  }
  return change.dump();
}

void DrawCommands(Draw* draw, TortureScenario* scenario) {
  if (!draw->With(0.3)) return;
  const int count = 1 + draw->Below(4);
  for (int i = 0; i < count; ++i) {
    const std::int64_t at_ns = draw->Ms(-20.0, 300.0);
    scenario->commands.push_back({.at_ns = at_ns, .text = DrawCommand(draw)});
  }
}

void DrawChanges(Draw* draw, TortureScenario* scenario) {
  if (!FollowsPayload(scenario->law) || !draw->With(0.5)) return;
  const int count = 1 + draw->Below(3);
  for (int i = 0; i < count; ++i) {
    const std::int64_t at_ns = draw->Ms(-20.0, 600.0);
    scenario->commands.push_back({.at_ns = at_ns, .text = DrawChange(draw)});
  }
}

void InOrderOfTime(TortureScenario* scenario) {
  std::stable_sort(scenario->commands.begin(), scenario->commands.end(),
                   [](const TimedCommand& a, const TimedCommand& b) { return a.at_ns < b.at_ns; });
}

}  // namespace

const char* ToString(Situation situation) noexcept {
  return kNames.at(static_cast<std::size_t>(situation));
}

const std::array<double, 2>& TortureSpace::PayloadsOf(const std::string& law) const {
  return FollowsPayload(law) ? payload_kg : fixed_payload_kg;
}

bool Has(const std::string& law, FaultPlace place) {
  const LawRow* const row = RowOf(law);
  return place != FaultPlace::kPlanner || (row != nullptr && row->plans_ahead);
}

double MoveTime_s(const TortureSpace& space, const std::array<double, 2>& to_deg,
                  double heaviest_kg, double share) {
  const Eigen::Vector2d to_rad = Eigen::Vector2d(to_deg[0], to_deg[1]) * kRadPerDeg;
  const double rule_s =
      RuleDuration_s(space.arm, heaviest_kg, Eigen::Vector2d::Zero(), to_rad, space.recipe.ability);
  return OnMoveGrid(share * rule_s, space.recipe.grid_s);
}

TortureSpace SpaceOf(const RigConfig& config, std::vector<std::string> laws) {
  const std::array<double, 2>& range_kg = config.controller.payload_range_kg;
  const double nominal_kg = config.arm.payload_mass_kg;
  return {.laws = std::move(laws),
          .payload_kg = range_kg,
          .fixed_payload_kg = {std::clamp(0.5 * nominal_kg, range_kg[0], range_kg[1]),
                               std::clamp(1.5 * nominal_kg, range_kg[0], range_kg[1])},
          .gauges = static_cast<int>(config.sensors.strain.size()),
          .within_deg = {40.0, 50.0},
          .arm = RigidJointArm(config.arm),
          .recipe = RecipeFor(config)};
}

TortureScenario ScenarioOf(std::uint64_t seed, const TortureSpace& space, const RigConfig& config) {
  Draw draw(seed);
  TortureScenario scenario{.seed = seed, .law = draw.Of(space.laws)};
  const std::array<double, 2>& payload_kg = space.PayloadsOf(scenario.law);
  scenario.payload_kg = draw.Between(payload_kg[0], payload_kg[1]);
  scenario.plant = DrawPlant(&draw, config);
  for (std::size_t i = 0; i < 2; ++i) {
    scenario.move_to_deg[i] = draw.Between(-space.within_deg[i], space.within_deg[i]);
  }
  scenario.move_s = MoveTime_s(space, scenario.move_to_deg, payload_kg[1], draw.Between(1.0, 1.5));
  // Half of all in mid-move, where a fault does most.
  scenario.situation =
      draw.With(0.5) ? Situation::kRunning : static_cast<Situation>(draw.Below(kSituations));
  scenario.after_ns = draw.Ms(0.0, scenario.situation == Situation::kRunning ? 900.0 : 60.0);
  const double kind = draw.Between(0.0, 1.0);
  const int faults = kind < 0.1 ? 0 : kind < 0.7 ? 1 : kind < 0.9 ? 2 : 3;
  for (int i = 0; i < faults; ++i) scenario.faults.push_back(DrawFault(space, scenario.law, &draw));
  DrawCommands(&draw, &scenario);
  scenario.recovers = draw.With(0.3);
  constexpr std::array<std::int64_t, 4> kLatest = {0, 50'000, 400'000, 900'000};
  scenario.wake_ups = {.seed = draw.Seed(),
                       .latest_ns = kLatest.at(static_cast<std::size_t>(draw.Below(4))),
                       .latest_slow_ns = draw.Ms(0.0, 15.0),
                       .order_changes = draw.Below(8)};
  DrawChanges(&draw, &scenario);
  InOrderOfTime(&scenario);
  return scenario;
}

std::string Text(const TortureScenario& scenario) {
  std::string text = scenario.law + ", " + std::to_string(scenario.payload_kg) + " kg, " +
                     ToString(scenario.situation) + " + " +
                     std::to_string(scenario.after_ns / kMs) + " ms";
  for (const Fault& fault : scenario.faults) {
    text += "; " + Text(fault) + " from +" + std::to_string(fault.from_ns / kMs) + " ms";
    if (fault.to_ns != INT64_MAX) text += " to +" + std::to_string(fault.to_ns / kMs) + " ms";
  }
  for (const std::string& set : scenario.plant) text += "; plant " + set;
  for (const TimedCommand& command : scenario.commands) {
    text += "; at " + std::to_string(command.at_ns / kMs) + " ms " +
            nlohmann::json::parse(command.text).value("command", "");
  }
  if (scenario.wake_ups.latest_ns > 0) {
    text += "; threads up to " + std::to_string(scenario.wake_ups.latest_ns / 1'000) + " us late";
  }
  if (scenario.recovers) text += "; then the way back";
  return text;
}

}  // namespace flexarm
