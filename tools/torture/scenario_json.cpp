#include "tools/torture/scenario_json.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "controller/files/external_file.h"
#include "controller/files/external_json.h"
#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr FileKind kScenarioFile{"a scenario of flexarm torture", 1 << 20, FileSyntax::kJson};

// Whole nanoseconds as milliseconds, and back: a double has digits enough.
double Ms(std::int64_t ns) { return static_cast<double>(ns) / static_cast<double>(kMs); }
std::int64_t Ns(const Json& ms) {
  return std::llround(ms.get<double>() * static_cast<double>(kMs));
}

// The value of an enum whose names ToString gives, of `count`.
template <typename T>
T Named(const Json& name, int count) {
  for (int i = 0; i < count; ++i) {
    if (name == ToString(static_cast<T>(i))) return static_cast<T>(i);
  }
  throw InputError("unknown name " + name.dump());
}

Json FaultJson(const Fault& fault) {
  return {{"place", ToString(fault.place)},
          {"index", fault.index},
          {"kind", ToString(fault.kind)},
          {"from_ms", Ms(fault.from_ns)},
          {"to_ms", fault.to_ns == INT64_MAX ? Json(nullptr) : Json(Ms(fault.to_ns))},
          {"seed", fault.seed}};
}

Fault FaultOf(const Json& json, int gauges) {
  const Json& to_ms = json.at("to_ms");
  const Fault fault{.place = Named<FaultPlace>(json.at("place"), kFaultPlaces),
                    .index = json.at("index"),
                    .kind = Named<FaultKind>(json.at("kind"), kFaultKinds),
                    .from_ns = Ns(json.at("from_ms")),
                    .to_ns = to_ms.is_null() ? INT64_MAX : Ns(to_ms),
                    .seed = json.at("seed")};
  if (!Exists(fault.place, fault.kind)) throw InputError("there is no " + Text(fault));
  if (fault.index < 0 || fault.index >= CountOf(fault.place, gauges)) {
    throw InputError(std::string(ToString(fault.place)) + " has no index " +
                     std::to_string(fault.index));
  }
  return fault;
}

TortureScenario ScenarioFrom(const Json& json, int gauges) {
  const Json& wake_ups = json.at("wake_ups");
  TortureScenario scenario{.seed = json.at("seed"),
                           .law = json.at("law"),
                           .payload_kg = json.at("payload_kg"),
                           .plant = json.at("plant"),
                           .move_to_deg = json.at("move_to_deg"),
                           .move_s = json.at("move_s"),
                           .situation = Named<Situation>(json.at("situation"), kSituations),
                           .after_ns = Ns(json.at("after_ms")),
                           .recovers = json.at("recovers"),
                           .wake_ups = {.seed = wake_ups.at("seed"),
                                        .latest_ns = Ns(wake_ups.at("latest_ms")),
                                        .latest_slow_ns = Ns(wake_ups.at("latest_slow_ms")),
                                        .order_changes = wake_ups.at("order_changes")}};
  for (const Json& fault : json.at("faults")) scenario.faults.push_back(FaultOf(fault, gauges));
  for (const Json& command : json.at("commands")) {
    scenario.commands.push_back(
        {.at_ns = Ns(command.at("at_ms")), .text = command.at("line").dump()});
  }
  return scenario;
}

}  // namespace

Json ScenarioJson(const TortureScenario& scenario) {
  Json faults = Json::array(), commands = Json::array();
  for (const Fault& fault : scenario.faults) faults.push_back(FaultJson(fault));
  for (const TimedCommand& command : scenario.commands) {
    commands.push_back({{"at_ms", Ms(command.at_ns)}, {"line", Json::parse(command.text)}});
  }
  return {{"seed", scenario.seed},
          {"law", scenario.law},
          {"payload_kg", scenario.payload_kg},
          {"plant", scenario.plant},
          {"move_to_deg", scenario.move_to_deg},
          {"move_s", scenario.move_s},
          {"situation", ToString(scenario.situation)},
          {"after_ms", Ms(scenario.after_ns)},
          {"faults", faults},
          {"commands", commands},
          {"recovers", scenario.recovers},
          {"wake_ups",
           {{"seed", scenario.wake_ups.seed},
            {"latest_ms", Ms(scenario.wake_ups.latest_ns)},
            {"latest_slow_ms", Ms(scenario.wake_ups.latest_slow_ns)},
            {"order_changes", scenario.wake_ups.order_changes}}}};
}

TortureScenario ReadScenario(const std::filesystem::path& file, int gauges) {
  const Json json =
      ParseJson(ReadExternalText(file, kScenarioFile), file.string(), kScenarioFile.name);
  try {
    return ScenarioFrom(json, gauges);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file.string() + ": no scenario of a torture: " + error.what());
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

}  // namespace flexarm
