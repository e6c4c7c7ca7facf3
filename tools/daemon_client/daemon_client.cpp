#include "tools/daemon_client/daemon_client.h"

#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "config/config.h"
#include "controller/operator/operator_client.h"
#include "controller/runlog/errors.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/status/reply.h"

namespace flexarm {
namespace {

constexpr int kTries = 50;

}  // namespace

std::string DaemonClient::SocketPath() const {
  if (!socket.empty()) return socket;
  if (!config.empty()) return LoadConfig(config).daemon.socket;
  const char* named = std::getenv("FLEXARM_SOCKET");
  return named != nullptr ? named : "/run/flexarm/flexarmd.sock";
}

CLI::App* DaemonClient::AddVerb(CLI::App& app, const char* name, const char* what) {
  CLI::App* verb = app.add_subcommand(name, what);
  CLI::Option* file =
      verb->add_option("-c,--config", config,
                       "Config that the daemon was started with: only its daemon.socket is read")
          ->type_name("FILE");
  verb->add_option("--socket", socket,
                   "Socket of the daemon (default: daemon.socket of --config, else "
                   "$FLEXARM_SOCKET, else /run/flexarm/flexarmd.sock)")
      ->type_name("PATH")
      ->excludes(file);
  RefuseSet(verb, kDaemonHasItsConfig);
  AddJson(verb, &json);
  return verb;
}

void DaemonClient::AddTakeOver(CLI::App* verb) {
  verb->add_flag("--take-over", take_over,
                 "Take the arm over from the user who commands it; not while it moves");
}

nlohmann::ordered_json DaemonClient::Ask(nlohmann::ordered_json command, double within_s) const {
  if (take_over) command["take_over"] = true;
  const std::string name = TextIn(command, "command");
  // A crowd of clients can close this one before it is heard. Asking twice for these does no harm.
  int tries = name == "stop" || name == "status" ? kTries : 1;
  for (;;) {
    const std::string reply = AskDaemon(SocketPath(), command.dump(), within_s);
    nlohmann::ordered_json answer = nlohmann::ordered_json::parse(reply, nullptr, false);
    if (!answer.is_object()) throw InputError("the answer of the daemon is not JSON");
    if (--tries == 0 || TextIn(answer, "refusal") != "too-many-clients") return answer;
  }
}

int DaemonClient::Conclude(const nlohmann::ordered_json& answer) const {
  const bool ok = FlagIn(answer, "ok");
  if (json) {
    std::cout << answer.dump(2) << '\n';
  } else if (ok) {
    std::cout << TextIn(answer, "command", "done") << ": ok, state " << TextIn(answer, "state", "-")
              << '\n';
  }
  if (!ok) {
    const std::string remedy = TextIn(answer, "remedy");
    std::cerr << "flexarm: " << TextIn(answer, "error", "refused")
              << (remedy.empty() ? "" : "; " + remedy) << '\n';
  }
  return ok ? Exit::kDone : Exit::kFailed;
}

}  // namespace flexarm
