#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "controller/operator/operator_task.h"
#include "controller/realtime/lockstep_executor.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/socket_peer.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/support/loop_time.h"

namespace flexarm {

using Json = nlohmann::json;

inline constexpr std::chrono::seconds kSessionPlanWait{60};
inline constexpr double kPlan_s = 1.0;    // an answer comes once the plan is there
inline constexpr double kAnswer_s = 0.1;  // five periods of the operator; requests take one

inline std::string TomlOfMove(double duration_s, const std::string& more = "") {
  return "name = \"one-move\"\nduration_s = " + std::to_string(duration_s) +
         "\n[[move]]\nstart_s = 0.0\nduration_s = 1.8\nto_deg = [10.0, -10.0]\n" + more;
}

// This process, as the daemon sees it.
inline Peer MyPeer() {
  return {.name = AccountName(geteuid()), .uid = geteuid(), .pid = getpid(), .role = {}};
}
inline Json Me() { return PeerJson(MyPeer()); }

// The journal line of a command that it gave.
inline std::string By(const std::string& command) {
  return command + " by " + PeerText(MyPeer()) + ": accepted";
}

/// The whole operator task in lock step with the simulated arm; its clients on a real socket.
class OperatorSession : public testing::Test {
 protected:
  ~OperatorSession() override { std::filesystem::remove_all(folder()); }

  std::filesystem::path folder() const { return std::filesystem::path(path_).parent_path(); }

  OperatorContext Context() {
    return {.stack = stack_.get(),
            .latch = latch_.get(),
            .events = &events_,
            .design = design_,
            .config = &config_,
            .grid = LoopGrid(config_.loop),
            .delay_margin_s = 0.009,
            .limits = ShippedLimits(),
            .reduced_limits = MotionLimitsOf(config_, true),
            .arm_checks = arm_checks_,
            .socket = path_,
            .unattended = {},
            .parse_experiment = ParseExperiment,
            .report = journal_.Report(),
            .thread_status = [] { return Json::array(); },
            .alive = [this](std::int64_t now_ns, const std::string&) { alive_ns_ = now_ns; },
            .plan_wait = plan_wait_};
  }

  // The daemon, before its first period.
  void Start(std::vector<std::string> overrides = {}, const std::string& unattended = "") {
    overrides.push_back("log.directory='" + folder().string() + "'");
    config_ = ShippedRig(overrides);
    stack_ = std::make_unique<SimulatedStack>(config_, *design_, 0.1);
    latch_ = std::make_unique<TripLatch>(state_.path(), folder().string(), journal_.Report());
    if (const std::optional<HeldTrip> trip = latch_->Open()) {
      stack_->StartTripped(trip->cause, trip->evidence);
    }
    OperatorContext context = Context();
    if (!unattended.empty()) context.unattended = ParseExperiment(unattended, "unattended");
    operator_ = std::make_unique<OperatorTask>(context);
    executor_.Add(stack_->safety());
    executor_.Add(stack_->control());
    executor_.Add(stack_->plant());
    executor_.Add(*operator_);
  }

  // The daemon is killed: nothing is brought to an end.
  void Kill() {
    operator_.reset();
    latch_.reset();
    executor_ = LockstepExecutor();
    stack_.reset();
    journal_.lines.clear();
    now_ns_ = 0;
  }

  // The physical button, once the arm is at rest.
  void PressReset() {
    Run(3.0);
    Press("reset-button", 1);
    Run(0.1);  // 50 ms count as a press
    Press("reset-button", 0);
  }

  // The same, until it is Idle and has seen the arm at rest.
  void StartAtRest(const std::vector<std::string>& overrides = {}) {
    Start(overrides);
    Run(1.0);
    ASSERT_EQ(State(), "Idle");
  }

  void Run(double seconds) {
    now_ns_ += std::llround(seconds / kPeriod_s) * kPeriodNs;
    executor_.RunUntil(now_ns_);
  }

  // Runs until the client has an answer; null: none within the time.
  Json AnswerTo(SocketPeer* client, double within_s = kAnswer_s) {
    for (double s = 0.0; s < within_s; s += kPeriod_s) {
      Run(kPeriod_s);
      if (const std::optional<std::string> line = client->Line()) return Json::parse(*line);
    }
    return nullptr;
  }

  Json Ask(const Json& command, double within_s = kAnswer_s) {
    SocketPeer client(path_);
    client.Send(command.dump() + "\n");
    return AnswerTo(&client, within_s);
  }

  Json Ask(const char* name) { return Ask(Json{{"command", name}}); }
  Json AskRun(const std::string& toml) {
    return Ask(Json{{"command", "run"}, {"experiment", toml}});
  }
  Json Press(const std::string& line, int level) {
    return Ask({{"command", "sim"}, {"line", line}, {"level", level}});
  }
  std::string State() { return Ask("status").value("state", ""); }

  bool ComesTo(const std::string& state, double within_s = 5.0) {
    const std::int64_t end_ns = now_ns_ + std::llround(within_s * 1e9);
    while (now_ns_ < end_ns) {
      if (State() == state) return true;
    }
    return false;
  }

  std::vector<std::string> JournalTexts() const {
    std::vector<std::string> texts;
    for (const RecordedJournal::Line& line : journal_.lines) texts.push_back(line.second);
    return texts;
  }

  // Time until the daemon may end, s; negative: not within the time.
  double RunUntilDone(double within_s) {
    const std::int64_t began_ns = now_ns_;
    while (!operator_->done()) {
      if (now_ns_ - began_ns > std::llround(within_s * 1e9)) return -1.0;
      Run(kPeriod_s);
    }
    return static_cast<double>(now_ns_ - began_ns) * 1e-9;
  }

  const std::string path_ = SocketPath();
  const Design* design_ = &ShippedDesign();
  RigConfig config_;
  EventQueue events_{1'000};
  RecordedJournal journal_;
  std::unique_ptr<SimulatedStack> stack_;
  LatchFolder state_;
  std::unique_ptr<TripLatch> latch_;
  std::unique_ptr<OperatorTask> operator_;
  LockstepExecutor executor_;
  ArmChecks arm_checks_{.design = {.result = ArmVerdict::Result::kPassed}, .simulated = true};
  std::chrono::milliseconds plan_wait_ = kSessionPlanWait;
  std::int64_t now_ns_ = 0;
  std::int64_t alive_ns_ = -1;  // of the newest period in which the watchdog was fed
};

}  // namespace flexarm
