#include "controller/operator/change_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "controller/operator/command_text.h"
#include "controller/operator/request_answers.h"
#include "controller/reference/motion_change.h"
#include "controller/types/rejected_error.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// From the command to the change of the path: planning takes some 10 ms, and is tried again with
// more time if the experiment is long.
constexpr double kAhead_s = 0.3;
constexpr int kMostTries = 4;

double NumberOf(const nlohmann::json& value, const std::string& key) {
  const double number =
      value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (std::isfinite(number)) return number;
  throw RejectedError(key + ": a finite number is expected");
}

std::array<double, 2> PairOf(const nlohmann::json& value, const std::string& key) {
  if (!value.is_array() || value.size() != 2) {
    throw RejectedError(key + ": an array of two numbers is expected");
  }
  return {NumberOf(value[0], key), NumberOf(value[1], key)};
}

Move GoalOf(const nlohmann::json& command) {
  Move goal{.start_s = 0.0};
  const auto to_deg = command.find("to_deg"), to_tip_m = command.find("to_tip_m");
  if ((to_deg == command.end()) == (to_tip_m == command.end())) {
    throw RejectedError("retarget: either to_deg or to_tip_m is expected");
  }
  if (to_deg != command.end()) goal.to_deg = PairOf(*to_deg, "to_deg");
  if (to_tip_m != command.end()) goal.to_tip_m = PairOf(*to_tip_m, "to_tip_m");
  const std::string elbow = TextOf(command, "elbow", "");
  if (!elbow.empty() && elbow != "left" && elbow != "right") {
    throw RejectedError("elbow: \"left\" or \"right\" is expected");
  }
  if (!elbow.empty()) goal.elbow = elbow == "left" ? ElbowSide::kLeft : ElbowSide::kRight;
  if (const auto given = command.find("duration_s"); given != command.end()) {
    goal.duration_s = NumberOf(*given, "duration_s");
    if (*goal.duration_s <= 0.0 || *goal.duration_s > kLongestRun_s) {
      throw RejectedError("duration_s: above 0 and at most " + NumberText(kLongestRun_s) +
                          " is expected");
    }
  }
  return goal;
}

std::string TextOf(const Move& goal) {
  const std::array<double, 2>& to = goal.to_tip_m ? *goal.to_tip_m : goal.to_deg;
  return "[" + NumberText(to[0]) + ", " + NumberText(to[1]) + (goal.to_tip_m ? "] m" : "] deg");
}

ExperimentLoader::NewPath SpeedPath(double speed) {
  return
      [speed](const ReferenceTable& table, int from, const Design& design,
              const MotionLimits& limits) { return WithSpeed(table, from, speed, design, limits); };
}

std::string PercentText(double speed) { return NumberText(std::round(1e4 * speed) / 100.0) + " %"; }

}  // namespace

double SpeedOf(const nlohmann::json& command) {
  const auto given = command.find("speed_percent");
  if (given == command.end()) return 1.0;
  const double percent = NumberOf(*given, "speed_percent");
  if (percent >= 100.0 * kLeastSpeed && percent <= 100.0) return percent / 100.0;
  throw RejectedError("speed_percent: " + NumberText(100.0 * kLeastSpeed) +
                      " to 100 percent of the planned speed are expected");
}

bool ChangeCommand::Knows(const std::string& name) {
  return name == "pause" || name == "resume" || name == "speed" || name == "retarget";
}

nlohmann::json ChangeCommand::Refused(const std::string& refusal, const std::string& error,
                                      const std::string& remedy,
                                      const OperatorSnapshot& now) const {
  nlohmann::json json{{"ok", false}, {"refusal", refusal}, {"error", error}};
  if (!remedy.empty()) json["remedy"] = remedy;
  if (waits_) json["command"] = waits_->wish.name;
  json["state"] = ToString(now.permit.state);
  return json;
}

ChangeCommand::Wish ChangeCommand::WishOf(const std::string& name, const nlohmann::json& command) {
  Wish wish{.name = name};
  if (name == "speed") {
    if (command.find("speed_percent") == command.end()) {
      throw RejectedError("speed_percent: a number is expected");
    }
    wish.speed = SpeedOf(command);
  }
  if (name == "retarget") wish.goal = GoalOf(command);
  return wish;
}

nlohmann::json ChangeCommand::Start(const std::string& name, const nlohmann::json& command,
                                    int client, const OperatorSnapshot& now) {
  Wish wish = WishOf(name, command);
  if (now.permit.state != SafetyState::kRunning) {
    return RefusalJson(RequestKind::kChange, Refusal::kWrongState, now.permit.state);
  }
  waits_ = Waiting{.wish = std::move(wish),
                   .client = client,
                   .run = now.permit.run_number,
                   .ahead = std::max(kChangeLead + 1,
                                     static_cast<int>(std::ceil(kAhead_s / targets_.period_s)))};
  if (!IsFollowed(now)) return nullptr;
  nlohmann::json refused = Begin(now);
  if (!refused.is_null()) waits_.reset();
  return refused;
}

// The run, and the change of it that was granted last, are what the loop does.
bool ChangeCommand::IsFollowed(const OperatorSnapshot& now) const {
  const std::uint32_t change = granted_in_ == waits_->run ? granted_ : 0;
  return now.tick.run_number == waits_->run && now.tick.change_number == change;
}

