#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "controller/operator/command_dispatch.h"
#include "controller/operator/operator_connection.h"
#include "tests/controller/operator/operator_parts.h"
#include "tests/controller/operator/peers.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr int kClient = 7;

// The operator's side, with a connection on which a client has sent `bytes` and gone.
class OneClient final : public OperatorParts {
 public:
  explicit OneClient(SafetyState state) : OperatorParts(NewRig()) { now_.permit.state = state; }

  void TestBody() override {}

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
  // A folder in which there is no calibration, and none can be written.
  static RigConfig NewRig() {
    static const RigConfig config = ShippedRig({"log.directory='/proc/flexarm-fuzz'"});
    return config;
  }

  void Poll(OperatorConnection* client) {
    client->Read();
    while (const std::optional<std::string> line = client->NextLine()) {
      Reply(client, dispatch_.Answer(kClient, client->peer(), *line, now_));
      if (const auto planned = run_.Follow(now_, [](int) { return true; })) {
        Reply(client, planned->json);
      }
      stack_.TakeRequests();
      client->Read();
    }
  }

  // As OperatorTask; null: the answer comes later.
  void Reply(OperatorConnection* client, Json answer) {
    if (answer.is_null()) return;
    record_.Answered(now_.now_ns, kClient, &answer);
    client->Reply(answer.dump());
  }

  CommandRecord record_{&events_, journal_.Report()};
  CommandDispatch dispatch_{{.stack = &stack_,
                             .requests = &requests_,
                             .commissioning = &commissioning_,
                             .switches = &switches_,
                             .arm = &arm_,
                             .run = &run_,
                             .lease = &lease_,
                             .record = &record_,
                             .status = [] { return Json{{"ok", true}}; },
                             .report = journal_.Report()}};
};

}  // namespace

// Lines of a client, in the state that the first byte names.
void FuzzSocket(FuzzBytes input) noexcept {
  constexpr std::array kStates = {SafetyState::kIdle, SafetyState::kArmed, SafetyState::kRunning,
                                  SafetyState::kTripped};
  FuzzReader from(input);
  OneClient client(kStates[from.Byte() % kStates.size()]);
  client.Hear(from.Take(input.size()));
}

}  // namespace flexarm
