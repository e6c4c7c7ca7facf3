#include <CLI/CLI.hpp>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "controller/files/external_json.h"
#include "controller/types/rounded_text.h"
#include "model/units.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/flexible_best.h"
#include "tools/bound/motion_trace.h"
#include "tools/bound/rigid_free.h"
#include "tools/bound/rigid_straight.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

struct BoundOptions {
  ConfigOptions config;
  std::vector<double> from_deg, to_deg;
  std::optional<double> payload_kg, torque_share;
  bool rigid = false;
  bool json = false;
};

RestMove MoveOf(const BoundOptions& options, const ControlConfig& config) {
  const auto radians = [](const std::vector<double>& place_deg) {
    return Eigen::Vector2d(RadFromDeg(place_deg[0]), RadFromDeg(place_deg[1]));
  };
  return {.from_rad = radians(options.from_deg),
          .to_rad = radians(options.to_deg),
          .payload_kg = options.payload_kg.value_or(config.arm.payload_mass_kg)};
}

nlohmann::ordered_json LimitsJson(const MotionTrace& trace, const BoundLimits& limits) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const BindingLimit& limit : BindingLimits(trace, limits)) {
    json.push_back({{"key", limit.key},
                    {"index", limit.index},
                    {"largest_share", limit.largest},
                    {"time_share", limit.time_share}});
  }
  return json;
}

// With a progress bar: the search takes some seconds.
FoundMotion SearchFlexible(const RigidJointArm& arm, const BoundLimits& limits,
                           const RestMove& move, double period_s) {
  const auto show = ProgressBar("linear programs", kMostFlexiblePrograms);
  if (!show) return FlexibleBestFound(arm, limits, move, period_s);
  std::size_t done = 0;
  FoundMotion found = FlexibleBestFound(arm, limits, move, period_s, [&] { show(++done); });
  show(kMostFlexiblePrograms);
  return found;
}

void AddFlexible(const FoundMotion& found, const BoundLimits& limits,
                 nlohmann::ordered_json* json) {
  (*json)["iterations"]["flexible"] = found.iterations;
  (*json)["flexible_violation"] = found.violation;
  if (found.trace.empty()) {
    (*json)["flexible_best_found_s"] = nullptr;
    (*json)["flexible_reason"] =
        "no motion within the limits was found; the best exceeds them by " +
        RoundedText(100.0 * found.violation, 2) + " % of a limit, or misses the end";
    return;
  }
  (*json)["flexible_best_found_s"] = found.trace.back().time_s;
  (*json)["flexible_hold_s"] = found.trace[1].time_s;
  (*json)["limits_reached"]["flexible"] = LimitsJson(found.trace, limits);
}

nlohmann::ordered_json Bounds(const BoundOptions& options) {
  const RigConfig config = options.config.Load();
  const RestMove move = MoveOf(options, config);
  CheckMove(config, move);
  const BoundLimits limits =
      BoundLimitsOf(config, options.torque_share.value_or(PlanTorqueShare(config)));
  const RigidJointArm arm(config.arm);
  const MotionTrace straight = RigidStraightMotion(arm, limits, move);
  const FoundMotion free = RigidFreeMotion(arm, limits, move);
  nlohmann::ordered_json json;
  json["from_deg"] = options.from_deg;
  json["to_deg"] = options.to_deg;
  json["payload_kg"] = move.payload_kg;
  json["torque_nm"] = limits.torque_nm;
  json["root_moment_nm"] = limits.root_moment_nm;
  json["rigid_straight_s"] = straight.back().time_s;
  json["rigid_free_s"] = free.trace.back().time_s;
  json["iterations"]["rigid_free"] = free.iterations;
  json["limits_reached"]["rigid_straight"] = LimitsJson(straight, limits);
  json["limits_reached"]["rigid_free"] = LimitsJson(free.trace, limits);
  if (!options.rigid) {
    AddFlexible(SearchFlexible(arm, limits, move, 1e-3 * config.loop.period_ms), limits, &json);
  }
  return json;
}