nlohmann::json ChangeCommand::Begin(const OperatorSnapshot& now) {
  const Wish& wish = waits_->wish;
  waits_->planned = targets_.experiments->Find(now.tick.change_number != 0 ? now.tick.change_number
                                                                           : now.tick.run_number);
  const PlannedExperiment* planned = waits_->planned.get();
  std::string why;
  if (planned == nullptr) {
    why = "the daemon's own experiment is run as it was planned when it started";
  } else if (planned->mode != LoopMode::kFollow) {
    why = "this motion follows no path";
  } else {
    why = WhyNoChange(planned->reference);
  }
  if (!why.empty()) return Refused("no-path", why, "let it end, or `flexarm stop`", now);
  const double speed = planned->reference.path_plan()->time.speed();
  const bool paused = speed == 0.0;
  if (paused && (wish.name == "pause" || wish.name == "speed")) {
    return Refused("paused", "the run is paused", "`flexarm resume`", now);
  }
  if (!paused && wish.name == "resume") {
    return Refused("not-paused", "the run is not paused", "", now);
  }
  if (wish.name == "pause") {
    resume_speed_ = speed;
    waits_->path = SpeedPath(0.0);
    waits_->text = "paused";
  } else if (wish.name == "resume") {
    waits_->path = SpeedPath(resume_speed_);
    waits_->text = "resumed at " + PercentText(resume_speed_) + " of the planned speed";
  } else if (wish.name == "speed") {
    waits_->path = SpeedPath(wish.speed);
    waits_->text = PercentText(wish.speed) + " of the planned speed";
  } else {
    waits_->path = [goal = wish.goal](const ReferenceTable& table, int from, const Design& design,
                                      const MotionLimits& limits) {
      return Retargeted(table, from, goal, design, limits);
    };
    waits_->text = "new goal " + TextOf(wish.goal);
  }
  BeginPlan(now);
  return nullptr;
}

void ChangeCommand::BeginPlan(const OperatorSnapshot& now) {
  const ReferenceTable& table = waits_->planned->reference;
  const TickRecord& tick = now.tick;
  const int from = FirstChange(table, tick.sample, waits_->ahead);
  // The loop stays where it is while it is paused; else it comes nearer by a sample a period.
  const std::int64_t period_ns = std::llround(targets_.period_s * 1e9);
  const int left = from - kChangeLead / 2 - 1 - tick.sample;
  waits_->not_after_ns =
      table.path_plan()->time.speed() == 0.0 ? INT64_MAX : tick.input.now_ns + left * period_ns;
  planner_.Begin(
      [this, planned = waits_->planned, path = waits_->path, from](const std::stop_token&) {
        return targets_.experiments->PlanChange(*planned, from, path);
      });
}

std::optional<ClientAnswer> ChangeCommand::Follow(const OperatorSnapshot& now,
                                                  const std::function<bool(int client)>& is_there) {
  if (!waits_) return std::nullopt;
  const int client = waits_->client;
  const auto end = [&](nlohmann::json answer) {
    planner_.Cancel();
    waits_.reset();
    cancelled_ = false;
    return ClientAnswer{.client = client, .json = std::move(answer)};
  };
  const bool over =
      now.permit.state != SafetyState::kRunning || now.permit.run_number != waits_->run;
  if (cancelled_ || over || now.shutting_down || !is_there(client)) {
    nlohmann::json answer =
        RefusalJson(RequestKind::kChange, Refusal::kCancelled, now.permit.state);
    answer["command"] = waits_->wish.name;
    answer["state"] = ToString(now.permit.state);
    return end(std::move(answer));
  }
  if (targets_.experiments->busy()) return std::nullopt;
  if (waits_->planned == nullptr) {
    if (!IsFollowed(now)) return std::nullopt;
    nlohmann::json refused = Begin(now);
    if (!refused.is_null()) return end(std::move(refused));
  }
  std::optional<ExperimentPlanner::Outcome> planned = planner_.Take(targets_.plan_wait);
  if (!planned) return std::nullopt;
  if (planned->order && now.now_ns >= waits_->not_after_ns && waits_->tries < kMostTries) {
    ++waits_->tries;
    waits_->ahead *= 3;
    BeginPlan(now);
    return std::nullopt;
  }
  nlohmann::json answer = Decide(std::move(*planned), now);
  if (!answer.is_null()) return end(std::move(answer));
  waits_.reset();
  return std::nullopt;
}

nlohmann::json ChangeCommand::Decide(ExperimentPlanner::Outcome planned,
                                     const OperatorSnapshot& now) {
  if (!planned.order) return Refused("change-refused", planned.problem, "", now);
  const std::uint32_t number = targets_.experiments->AskForChange(
      now.now_ns, waits_->client, std::move(*planned.order),
      {.run = waits_->run, .not_after_ns = waits_->not_after_ns});
  if (number == 0) {
    nlohmann::json answer = RefusalJson(RequestKind::kChange, Refusal::kBusy, now.permit.state);
    answer["command"] = waits_->wish.name;
    return answer;
  }
  asked_ = number;
  asked_name_ = waits_->wish.name;
  asked_text_ = waits_->text;
  asked_in_ = waits_->run;
  return nullptr;
}

std::optional<std::string> ChangeCommand::Answered(std::int64_t now_ns,
                                                   const RequestAnswer& answer) {
  if (answer.kind != RequestKind::kChange || answer.number != asked_) return std::nullopt;
  if (answer.refusal == Refusal::kNone) {
    granted_ = answer.number;
    granted_in_ = asked_in_;
    targets_.events->Push({.time_ns = now_ns,
                           .kind = "change",
                           .name = asked_name_,
                           .text = asked_text_,
                           .value_json = nlohmann::json{{"number", answer.number}}.dump()});
  }
  return asked_name_;
}

}  // namespace flexarm
