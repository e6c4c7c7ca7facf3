#include "tools/advice/advice_page.h"

#include <nlohmann/json.hpp>

#include "controller/operator/refusal_list.h"
#include "controller/types/trip_advice.h"

namespace flexarm {
namespace {

const char* ChannelText(TripChannel channel) {
  switch (channel) {
    case TripChannel::kNone:
      return "none";
    case TripChannel::kJoint:
      return "joint or link";
    case TripChannel::kStrain:
      return "row of [[sensors.strain]]";
    case TripChannel::kCounter:
      return "encoder";
    case TripChannel::kBus:
      return "bus";
    case TripChannel::kLineTrouble:
      return "call or line";
  }
  return "none";
}

std::string AboutTrip(TripCause cause) {
  const bool damps = (kCategory1Causes & CauseBit(cause)) != 0;
  return std::string("stop category ") + (damps ? "1" : "0") +
         ", channel: " + ChannelText(ChannelOf(cause));
}

// What the table of trips and that of refusals have in common.
std::string LastCells(const Advice& advice) {
  return " | " + advice.happened + " | " + advice.check + " | " + advice.remedy + " |";
}

constexpr const char* kAdviceHead =
    "# Trips and refusals\n\n"
    "After reading this page you can say what a trip or a refusal means, what to check and what "
    "to do. `flexarm explain NAME` prints one of them\n"
    "at the rig, by the name or number that `flexarm status` or the answer shows; `flexarm "
    "explain` writes this page.\n\n"
    "## Trips\n\n"
    "A trip takes the torque away and latches. No trip can be overridden. After each: remove the "
    "cause, press the reset button for 50 ms or longer\n"
    "and release it, then `flexarm reset` and `flexarm arm` ([safety.md](safety.md#after-a-trip) "
    "has the order, the reaction times and the stop categories).\n"
    "Category 0: the torque ends in the tick of the cause; category 1: the arm is damped first. "
    "The channel says which joint, gauge, encoder or bus it was.\n\n"
    "| number | name | category, channel | what happened | check | remedy |\n"
    "|---|---|---|---|---|---|\n";

constexpr const char* kRefusalHead =
    "\n## Refusals\n\n"
    "A command that is refused changes nothing. Its answer has `refusal`, the name below, `error`, "
    "and often `remedy` ([protocol.md](protocol.md)). Options\n"
    "with REASON do without a condition once, and the reason is recorded "
    "([safety.md](safety.md#conditions-of-arming)).\n\n"
    "| name | of | override | what it means | check | remedy |\n"
    "|---|---|---|---|---|---|\n";

}  // namespace

std::vector<Advice> AllAdvice() {
  std::vector<Advice> all;
  for (int number = 1; number < kTripCauses; ++number) {
    const auto cause = static_cast<TripCause>(number);
    const TripAdvice advice = AdviceOf(cause);
    all.push_back({.name = ToString(cause),
                   .number = number,
                   .commands = "",
                   .about = AboutTrip(cause),
                   .happened = advice.happened,
                   .check = advice.check,
                   .remedy = advice.remedy,
                   .override_option = ""});
  }
  for (const RefusalAdvice& refusal : RefusalList()) {
    all.push_back({.name = refusal.name,
                   .number = 0,
                   .commands = refusal.commands,
                   .about = "",
                   .happened = refusal.happened,
                   .check = refusal.check,
                   .remedy = refusal.remedy,
                   .override_option = refusal.override_option});
  }
  return all;
}

std::string AdvicePage(const std::vector<Advice>& all) {
  std::string trips = kAdviceHead, refusals = kRefusalHead;
  for (const Advice& advice : all) {
    if (advice.number > 0) {
      trips += "| " + std::to_string(advice.number) + " | `" + advice.name + "` | " + advice.about +
               LastCells(advice) + "\n";
      continue;
    }
    const std::string over =
        advice.override_option.empty() ? "no" : "`" + advice.override_option + "`";
    refusals +=
        "| `" + advice.name + "` | " + advice.commands + " | " + over + LastCells(advice) + "\n";
  }
  return trips + refusals;
}

nlohmann::ordered_json AdviceJson(const std::vector<Advice>& all) {
  nlohmann::ordered_json json{{"trips", nlohmann::ordered_json::array()},
                              {"refusals", nlohmann::ordered_json::array()}};
  for (const Advice& advice : all) {
    nlohmann::ordered_json row{{"name", advice.name}};
    if (advice.number > 0) {
      row["number"] = advice.number;
      row["about"] = advice.about;
    } else {
      row["commands"] = advice.commands;
    }
    row["happened"] = advice.happened;
    row["check"] = advice.check;
    row["remedy"] = advice.remedy;
    row["override"] = advice.override_option.empty()
                          ? nlohmann::ordered_json(nullptr)
                          : nlohmann::ordered_json(advice.override_option);
    json[advice.number > 0 ? "trips" : "refusals"].push_back(std::move(row));
  }
  return json;
}

std::string AdviceText(const Advice& advice) {
  const bool is_trip = advice.number > 0;
  std::string text = is_trip ? "trip " + std::to_string(advice.number) + ", " + advice.name + " (" +
                                   advice.about + ")\n"
                             : "refusal " + advice.name + ", of " + advice.commands + "\n";
  text += "  what:     " + advice.happened + "\n  check:    " + advice.check +
          "\n  remedy:   " + advice.remedy + "\n";
  if (is_trip) {
    return text + "  then:     " + kAfterEveryTrip + "\n  override: not possible\n";
  }
  return text + "  override: " +
         (advice.override_option.empty() ? "not possible" : advice.override_option) + "\n";
}

}  // namespace flexarm
