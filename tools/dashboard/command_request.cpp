#include "tools/dashboard/command_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "tools/daemon_client/move_text.h"
#include "tools/status/reply.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

// As long as the verbs of `flexarm` wait for them.
constexpr double kLongestPlan_s = 60.0, kLongestSearch_s = 120.0;
constexpr double kMostDegrees = 720.0, kMostMetres = 100.0, kMostSeconds = 3600.0;

/// The object of a request, key by key. Keys that are never asked for are errors: a key that is
/// misspelt must not be left out.
class Reader {
 public:
  explicit Reader(std::string_view text) : object_(Json::parse(text, nullptr, false)) {
    if (!object_.is_object()) throw InputError("the request is no JSON object");
  }

  std::string Text(const char* key) {
    const Json& value = Needed(key);
    if (!value.is_string()) Fail(key, "expected a text");
    return value.get<std::string>();
  }
  std::string OneOf(const char* key, std::initializer_list<std::string_view> words) {
    std::string text = Text(key);
    if (std::find(words.begin(), words.end(), text) == words.end()) {
      std::string expected;
      for (const std::string_view word : words) {
        expected += (expected.empty() ? "" : ", ") + std::string(word);
      }
      Fail(key, "found " + Shown(text) + ", expected one of " + expected);
    }
    return text;
  }
  bool Flag(const char* key) {
    const Json* value = Given(key);
    if (value == nullptr) return false;
    if (!value->is_boolean()) Fail(key, "expected true or false");
    return value->get<bool>();
  }
  double Number(const char* key, double low, double high) {
    return NumberOf(key, Needed(key), low, high);
  }
  std::optional<double> NumberIfGiven(const char* key, double low, double high) {
    const Json* value = Given(key);
    if (value == nullptr) return std::nullopt;
    return NumberOf(key, *value, low, high);
  }
  std::optional<std::array<double, 2>> PairIfGiven(const char* key, double most) {
    const Json* value = Given(key);
    if (value == nullptr) return std::nullopt;
    if (!value->is_array() || value->size() != 2) Fail(key, "expected two numbers");
    return std::array{NumberOf(key, (*value)[0], -most, most),
                      NumberOf(key, (*value)[1], -most, most)};
  }
  void ExpectNoMore() const {
    for (const auto& [key, value] : object_.items()) {
      if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) {
        throw InputError("the command has no key " + Shown(key));
      }
    }
  }

 private:
  const Json* Given(const char* key) {
    asked_.emplace_back(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }
  const Json& Needed(const char* key) {
    const Json* value = Given(key);
    if (value == nullptr) Fail(key, "is missing");
    return *value;
  }
  static double NumberOf(const char* key, const Json& value, double low, double high) {
    const double number = NumberOrNan(value);
    if (!(number >= low && number <= high)) {
      Fail(key, "expected a number from " + Json(low).dump() + " to " + Json(high).dump());
    }
    return number;
  }
  [[noreturn]] static void Fail(const char* key, const std::string& what) {
    throw InputError("key " + std::string(key) + ": " + what);
  }

  Json object_;
  std::vector<std::string> asked_;
};

Json RunJson(const std::string& name, const std::string& text) {
  return {{"command", "run"}, {"name", name}, {"experiment", text}};
}

Json MoveJson(Reader* request) {
  MoveWish wish{
      .to_deg = request->PairIfGiven("to_deg", kMostDegrees),
      .to_tip_m = request->PairIfGiven("to_tip_m", kMostMetres),
      .duration_s = request->NumberIfGiven("duration_s", 0.0, kMostSeconds).value_or(0.0)};
  if (wish.to_deg.has_value() == wish.to_tip_m.has_value()) {
    throw InputError("move: expected either to_deg or to_tip_m");
  }
  if (wish.to_tip_m) wish.elbow = request->OneOf("elbow", {"left", "right"});
  return RunJson("move", MoveText(wish));
}

Json HomeJson(Reader* request) {
  return {{"command", "home"},
          {"joint", std::lround(request->Number("joint", 1.0, 2.0))},
          {"side", request->OneOf("side", {"low", "high"})}};
}

// The daemon carries it out on a simulated rig only.
Json SimJson(Reader* request) {
  Json json{{"command", "sim"},
            {"line", request->OneOf("line", {"limit-1-low", "limit-1-high", "limit-2-low",
                                             "limit-2-high", "emergency-stop", "reset-button"})}};
  json["level"] = std::lround(request->Number("level", 0.0, 1.0));
  return json;
}

}  // namespace

DaemonCommand ReadCommand(std::string_view text, const ExperimentList& experiments) {
  Reader request(text);
  DaemonCommand command{.name = request.OneOf("command", {"stop", "disarm", "arm", "reset", "run",
                                                          "move", "home", "pluck", "sim"}),
                        .line = ""};
  Json json{{"command", command.name}};
  if (command.name == "run") {
    const std::string name = request.Text("experiment");
    json = RunJson(name, experiments.TextOf(name));
  }
  if (command.name == "move") json = MoveJson(&request);
  if (command.name == "home") json = HomeJson(&request);
  if (command.name == "sim") json = SimJson(&request);
  const bool takes_over = command.name != "stop" && command.name != "sim";
  if (takes_over && request.Flag("take_over")) json["take_over"] = true;
  request.ExpectNoMore();
  if (command.name == "run" || command.name == "move") command.within_s = kLongestPlan_s;
  if (command.name == "home" || command.name == "pluck") command.within_s = kLongestSearch_s;
  command.line = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  return command;
}

}  // namespace flexarm
