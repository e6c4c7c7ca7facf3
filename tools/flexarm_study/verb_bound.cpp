#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "controller/files/external_json.h"
#include "model/units.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/motion_trace.h"
#include "tools/bound/rigid_free.h"
#include "tools/bound/rigid_straight.h"
#include "tools/command_line/options.h"
#include "tools/command_line/studies.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

struct BoundOptions {
  ConfigOptions config;
  std::vector<double> from_deg, to_deg;
  std::optional<double> payload_kg, torque_share;
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
  return json;
}

void PrintBounds(const nlohmann::ordered_json& json) {
  std::printf("rigid arm, straight line in the joint angles   %.3f s\n",
              json["rigid_straight_s"].get<double>());
  std::printf("rigid arm, any path, best found                %.3f s\n",
              json["rigid_free_s"].get<double>());
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

void RegisterBound(CLI::App& app, Exit&) {
  const auto options = std::make_shared<BoundOptions>();
  CLI::App* verb = AddStudy(app, "bound");
  options->config.AddTo(verb, true);
  AddMove(verb, options.get());
  AddJson(verb, &options->json);
  verb->footer(
      "Example: flexarm bound -c config/thesis-rig.toml --from 0,0 --to 30,-60 --payload-kg 0.2");
  verb->callback([options] {
    const nlohmann::ordered_json json = Bounds(*options);
    if (options->json) {
      std::cout << PrintedJson(json) << '\n';
    } else {
      PrintBounds(json);
    }
  });
}

}  // namespace flexarm
