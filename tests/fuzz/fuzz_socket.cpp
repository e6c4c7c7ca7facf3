#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "controller/operator/change_command.h"
#include "controller/operator/command_dispatch.h"
#include "controller/operator/operator_connection.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/peers.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr int kClient = 7;

// A folder in which there is no calibration, and none can be written.
const RigConfig& Rig() {
  static const RigConfig config = ShippedRig({"log.directory='/proc/flexarm-fuzz'"});
  return config;
}

// The loop does not run, and an input leaves nothing in its queues: one for all inputs.
StillStack& Stack() {
  static StillStack stack(Rig());
  stack.TakeRequests();
  static_cast<void>(stack.stop().Take());
  static_cast<void>(stack.disarm().Take());
  return stack;
}

// The operator's side, with a connection on which a client has sent `bytes` and gone.
class OneClient {
 public:
  explicit OneClient(SafetyState state) {
    now_.now_ns = 60 * kMs;
    now_.permit.state = state;
    latch_.Open();
  }

  void Hear(FuzzBytes bytes) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends.data()) != 0) {
      throw std::runtime_error("no socket");
    }
    OperatorConnection client(ends[0], kClient, kAlice);
    while (!bytes.empty()) {
      const ssize_t sent = send(ends[1], bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) break;
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      Poll(&client);
    }
    shutdown(ends[1], SHUT_WR);
    Poll(&client);
    close(ends[1]);
  }

 private:
  void Poll(OperatorConnection* client) {
    client->Read(true);
    while (const std::optional<std::string> line = client->NextLine()) {
      Reply(client, dispatch_.Answer(kClient, client->peer(), *line, now_));
      if (const auto planned = run_.Follow(now_, [](int) { return true; })) {
        Reply(client, planned->json);
      }
      stack_.TakeRequests();  // the safety task would
      client->Read(true);
    }
  }

  // As OperatorTask; null: the answer comes later.
  void Reply(OperatorConnection* client, Json answer) {
    if (answer.is_null()) return;
    record_.Answered(now_.now_ns, kClient, &answer);
    client->Reply(answer.dump());
  }

  StillStack& stack_ = Stack();
  EventQueue events_{64};
  RecordedJournal journal_;
  LatchFolder folder_;
  TripLatch latch_{folder_.path(), "/runs", [](bool, const std::string&) {}};
  RequestTracker requests_{&stack_, &latch_};
  ExperimentLoader experiments_{&stack_,
                                &requests_,
                                &events_,
                                &ShippedDesign(),
                                LoopGrid(Rig().loop),
                                ShippedLimits(),
                                MotionLimitsOf(Rig(), true)};
  CommissioningCommands commissioning_{Rig(),
                                       {.stack = &stack_,
                                        .experiments = &experiments_,
                                        .requests = &requests_,
                                        .report = journal_.Report()}};
  ProveSwitches switches_{Rig(), &latch_, journal_.Report(),
                          [] { return std::int64_t{1'700'000'000}; }};
  OverrideRecord overrides_{&events_, journal_.Report()};
  ArmCommand arm_{ArmChecks{.design = {.result = ArmVerdict::Result::kPassed}, .simulated = true},
                  {.requests = &requests_, .overrides = &overrides_, .report = journal_.Report()}};
  RunCommand run_{{.experiments = &experiments_,
                   .commissioning = &commissioning_,
                   .switches = &switches_,
                   .overrides = &overrides_,
                   .parse_experiment = ParseExperiment,
                   .plan_wait = std::chrono::seconds(1)}};
  ChangeCommand change_{{.experiments = &experiments_,
                         .events = &events_,
                         .period_s = Rig().loop.period_s(),
                         .plan_wait = std::chrono::seconds(1)}};
  Lease lease_{&events_, journal_.Report()};
  OperatorSnapshot now_;
  CommandRecord record_{&events_, journal_.Report()};
  CommandDispatch dispatch_{{.stack = &stack_,
                             .requests = &requests_,
                             .commissioning = &commissioning_,
                             .switches = &switches_,
                             .arm = &arm_,
                             .run = &run_,
                             .change = &change_,
                             .lease = &lease_,
                             .record = &record_,
                             .status = [] { return Json{{"ok", true}}; },
                             .report = journal_.Report()}};
};

}  // namespace

// Lines of a client, in the state that the first byte names.
void FuzzSocket(FuzzBytes input) {
  constexpr std::array kStates = {SafetyState::kIdle, SafetyState::kArmed, SafetyState::kRunning,
                                  SafetyState::kTripped};
  FuzzReader from(input);
  OneClient client(kStates[from.Byte() % kStates.size()]);
  client.Hear(from.Take(input.size()));
}

}  // namespace flexarm
