// Random commands of three clients, several in one poll, against the whole operator and safety side
// on the simulated arm, in lock step. Whatever the order: what runs is what was granted, a switch
// mask belongs to the homing run that asked for it, each request is answered once, and a stop acts
// within 2 ms of the poll that reads it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>
#include <vector>

#include "controller/operator/operator_task.h"
#include "controller/realtime/lockstep_executor.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/socket_peer.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/support/campaign.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kClients = 3;

/// A daemon's operator and safety side from its start on, with three clients.
class Session {
 public:
  explicit Session(unsigned seed) : random_(seed) {
    config_ =
        ShippedRig({"log.directory='" + folder().string() + "'", "commissioning.measure_s=0.2",
                    "safety.rest_time_s=0.2", "commissioning.home_travel_deg=2.0",
                    "commissioning.switch_angle_deg=[-5.0, 5.0, -5.0, 5.0]",
                    // After a trip the elbow turns until friction stops it.
                    "sim.switch_angle_deg=[360.0, 360.0]", "limits.soft_angle_deg=[350.0, 350.0]"});
    stack_ = std::make_unique<SimulatedStack>(config_, ShippedDesign(), 0.1);
    latch_.Open();
    operator_ = std::make_unique<OperatorTask>(OperatorContext{
        .stack = stack_.get(),
        .latch = &latch_,
        .events = &events_,
        .design = &ShippedDesign(),
        .config = &config_,
        .grid = LoopGrid(config_.loop),
        .delay_margin_s = 0.009,
        .limits = ShippedLimits(),
        .arm_checks = {.design = {.result = ArmVerdict::Result::kPassed}, .simulated = true},
        .socket = path_,
        .unattended = {},
        .parse_experiment = ParseExperiment,
        .report = [](bool, const std::string&) {},
        .thread_status = [] { return Json::array(); },
        .alive = [](std::int64_t, const std::string&) {},
        .plan_wait = std::chrono::seconds(60)});
    for (Task* task : stack_->tasks()) executor_.Add(*task);
    executor_.Add(*operator_);
    for (auto& client : clients_) client = std::make_unique<SocketPeer>(path_);
    for (int k = 0; k < 50; ++k) Poll();
  }
  ~Session() { std::filesystem::remove_all(folder()); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void Play(long sequences) {
    for (long i = 0; i < sequences; ++i) {
      SendSome();
      Poll();
    }
    Settle();
  }

  long granted() const { return static_cast<long>(granted_.size()); }
  long asked() const { return runs_asked_; }
  long running_ticks() const { return running_ticks_; }
  long homing_ticks() const { return homing_ticks_; }

 private:
  std::filesystem::path folder() const { return std::filesystem::path(path_).parent_path(); }

  int Below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

  std::string Run() {
    const std::string name = "run-" + std::to_string(++runs_asked_);
    return Json{{"command", "run"},
                {"experiment", "name = \"" + name +
                                   "\"\nduration_s = 0.4\n[[move]]\nstart_s = 0.0\n"
                                   "duration_s = 0.2\nto_deg = [" +
                                   std::to_string(Below(3)) + ".0, 0.0]\n"}}
        .dump();
  }

  // Arm and run are frequent, so that most runs happen; a switch is opened and closed again later.
  std::string Command() {
    switch (Below(16)) {
      case 0:
      case 1:
      case 2:
        return Json{{"command", "arm"}}.dump();
      case 3:
      case 4:
      case 5:
      case 6:
        return Run();
      case 7:
        return Json{{"command", "stop"}}.dump();
      case 8:
        return Json{{"command", "disarm"}}.dump();
      case 9:
      case 10:
        return Json{{"command", "reset"}}.dump();
      case 11:
        return Json{{"command", "status"}}.dump();
      case 12:
        return Json{{"command", "home"}, {"joint", 1 + Below(2)}, {"side", "low"}}.dump();
      case 13:  // seldom: while they measure, no arm is possible
        return Json{{"command",
                     std::array{"tare", "zero", "arm", "arm"}[static_cast<std::size_t>(Below(4))]}}
            .dump();
      case 14:
        return Json{{"command", "sim"}, {"line", "limit-1-low"}, {"level", Below(16) > 0 ? 1 : 0}}
            .dump();
      default:
        return Json{{"command", "sim"}, {"line", "reset-button"}, {"level", Button()}}.dump();
    }
  }

  // 1: pressed. A press counts after 50 ms: it is released four polls of 20 ms later at the
  // earliest.
  int Button() {
    const int wanted = Below(2);
    if (wanted > button_) pressed_polls_ = 0;
    if (wanted == 1 || pressed_polls_ >= 4) button_ = wanted;
    return button_;
  }

  // Up to three commands of each client in one poll, in a random order.
  void SendSome() {
    const int count = Below(10);
    for (int i = 0; i < count; ++i) {
      const auto client = static_cast<std::size_t>(Below(kClients));
      const std::string command = Command();
      stop_sent_ = stop_sent_ || command == R"({"command":"stop"})";
      ++sent_[client];
      clients_[client]->Send(command + "\n");
    }
  }

  void Poll() {
    ++pressed_polls_;
    const std::int64_t poll_ns = now_ns_;  // the operator task is due there and reads what was sent
    const bool stop_sent = std::exchange(stop_sent_, false);
    now_ns_ += kPeriodNs;
    executor_.RunUntil(now_ns_);
    for (std::size_t i = 0; i < kClients; ++i) TakeReplies(i);
    TakeEvents();
    CheckSafety(poll_ns, stop_sent);
    CheckTicks();
  }

  void TakeReplies(std::size_t i) {
    while (clients_[i]->Line()) ++answered_[i];
  }

  // By the number of the request for its run, also of those that are refused.
  void TakeEvents() {
    for (const RunEvent& event : flexarm::TakeEvents(&events_)) {
      if (event.kind != "experiment") continue;
      announced_[Json::parse(event.value_json).at("number").get<std::uint32_t>()] = event.name;
    }
  }

  void CheckSafety(std::int64_t poll_ns, bool stop_sent) {
    bool stopped = false;
    SafetyRecord record{};
    while (stack_->safety_records().Pop(&record)) {
      const RequestKind request = record.facts.request;
      stopped = stopped || (request == RequestKind::kStop && record.due_ns >= poll_ns &&
                            record.due_ns <= poll_ns + 2 * kMs);
      if (request != RequestKind::kRun || record.refusal != Refusal::kNone) continue;
      EXPECT_EQ(record.after.state, SafetyState::kRunning);
      granted_.push_back(record.request_number);
    }
    EXPECT_EQ(stopped, stop_sent) << "at " << poll_ns;
  }

  void CheckTicks() {
    const Permit& permit = stack_->operator_permits().Read().Newest().value;
    TickRecord tick{};
    while (stack_->tick_records().Pop(&tick)) {
      if (tick.input.safety_state != SafetyState::kRunning) continue;
      ASSERT_FALSE(granted_.empty());
      ++running_ticks_;
      // What the loop carries out is the run that was granted last: no tick is of another.
      EXPECT_EQ(tick.run_number, granted_.back());
      EXPECT_EQ(permit.run_number, granted_.back());
      const bool homes = tick.input.mode == LoopMode::kRegulate;
      EXPECT_EQ(homes, Homes(permit.run)) << "a switch may open in the run that searches for it";
      EXPECT_EQ(permit.run.experiment->mode, tick.input.mode);
      if (homes) {
        EXPECT_EQ(permit.run.may_open, LineBit(permit.run.experiment->homing.line));
        ++homing_ticks_;
      } else {
        names_[tick.run_number] = permit.run.experiment->accepted.name;
      }
    }
  }

  // No command is left without an answer, once the jobs that take their time are over.
  void Settle() {
    for (int k = 0; k < 1'000 && sent_ != answered_; ++k) Poll();
    EXPECT_EQ(sent_, answered_) << "each command has one answer";
    for (int k = 0; k < 5; ++k) Poll();
    EXPECT_EQ(sent_, answered_) << "and only one";
    for (const std::uint32_t number : granted_) EXPECT_EQ(announced_.count(number), 1U);
    for (const auto& [number, name] : names_) {
      EXPECT_EQ(announced_[number], name) << "the log names what ran";
    }
  }

  const std::string path_ = SocketPath();
  RigConfig config_;
  EventQueue events_{1'000};
  LatchFolder state_;
  TripLatch latch_{state_.path(), "/runs", [](bool, const std::string&) {}};
  std::unique_ptr<SimulatedStack> stack_;
  std::unique_ptr<OperatorTask> operator_;
  LockstepExecutor executor_;
  std::array<std::unique_ptr<SocketPeer>, kClients> clients_;
  std::mt19937 random_;
  std::int64_t now_ns_ = 0;
  bool stop_sent_ = false;
  std::array<long, kClients> sent_{}, answered_{};
  long runs_asked_ = 0, running_ticks_ = 0, homing_ticks_ = 0;
  std::vector<std::uint32_t> granted_;
  std::map<std::uint32_t, std::string> announced_;
  int button_ = 0;
  int pressed_polls_ = 0;
  std::map<std::uint32_t, std::string> names_;  // of the runs that moved, by number
};

TEST(Interleaving, CampaignWhatRunsIsWhatWasGranted) {
  constexpr long kPerSession = 500;
  const long sessions = CampaignCases(20'000, 1'000'000) / kPerSession;
  long granted = 0, asked = 0, running_ticks = 0, homing_ticks = 0;
  for (long seed = 1; seed <= sessions && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Session session(static_cast<unsigned>(seed));
    session.Play(kPerSession);
    granted += session.granted();
    asked += session.asked();
    running_ticks += session.running_ticks();
    homing_ticks += session.homing_ticks();
  }
  // The campaign has reached what it is about.
  EXPECT_GT(granted, 2 * sessions);
  EXPECT_GT(running_ticks, 10 * sessions);
  EXPECT_GT(homing_ticks, sessions);
  EXPECT_LT(granted, asked / 2) << "most come while another waits or runs";
}

}  // namespace
}  // namespace flexarm
