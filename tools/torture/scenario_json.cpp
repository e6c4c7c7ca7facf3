#include "tools/torture/scenario_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "controller/files/external_file.h"
#include "controller/files/external_json.h"
#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr FileKind kScenarioFile{"a scenario of flexarm torture", 1 << 20, FileSyntax::kJson};

// Whole nanoseconds as milliseconds, and back: a double has digits enough.
double Ms(std::int64_t ns) { return static_cast<double>(ns) / static_cast<double>(kMs); }

/// An object of the file, and where it is. Its errors say which member is wrong.
class Object {
 public:
  Object(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) throw InputError(where_ + "expected an object, found " + json.dump());
  }

  const Json& Member(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) {
      throw InputError(
          where_ + key +
          " is missing; expected a scenario as `flexarm torture --minimise` prints it");
    }
    return *found;
  }
  Object Within(const char* key) const { return {Member(key), where_ + key + "."}; }

  std::vector<Object> Each(const char* key) const {
    const Json& array = Member(key);
    if (!array.is_array()) Complain(key, "an array");
    std::vector<Object> objects;
    for (std::size_t i = 0; i < array.size(); ++i) {
      objects.emplace_back(array[i], where_ + key + "[" + std::to_string(i) + "].");
    }
    return objects;
  }

  double Number(const char* key) const {
    if (!Member(key).is_number()) Complain(key, "a number");
    return Member(key);
  }
  std::int64_t Ns(const char* key) const {
    return std::llround(Number(key) * static_cast<double>(kMs));
  }
  std::array<double, 2> Numbers(const char* key) const {
    const Json& pair = Member(key);
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_number() || !pair[1].is_number()) {
      Complain(key, "two numbers");
    }
    return pair;
  }
  std::uint64_t Seed(const char* key) const {
    if (!Member(key).is_number_unsigned()) Complain(key, "a whole number, 0 or more");
    return Member(key);
  }
  int Count(const char* key) const {
    if (Seed(key) > kMostCounted) Complain(key, "1000000 at most");
    return Member(key);
  }
  bool Flag(const char* key) const {
    if (!Member(key).is_boolean()) Complain(key, "true or false");
    return Member(key);
  }
  std::string Text(const char* key) const {
    if (!Member(key).is_string()) Complain(key, "text");
    return Member(key);
  }
  std::vector<std::string> Texts(const char* key) const {
    const Json& texts = Member(key);
    const auto is_text = [](const Json& text) { return text.is_string(); };
    if (!texts.is_array() || !std::all_of(texts.begin(), texts.end(), is_text)) {
      Complain(key, "an array of texts");
    }
    return texts;
  }
  /// The value of an enum whose names ToString gives, of `count`.
  template <typename T>
  T Named(const char* key, int count) const {
    for (int i = 0; i < count; ++i) {
      if (Member(key) == ToString(static_cast<T>(i))) return static_cast<T>(i);
    }
    throw InputError(where_ + key + ": unknown name " + Member(key).dump());
  }

 private:
  static constexpr std::uint64_t kMostCounted = 1'000'000;

  [[noreturn]] void Complain(const char* key, const char* expected) const {
    throw InputError(where_ + key + ": expected " + expected + ", found " + Member(key).dump());
  }

  const Json& json_;
  std::string where_;
};

Json FaultJson(const Fault& fault) {
  return {{"place", ToString(fault.place)},
          {"index", fault.index},
          {"kind", ToString(fault.kind)},
          {"from_ms", Ms(fault.from_ns)},
          {"to_ms", fault.to_ns == INT64_MAX ? Json(nullptr) : Json(Ms(fault.to_ns))},
          {"seed", fault.seed}};
}

Fault FaultOf(const Object& object, int gauges) {
  const bool ends = !object.Member("to_ms").is_null();
  const Fault fault{.place = object.Named<FaultPlace>("place", kFaultPlaces),
                    .index = object.Count("index"),
                    .kind = object.Named<FaultKind>("kind", kFaultKinds),
                    .from_ns = object.Ns("from_ms"),
                    .to_ns = ends ? object.Ns("to_ms") : INT64_MAX,
                    .seed = object.Seed("seed")};
  if (!Exists(fault.place, fault.kind)) throw InputError("there is no " + Text(fault));
  if (fault.index >= CountOf(fault.place, gauges)) {
    throw InputError(std::string(ToString(fault.place)) + " has no index " +
                     std::to_string(fault.index));
  }
  return fault;
}

TortureScenario ScenarioFrom(const Object& object, int gauges) {
  const Object wake_ups = object.Within("wake_ups");
  TortureScenario scenario{.seed = object.Seed("seed"),
                           .law = object.Text("law"),
                           .payload_kg = object.Number("payload_kg"),
                           .plant = object.Texts("plant"),
                           .move_to_deg = object.Numbers("move_to_deg"),
                           .move_s = object.Number("move_s"),
                           .situation = object.Named<Situation>("situation", kSituations),
                           .after_ns = object.Ns("after_ms"),
                           .recovers = object.Flag("recovers"),
                           .wake_ups = {.seed = wake_ups.Seed("seed"),
                                        .latest_ns = wake_ups.Ns("latest_ms"),
                                        .latest_slow_ns = wake_ups.Ns("latest_slow_ms"),
                                        .order_changes = wake_ups.Count("order_changes")}};
  for (const Object& fault : object.Each("faults")) {
    scenario.faults.push_back(FaultOf(fault, gauges));
  }
  for (const Object& command : object.Each("commands")) {
    scenario.commands.push_back(
        {.at_ns = command.Ns("at_ms"), .text = command.Member("line").dump()});
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
    return ScenarioFrom(Object(json, ""), gauges);
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

}  // namespace flexarm