std::string LimitsText(const nlohmann::ordered_json& reached) {
  std::string text;
  for (const auto& limit : reached) {
    if (limit["time_share"].get<double>() < 0.01) continue;
    text += text.empty() ? "" : ", ";
    text += limit["key"].get<std::string>() + " " + std::to_string(limit["index"].get<int>()) +
            " (" + std::to_string(std::lround(100.0 * limit["time_share"].get<double>())) + " %)";
  }
  return text.empty() ? "no limit for long" : text;
}

void PrintLine(const char* name, const nlohmann::ordered_json& time_s,
               const nlohmann::ordered_json& reached) {
  std::printf("%-36s %7.3f s, at %s\n", name, time_s.get<double>(), LimitsText(reached).c_str());
}

void PrintBounds(const nlohmann::ordered_json& json) {
  const auto& reached = json["limits_reached"];
  std::printf(
      "payload %g kg, torques up to %.3g and %.3g N m; shortest time from rest to rest,\n"
      "and the limits at which it is, with their share of the time:\n",
      json["payload_kg"].get<double>(), json["torque_nm"][0].get<double>(),
      json["torque_nm"][1].get<double>());
  PrintLine("rigid arm, straight in joint angles", json["rigid_straight_s"],
            reached["rigid_straight"]);
  PrintLine("rigid arm, any path, best found", json["rigid_free_s"], reached["rigid_free"]);
  if (!json.contains("flexible_best_found_s")) return;
  if (json["flexible_best_found_s"].is_null()) {
    std::printf("flexible arm: %s\n", json["flexible_reason"].get<std::string>().c_str());
  } else {
    PrintLine("flexible arm, best found", json["flexible_best_found_s"], reached["flexible"]);
  }
}

void AddMove(CLI::App* verb, BoundOptions* options) {
  verb->add_option("--from", options->from_deg, "Joint angles at the beginning, deg")
      ->required()
      ->delimiter(',')
      ->expected(2)
      ->check(NumberWithin(-360.0, 360.0))
      ->type_name("DEG");
  verb->add_option("--to", options->to_deg, "Joint angles at the end, deg")
      ->required()
      ->delimiter(',')
      ->expected(2)
      ->check(NumberWithin(-360.0, 360.0))
      ->type_name("DEG");
  verb->add_option("--payload-kg", options->payload_kg, "Payload instead of the config's")
      ->check(NumberWithin(0.0, 1000.0));
  verb->add_option("--torque-share", options->torque_share,
                   "Share of limits.torque_limit_nm that the move may use (default:\n"
                   "controller.plan.torque_share, or 1)")
      ->check(NumberWithin(0.01, 1.0));
}

}  // namespace

void RegisterBound(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<BoundOptions>();
  CLI::App* verb = AddOtherVerb(app, "bound");
  options->config.AddTo(verb, true);
  AddMove(verb, options.get());
  verb->add_flag("--rigid", options->rigid,
                 "The rigid arm only: a fraction of a second instead of some seconds");
  AddJson(verb, &options->json);
  verb->footer(
      "Three times of a move from rest to rest, to judge laws and planners by:\n"
      "  rigid_straight_s       rigid arm over the straight line in the joint angles: the "
      "shortest\n"
      "  rigid_free_s           rigid arm over any path: the best found, about 3 % less\n"
      "  flexible_best_found_s  the arm with bending links, which rest at the end too: the best\n"
      "                         found, so an upper limit of the shortest, not a bound\n"
      "Limits: torque, strain at the roots, hub rates and hub angles of [limits]; for the rigid\n"
      "arm the torque of a hub is at most what bends its link to the strain limit. Without\n"
      "friction and without the limit of the torque's rate of change. docs/theory/bound.md.\n"
      "Exit code 1 if no motion of the flexible arm was found: its time is then null in --json.\n"
      "Examples: flexarm bound -c config/thesis-rig.toml --from 0,0 --to 30,-60 --payload-kg 0.2\n"
      "          flexarm bound -c config/thesis-rig.toml --from -20,40 --to 35,-30 --rigid --json");
  verb->callback([options, &exit] {
    const nlohmann::ordered_json json = Bounds(*options);
    if (options->json) {
      std::cout << PrintedJson(json) << '\n';
    } else {
      PrintBounds(json);
    }
    if (json.contains("flexible_reason")) exit.code = Exit::kFailed;
  });
}

}  // namespace flexarm
